// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tactus::runtime {

/// One thing that a servo thread asks of the system.
struct Right {
  std::string what;    ///< `SCHED_FIFO priority 80`
  bool held = false;   ///< granted
  std::string why;     ///< where it is not: what the system answered
  std::string means;   ///< where it is not: what is lost
  std::string remedy;  ///< where it is not: the command that fixes it
};

/// While it lives, the calling thread takes denormal numbers for zero, as a servo thread does.
class FlushedDenormals {
 public:
  FlushedDenormals() noexcept;
  ~FlushedDenormals();
  FlushedDenormals(const FlushedDenormals&) = delete;
  FlushedDenormals& operator=(const FlushedDenormals&) = delete;

 private:
  std::uint64_t before_;
};

/// What the whole process asks for while any servo thread runs: its memory locked into RAM, present and, where the
/// limit on locked memory allows, future; and the processor kept out of idle states that it is slow to leave. Counted:
/// the last one that goes gives both back.
class ProcessRights {
 public:
  /// Never fails: what was refused is in `rights`. Not real-time safe.
  ProcessRights();
  ~ProcessRights();
  ProcessRights(const ProcessRights&) = delete;
  ProcessRights& operator=(const ProcessRights&) = delete;

  [[nodiscard]] const std::vector<Right>& rights() const { return rights_; }

 private:
  std::vector<Right> rights_;
};

/// Makes the calling thread a servo thread: SCHED_FIFO, on `core` unless that is negative, timers without slack,
/// denormals flushed to zero, signals left to other threads, its stack touched. Returns what was granted
/// and what was not. Not real-time safe.
std::vector<Right> take_thread_rights(int priority, int core);

/// How much stack a servo thread has, all of it touched before the first tick but the last quarter.
inline constexpr std::size_t servo_stack_bytes = std::size_t{1} << 20;

/// Why SCHED_FIFO is refused to this thread, with the remedy; `held` where it is not. Leaves the thread as it was.
Right try_real_time(int priority);

}  // namespace tactus::runtime
