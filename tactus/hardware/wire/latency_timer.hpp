// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <filesystem>
#include <string>

namespace tactus::wire {

/// Whether a serial adapter hands over at once what it receives. One with an FTDI chip waits for its latency timer, 16
/// ms from the factory, which holds a loop at 60 Hz. Links are followed; an adapter without such a timer is well.
/// Errors: `inconsistent` where it waits longer than 1 ms, with the command that fixes it. `system` is where Linux
/// shows its devices. Not real-time safe.
Check check_latency_timer(const std::string& port, const std::filesystem::path& system = "/sys");

}  // namespace tactus::wire
