// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/station/tick.hpp>
#include <tactus/runtime/servo/duration_histogram.hpp>
#include <tactus/runtime/servo/rights.hpp>

#include <array>
#include <atomic>
#include <concepts>
#include <cstdint>
#include <exception>
#include <memory>
#include <type_traits>
#include <utility>
#include <vector>

/// From the simulated clock to a real one.
namespace tactus::runtime {

/// How a servo thread keeps time.
struct ServoThreadParams {
  double rate_Hz = 5000.0;
  std::int64_t priority = 80;
  std::int64_t core = -1;
  double spin_s = 0.0;
  static constexpr auto fields() {
    return List{field("rate_Hz", &ServoThreadParams::rate_Hz, units::hertz, between(1.0, 20000.0),
                      "Control cycles per second."),
                field("priority", &ServoThreadParams::priority, between(1, 99),
                      "Priority of the thread under SCHED_FIFO; threads of the kernel that serve interrupts have 50."),
                field("core", &ServoThreadParams::core, between(-1, 1023),
                      "The one core to run on; -1 leaves the choice open."),
                field("spin_s", &ServoThreadParams::spin_s, units::second, between(0.0, 0.0005),
                      "The last part of each wait, spent polling the clock instead of sleeping; at most half a control "
                      "cycle, so that the "
                      "core is never held for whole cycles.")};
  }
};

/// What is measured of a tick, times in ns.
struct TickEvidence {
  std::int64_t late_ns = 0;      ///< from the deadline to the begin of the step
  std::int64_t duration_ns = 0;  ///< of the step
  std::int64_t own_ns = 0;       ///< processor time of the thread since the end of the tick before, less spinning
  std::int64_t voluntary_switches = 0;    ///< in the same time, the wait for the deadline included
  std::int64_t involuntary_switches = 0;  ///< in the same time
  std::int64_t major_faults = 0;          ///< in the same time
};

/// Why a tick was late that had one period to begin and end its step; `none` where it was not. Where the wait for the
/// processor was longer than the step, the machine woke the thread late. Else the step was too long: because of us
/// where at least half of it was our own processor time, where it waited, or where memory came from disk; else because
/// of the machine. Where a hypervisor does not report the time that it steals, stolen time counts as our own.
station::LateCause classify(const TickEvidence& tick, std::int64_t period_ns) noexcept;

/// How a servo thread kept time.
struct ServoReport {
  std::vector<Right> rights;  ///< what was asked of the system, granted or not
  std::int64_t period_ns = 0;
  std::int64_t ticks = 0;        ///< steps that ran
  std::int64_t missed = 0;       ///< deadlines that no step answered
  std::int64_t longest_gap = 0;  ///< most deadlines missed at once
  std::array<std::int64_t, station::late_causes.size() + 1>
      late{};                     ///< ticks that ended after the next deadline, by cause
  std::int64_t minor_faults = 0;  ///< page faults of the thread while it ran, served from memory
  std::int64_t major_faults = 0;  ///< page faults of the thread while it ran, served from disk
  std::int64_t involuntary_switches = 0;
  DurationHistogram lateness;  ///< from deadline to begin of the step
  DurationHistogram duration;  ///< of the step

  [[nodiscard]] std::int64_t late_for(station::LateCause cause) const { return late[static_cast<std::size_t>(cause)]; }
  [[nodiscard]] std::int64_t late_ours() const;
  [[nodiscard]] std::int64_t late_machine() const;
  /// Adds the counts of another run of the same period; the rights stay those of the first.
  void add(const ServoReport& other);
};

/// The clock side of a servo thread: waits for deadlines, keeps the counters. Of the thread that made it only.
///
/// The deadline of tick k is start + k · period. A tick that ends after the next deadline is late; deadlines that have
/// passed by then are missed, and the next one in the future is waited for: there is no burst of steps to catch up.
class TickKeeper {
 public:
  /// The first deadline is one period from now. Real-time safe, as are the other members.
  TickKeeper(const ServoThreadParams& params, ServoReport& report) noexcept;
  /// Sleeps until the next deadline; the last `spin_s` of it asks the clock.
  [[nodiscard]] station::Tick wait() noexcept;
  /// The step has ended. Two system calls, 0.6 us: after the command is out.
  void end() noexcept;

 private:
  struct Usage {
    std::int64_t own_ns = 0;
    std::int64_t voluntary_switches = 0;
    std::int64_t involuntary_switches = 0;
    std::int64_t minor_faults = 0;
    std::int64_t major_faults = 0;
  };
  static Usage usage() noexcept;

  ServoReport& report_;
  std::int64_t period_ns_;
  std::int64_t spin_ns_;
  std::int64_t start_ns_;
  station::Tick tick_;
  std::int64_t next_ = 0;  ///< number of the next deadline
  std::int64_t spun_ns_ = 0;
  Usage first_;
  Usage last_;
};

/// ns of CLOCK_MONOTONIC. Real-time safe.
std::int64_t monotonic_ns() noexcept;

/// A POSIX thread with a stack of `servo_stack_bytes`.
class NativeThread {
 public:
  NativeThread() = default;
  /// Errors: `failed` where the system gives no thread.
  Check start(void (*body)(void*), void* argument);
  void join();

 private:
  std::uintptr_t handle_ = 0;
  bool running_ = false;
};

/// Bounds, and that the spin is at most half a tick.
Check check_servo_thread(const ServoThreadParams& params);

/// What a servo thread runs once a tick; false ends the thread. Must not allocate, lock, throw or block.
template <class Step>
concept ServoStep = std::is_nothrow_invocable_r_v<bool, Step&, const station::Tick&>;

/// A thread that calls `step` once a period, at absolute deadlines of CLOCK_MONOTONIC, under SCHED_FIFO with locked
/// memory, a touched stack and denormals flushed, as far as the system grants it: what it does not grant is in the
/// report and the thread runs all the same.
///
/// Order of use: `start`, then `stop` where the step does not end by itself, then `finish`.
template <ServoStep Step>
class ServoThread {
 public:
  /// Errors: `out_of_bounds` and `inconsistent` for parameters, `failed` where the system gives no thread.
  static Result<std::unique_ptr<ServoThread>> start(const ServoThreadParams& params, Step step) {
    if (Check error = check_servo_thread(params)) return *std::move(error);
    std::unique_ptr<ServoThread> servo(new ServoThread(params, std::move(step)));
    if (Check error = servo->thread_.start(&ServoThread::run, servo.get())) return *std::move(error);
    return servo;
  }
  ~ServoThread() {
    stop();
    thread_.join();
  }
  ServoThread(const ServoThread&) = delete;
  ServoThread& operator=(const ServoThread&) = delete;

  /// The step that is running is the last. Any thread. Real-time safe.
  void stop() noexcept { stopped_.store(true, std::memory_order_relaxed); }
  /// Whether the last step has run. Any thread.
  [[nodiscard]] bool ended() const noexcept { return ended_.load(std::memory_order_acquire); }
  /// Waits for the end of the thread. The report is complete after it, and the step may be looked at. Where memory ran
  /// out before the first tick, there was none, and this throws what the thread did.
  const ServoReport& finish() {
    thread_.join();
    if (failure_) std::rethrow_exception(failure_);
    return report_;
  }
  [[nodiscard]] Step& step() { return step_; }

 private:
  ServoThread(const ServoThreadParams& params, Step&& step) : params_(params), step_(std::move(step)) {}

  static void run(void* self) {
    auto& servo = *static_cast<ServoThread*>(self);
    try {
      servo.report_.rights =
          take_thread_rights(static_cast<int>(servo.params_.priority), static_cast<int>(servo.params_.core));
      const auto& process = servo.process_.rights();
      servo.report_.rights.insert(servo.report_.rights.end(), process.begin(), process.end());
    } catch (...) {
      servo.failure_ = std::current_exception();
      servo.stop();
    }
    TickKeeper keeper(servo.params_, servo.report_);
    for (bool more = true; more && !servo.stopped_.load(std::memory_order_relaxed);) {
      const station::Tick tick = keeper.wait();
      more = servo.step_(tick);
      keeper.end();
    }
    servo.ended_.store(true, std::memory_order_release);
  }

  ServoThreadParams params_;
  ProcessRights process_;  ///< before the thread, so that its stack is locked too
  Step step_;
  ServoReport report_;
  std::exception_ptr failure_;
  std::atomic<bool> stopped_{false};
  std::atomic<bool> ended_{false};
  NativeThread thread_;
};

/// Runs `step` on a servo thread until it returns false.
template <ServoStep Step>
Result<ServoReport> run_servo(const ServoThreadParams& params, Step step) {
  auto servo = ServoThread<Step>::start(params, std::move(step));
  if (!servo) return servo.error();
  return (*servo)->finish();
}

}  // namespace tactus::runtime
