// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/wire/wire_end.hpp>

#include <cstdint>

namespace tactus::wire {

/// Lets two ends receive one another in virtual time, from `from_ns` to before `to_ns`; the next call continues from
/// there. No time passes on the wire: put `Paced` around one end where it should. Ends that answer one another at once
/// do so a nanosecond later, so that time continues whatever they send. Deterministic. Real-time safe where the ends
/// are.
void join(WireEnd& a, WireEnd& b, std::int64_t from_ns, std::int64_t to_ns) noexcept;

}  // namespace tactus::wire
