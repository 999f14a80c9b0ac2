// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

/// Watches one thread for what a tick must not do. Not for a program under a sanitizer, which does all of it.
namespace tactus::real_time {

/// What a thread did between `arm` and `disarm`.
struct Deeds {
  std::int64_t allocations = 0;   ///< of memory, or its return
  std::int64_t locks = 0;         ///< of mutexes and their relatives, contended or not
  std::int64_t minor_faults = 0;  ///< pages that were not there, by RUSAGE_THREAD
  std::int64_t major_faults = 0;
  std::int64_t system_calls = 0;  ///< other than those of the wait for the deadline and of the counters
  std::int64_t first_system_call = -1;
};

/// Watches this thread from now on. A thread-scoped seccomp filter traps every system call but `clock_nanosleep` to an
/// absolute time of CLOCK_MONOTONIC, `clock_gettime` and `getrusage`; what is trapped is counted and not done. The
/// filter stays for good, so after `disarm` the thread can do no more than end the process.
///
/// `report` is written by `disarm`, and where the thread calls the system without end: one that waits for a contended
/// lock, or that wants to exit, asks again and again. Then the process ends, as one that has reported.
void arm(Deeds& report) noexcept;
void disarm() noexcept;

}  // namespace tactus::real_time
