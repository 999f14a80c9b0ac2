// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/wire/port.hpp>
#include <tactus/hardware/wire/wire_end.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <functional>

namespace tactus::wire {

/// CLOCK_MONOTONIC in ns. Real-time safe.
std::int64_t monotonic_ns() noexcept;

/// Drives an end at a port by the real clock until `stop()`, which is asked at every turn and at least every 20 ms:
/// what arrives it receives at once; where nothing arrives, it is called about 50 µs around the time at which it wanted
/// to be. A packet for which the port has no room is lost, as on a wire, for an old command must not come late.
///
/// Blocks; the calling thread belongs to it, and gets a timer slack of 1 µs. Does not allocate unless it fails. Errors:
/// `failed` where the port was closed or unplugged.
Check talk(WireEnd& end, Port& port, const std::function<bool()>& stop);

}  // namespace tactus::wire
