// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/servo_thread.hpp>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstring>

#include <pthread.h>
#include <sys/resource.h>
#include <time.h>

namespace tactus::runtime {

namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

std::int64_t nanoseconds(const timespec& time) noexcept { return time.tv_sec * second_ns + time.tv_nsec; }

std::int64_t read_clock(clockid_t clock) noexcept {
  timespec time{};
  clock_gettime(clock, &time);
  return nanoseconds(time);
}

void sleep_until(std::int64_t instant_ns) noexcept {
  const timespec instant{.tv_sec = instant_ns / second_ns, .tv_nsec = instant_ns % second_ns};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &instant, nullptr) == EINTR) {
  }
}

/// Tells the core that it spins, so that its twin gets on.
void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

/// pthread_create wants a body that returns something.
struct Start {
  void (*body)(void*);
  void* argument;
};

void* begin_thread(void* start) {
  const std::unique_ptr<Start> owned(static_cast<Start*>(start));
  owned->body(owned->argument);
  return nullptr;
}

}  // namespace

std::int64_t monotonic_ns() noexcept { return read_clock(CLOCK_MONOTONIC); }

Check check_servo_thread(const ServoThreadParams& params) {
  if (Check error = validate(params)) return error;
  const double half_s = 0.5 / params.rate_Hz;
  if (params.spin_s <= half_s) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "spin_s",
               .message = rounded_number(params.spin_s) + " s is more than half a control cycle, " +
                          rounded_number(half_s) +
                          " s: shorten it, or the thread would hold its core until the kernel takes it away",
               .place = {}};
}

station::LateCause classify(const TickEvidence& tick, std::int64_t period_ns) noexcept {
  if (tick.late_ns + tick.duration_ns <= period_ns) return station::LateCause::none;
  if (tick.late_ns >= tick.duration_ns) return station::LateCause::waking;
  if (tick.major_faults > 0) return station::LateCause::paging;
  if (2 * tick.own_ns >= tick.duration_ns) return station::LateCause::computing;
  // One voluntary switch is the wait for the deadline.
  if (tick.voluntary_switches > 1) return station::LateCause::blocking;
  return tick.involuntary_switches > 0 ? station::LateCause::preempted : station::LateCause::stalled;
}

std::int64_t ServoReport::late_ours() const {
  std::int64_t sum = 0;
  for (const station::LateCause cause : station::late_causes) sum += station::is_ours(cause) ? late_for(cause) : 0;
  return sum;
}

std::int64_t ServoReport::late_machine() const {
  std::int64_t sum = 0;
  for (const station::LateCause cause : station::late_causes) sum += station::is_ours(cause) ? 0 : late_for(cause);
  return sum;
}

void ServoReport::add(const ServoReport& other) {
  if (rights.empty()) rights = other.rights;
  period_ns = other.period_ns;
  ticks += other.ticks;
  missed += other.missed;
  longest_gap = std::max(longest_gap, other.longest_gap);
  for (std::size_t i = 0; i < late.size(); ++i) late[i] += other.late[i];
  minor_faults += other.minor_faults;
  major_faults += other.major_faults;
  involuntary_switches += other.involuntary_switches;
  lateness.add(other.lateness);
  duration.add(other.duration);
}

TickKeeper::TickKeeper(const ServoThreadParams& params, ServoReport& report) noexcept
    : report_(report),
      period_ns_(std::llround(1e9 / params.rate_Hz)),
      spin_ns_(std::llround(1e9 * params.spin_s)),
      start_ns_(monotonic_ns() + period_ns_),
      first_(usage()),
      last_(first_) {
  report_.period_ns = period_ns_;
}

TickKeeper::Usage TickKeeper::usage() noexcept {
  rusage counts{};
  getrusage(RUSAGE_THREAD, &counts);
  return {.own_ns = read_clock(CLOCK_THREAD_CPUTIME_ID),
          .voluntary_switches = counts.ru_nvcsw,
          .involuntary_switches = counts.ru_nivcsw,
          .minor_faults = counts.ru_minflt,
          .major_faults = counts.ru_majflt};
}

station::Tick TickKeeper::wait() noexcept {
  const std::int64_t deadline_ns = start_ns_ + next_ * period_ns_;
  sleep_until(deadline_ns - spin_ns_);
  const std::int64_t awake_ns = monotonic_ns();
  std::int64_t now_ns = awake_ns;
  while (now_ns < deadline_ns) {
    relax();
    now_ns = monotonic_ns();
  }
  spun_ns_ = now_ns - awake_ns;
  tick_.missed = report_.ticks == 0 ? next_ : next_ - tick_.number - 1;
  tick_.number = next_;
  tick_.deadline_ns = deadline_ns;
  tick_.began_ns = now_ns;
  return tick_;
}

void TickKeeper::end() noexcept {
  const std::int64_t ended_ns = monotonic_ns();
  const Usage now = usage();
  const TickEvidence evidence{.late_ns = tick_.began_ns - tick_.deadline_ns,
                              .duration_ns = ended_ns - tick_.began_ns,
                              .own_ns = now.own_ns - last_.own_ns - spun_ns_,
                              .voluntary_switches = now.voluntary_switches - last_.voluntary_switches,
                              .involuntary_switches = now.involuntary_switches - last_.involuntary_switches,
                              .major_faults = now.major_faults - last_.major_faults};
  last_ = now;
  tick_.previous_duration_ns = evidence.duration_ns;
  tick_.previous_cause = classify(evidence, period_ns_);
  ++report_.ticks;
  ++report_.late[static_cast<std::size_t>(tick_.previous_cause)];
  report_.lateness.add(evidence.late_ns);
  report_.duration.add(evidence.duration_ns);
  report_.minor_faults = now.minor_faults - first_.minor_faults;
  report_.major_faults = now.major_faults - first_.major_faults;
  report_.involuntary_switches = now.involuntary_switches - first_.involuntary_switches;

  const std::int64_t passed = ended_ns - tick_.deadline_ns;
  next_ = tick_.number + 1 + (passed > period_ns_ ? passed / period_ns_ : 0);
  const std::int64_t skipped = next_ - tick_.number - 1;
  report_.missed += skipped;
  report_.longest_gap = std::max(report_.longest_gap, skipped);
}

Check NativeThread::start(void (*body)(void*), void* argument) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, servo_stack_bytes);
  auto start = std::make_unique<Start>(Start{body, argument});
  pthread_t thread{};
  const int error = pthread_create(&thread, &attributes, &begin_thread, start.get());
  pthread_attr_destroy(&attributes);
  if (error != 0) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "no servo thread could be started (error " + std::to_string(error) +
                            "): raise the limit on processes (ulimit -u) or on locked memory (ulimit -l)",
                 .place = {}};
  }
  (void)start.release();  // the thread owns it
  handle_ = std::bit_cast<std::uintptr_t>(thread);
  running_ = true;
  return std::nullopt;
}

void NativeThread::join() {
  if (!running_) return;
  pthread_join(std::bit_cast<pthread_t>(handle_), nullptr);
  running_ = false;
}

}  // namespace tactus::runtime
