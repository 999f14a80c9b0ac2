// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/rights.hpp>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>

#include <fcntl.h>
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>
#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

namespace tactus::runtime {

namespace {

Right refused(std::string what, int error, std::string means, std::string remedy) {
  return {.what = std::move(what),
          .held = false,
          .why = std::strerror(error),  // NOLINT(concurrency-mt-unsafe): glibc's is safe for the errors of system calls
          .means = std::move(means),
          .remedy = std::move(remedy)};
}

Right granted(std::string what) {
  return {.what = std::move(what), .held = true, .why = {}, .means = {}, .remedy = {}};
}

Right set_real_time(int priority) {
  const std::string what = "SCHED_FIFO priority " + std::to_string(priority);
  const sched_param parameters{.sched_priority = priority};
  const int error = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  if (error == 0) return granted(what);
  // With the right to do it, a refusal can only come from the budget of the control group.
  const bool budget = geteuid() == 0;
  return refused(what, error, "any other program can delay a control cycle for milliseconds",
                 budget ? "echo 950000 > /sys/fs/cgroup/cpu/<group>/cpu.rt_runtime_us"
                        : "echo '@users - rtprio 99' | sudo tee /etc/security/limits.d/tactus.conf, then log in again; "
                          "or sudo setcap cap_sys_nice,cap_ipc_lock=ep $(command -v tactus)");
}

Right set_core(int core) {
  const std::string what = "core " + std::to_string(core);
  cpu_set_t set;
  CPU_ZERO(&set);
  int error = EINVAL;
  if (core < CPU_SETSIZE) {
    CPU_SET(static_cast<std::size_t>(core), &set);
    error = pthread_setaffinity_np(pthread_self(), sizeof(set), &set);
  }
  if (error == 0) return granted(what);
  return refused(what, error, "the thread may move between cores, which costs tens of microseconds each time",
                 "choose a core of those that `taskset -cp $$` prints");
}

Right remove_timer_slack() {
  const std::string what = "timers without slack";
  if (prctl(PR_SET_TIMERSLACK, 1UL, 0UL, 0UL, 0UL) == 0) return granted(what);
  return refused(what, errno, "without SCHED_FIFO the kernel may wake the thread 50 us late",
                 "run Linux 2.6.28 or later");
}

/// Those that a thread causes itself, or that a tracer or a tool of the kernel sends it, stay.
void leave_signals_to_others() {
  sigset_t all;
  sigfillset(&all);
  for (const int own : {SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV, SIGSYS, SIGTRAP}) sigdelset(&all, own);
  pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

/// The system takes its part of the stack first, thread-local storage for instance, so what is left is asked for.
[[gnu::noinline]] void touch_stack() {
  constexpr std::size_t page_bytes = 4096;
  pthread_attr_t attributes;
  if (pthread_getattr_np(pthread_self(), &attributes) != 0) return;
  void* lowest = nullptr;
  std::size_t size = 0;
  pthread_attr_getstack(&attributes, &lowest, &size);
  pthread_attr_destroy(&attributes);
  const auto here = reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0));
  const std::uintptr_t end = reinterpret_cast<std::uintptr_t>(lowest) + servo_stack_bytes / 4;
  if (here <= end) return;
  const std::size_t bytes = std::min(here - end, servo_stack_bytes / 4 * 3);
  auto* pages = static_cast<volatile char*>(__builtin_alloca(bytes));
  for (std::size_t i = 0; i < bytes; i += page_bytes) pages[i] = 0;
}

/// What the process has taken, for all who asked.
struct Taken {
  std::mutex guard;
  int holders = 0;
  std::vector<Right> rights;
  bool locked = false;
  int idle_states = -1;  ///< descriptor that holds them off as long as it is open
};

Taken& taken() {
  static Taken one;
  return one;
}

Right lock_memory(bool& locked) {
  rlimit limit{};
  getrlimit(RLIMIT_MEMLOCK, &limit);
  // Under a limit, locking the future would make later allocations of any thread fail.
  const bool future = limit.rlim_cur == RLIM_INFINITY || geteuid() == 0;
  locked = mlockall(future ? MCL_CURRENT | MCL_FUTURE : MCL_CURRENT) == 0;
  if (locked) return granted(future ? "memory locked" : "memory locked as far as it is there at the start");
  return refused(
      "memory locked", errno, "under pressure a page of the loop can go to disk and come back late",
      "echo '@users - memlock unlimited' | sudo tee -a /etc/security/limits.d/tactus.conf, then log in again");
}

Right hold_idle_states_off(int& descriptor) {
  const std::string what = "idle states held off";
  const std::int32_t longest_us = 0;
  descriptor = open("/dev/cpu_dma_latency", O_WRONLY | O_CLOEXEC);
  if (descriptor >= 0 && write(descriptor, &longest_us, sizeof(longest_us)) == sizeof(longest_us)) return granted(what);
  return refused(what, errno, "the processor may need up to 200 us to leave a deep idle state",
                 "sudo chmod a+w /dev/cpu_dma_latency, or boot with processor.max_cstate=1");
}

/// The word of the processor that says how floating-point numbers are treated, and the bits in it that take denormal
/// ones for zero: none where they are not known.
#if defined(__SSE2__)
constexpr std::uint64_t denormals_to_zero = 0x8000 | 0x0040;
std::uint64_t floating_point_control() noexcept { return _mm_getcsr(); }
void set_floating_point_control(std::uint64_t word) noexcept { _mm_setcsr(static_cast<unsigned int>(word)); }
#elif defined(__aarch64__)
constexpr std::uint64_t denormals_to_zero = std::uint64_t{1} << 24;
std::uint64_t floating_point_control() noexcept {
  std::uint64_t word = 0;
  asm volatile("mrs %0, fpcr" : "=r"(word));
  return word;
}
void set_floating_point_control(std::uint64_t word) noexcept { asm volatile("msr fpcr, %0" : : "r"(word)); }
#else
constexpr std::uint64_t denormals_to_zero = 0;
std::uint64_t floating_point_control() noexcept { return 0; }
void set_floating_point_control(std::uint64_t) noexcept {}
#endif

Right flush_denormals() {
  const std::string what = "denormals flushed to zero";
  set_floating_point_control(floating_point_control() | denormals_to_zero);
  if (denormals_to_zero != 0) return granted(what);
  return refused(what, ENOTSUP, "a filter that decays into denormals can become a hundred times slower",
                 "run on x86-64 or ARM64");
}

}  // namespace

FlushedDenormals::FlushedDenormals() noexcept : before_(floating_point_control()) {
  set_floating_point_control(before_ | denormals_to_zero);
}
FlushedDenormals::~FlushedDenormals() { set_floating_point_control(before_); }

ProcessRights::ProcessRights() {
  Taken& all = taken();
  const std::lock_guard lock(all.guard);
  if (all.holders++ == 0) all.rights = {lock_memory(all.locked), hold_idle_states_off(all.idle_states)};
  rights_ = all.rights;
}

ProcessRights::~ProcessRights() {
  Taken& all = taken();
  const std::lock_guard lock(all.guard);
  if (--all.holders > 0) return;
  if (all.idle_states >= 0) close(all.idle_states);
  if (all.locked) munlockall();
}

std::vector<Right> take_thread_rights(int priority, int core) {
  std::vector<Right> rights;
  leave_signals_to_others();
  if (core >= 0) rights.push_back(set_core(core));
  rights.push_back(remove_timer_slack());
  rights.push_back(flush_denormals());
  touch_stack();
  rights.push_back(set_real_time(priority));
  return rights;
}

Right try_real_time(int priority) {
  int policy = SCHED_OTHER;
  sched_param before{};
  pthread_getschedparam(pthread_self(), &policy, &before);
  Right right = set_real_time(priority);
  if (right.held) pthread_setschedparam(pthread_self(), policy, &before);
  return right;
}

}  // namespace tactus::runtime
