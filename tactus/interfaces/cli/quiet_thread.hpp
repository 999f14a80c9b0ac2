// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <functional>
#include <thread>

namespace tactus::cli {

/// A thread for `body` that no signal interrupts. Errors: `failed` where the system gives none.
Result<std::thread> start_quiet_thread(std::function<void()> body);

}  // namespace tactus::cli
