// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstdint>

/// What surrounds the controllers of a teleoperator: what reads and drives motors, what carries messages, and the tick
/// that puts them together, whatever clock it runs on.
namespace tactus::station {

/// Why a tick was late. The first three are ours, the others the machine's.
enum class LateCause {
  none,
  computing,  ///< the step itself used the processor for most of its time
  blocking,   ///< the step waited: a lock, a file, a sleep
  paging,     ///< the step touched memory that had to come from disk
  waking,     ///< the machine woke the thread late
  preempted,  ///< the kernel gave the core to somebody else during the step
  stalled  ///< the thread had the core and made no progress: interrupts, or a hypervisor that took the processor away
};
inline constexpr std::array late_causes{LateCause::computing, LateCause::blocking,  LateCause::paging,
                                        LateCause::waking,    LateCause::preempted, LateCause::stalled};
constexpr bool is_ours(LateCause cause) { return cause != LateCause::none && cause <= LateCause::paging; }
constexpr auto enumerators(LateCause) {
  return std::array{Enumerator{LateCause::none, "none"},         Enumerator{LateCause::computing, "computing"},
                    Enumerator{LateCause::blocking, "blocking"}, Enumerator{LateCause::paging, "paging"},
                    Enumerator{LateCause::waking, "waking"},     Enumerator{LateCause::preempted, "preempted"},
                    Enumerator{LateCause::stalled, "stalled"}};
}

/// A tick, as the step receives it. Times in ns of CLOCK_MONOTONIC.
struct Tick {
  std::int64_t number = 0;                ///< of its deadline, from 0, missed ones counted
  std::int64_t missed = 0;                ///< deadlines between the tick before and this one that no step answered
  std::int64_t deadline_ns = 0;           ///< when it was due
  std::int64_t began_ns = 0;              ///< when the thread was awake
  std::int64_t previous_duration_ns = 0;  ///< of the step before; 0 for the first
  LateCause previous_cause = LateCause::none;
};

}  // namespace tactus::station
