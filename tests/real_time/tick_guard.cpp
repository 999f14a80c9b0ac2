// SPDX-License-Identifier: Apache-2.0
#include "tests/real_time/tick_guard.hpp"

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdlib>

#include <dlfcn.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <pthread.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <time.h>
#include <ucontext.h>
#include <unistd.h>

namespace tactus::real_time {

namespace {

thread_local bool armed = false;
thread_local Deeds deeds;
Deeds* report_to = nullptr;
constexpr std::int64_t endless = 1000;

void note_allocation() noexcept { deeds.allocations += armed ? 1 : 0; }
void note_lock() noexcept { deeds.locks += armed ? 1 : 0; }

void on_system_call(int, siginfo_t* info, void* context) {
  if (armed) {
    if (deeds.system_calls++ == 0) deeds.first_system_call = info->si_syscall;
    if (deeds.system_calls == endless) {
      disarm();
      _exit(0);
    }
  }
#if defined(__x86_64__)
  static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_RAX] = -ENOSYS;
#else
  (void)context;
#endif
}

bool install_filter() noexcept {
  struct sigaction action {};
  action.sa_sigaction = &on_system_call;
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  sigaction(SIGSYS, &action, nullptr);
  constexpr unsigned load = BPF_LD | BPF_W | BPF_ABS;
  constexpr unsigned equal = BPF_JMP | BPF_JEQ | BPF_K;
  constexpr unsigned result = BPF_RET | BPF_K;
  constexpr auto number = static_cast<unsigned>(offsetof(seccomp_data, nr));
  constexpr auto first = static_cast<unsigned>(offsetof(seccomp_data, args[0]));
  constexpr auto second = static_cast<unsigned>(offsetof(seccomp_data, args[1]));
  sock_filter filter[] = {
      BPF_STMT(load, number),
      BPF_JUMP(equal, SYS_clock_gettime, 9, 0),
      BPF_JUMP(equal, SYS_getrusage, 8, 0),
      BPF_JUMP(equal, SYS_rt_sigreturn, 7, 0),
      BPF_JUMP(equal, SYS_exit_group, 6, 0),
      BPF_JUMP(equal, SYS_clock_nanosleep, 0, 4),
      BPF_STMT(load, first),
      BPF_JUMP(equal, CLOCK_MONOTONIC, 0, 2),
      BPF_STMT(load, second),
      BPF_JUMP(equal, TIMER_ABSTIME, 1, 0),
      BPF_STMT(result, SECCOMP_RET_TRAP),
      BPF_STMT(result, SECCOMP_RET_ALLOW),
  };
  const sock_fprog program{.len = sizeof(filter) / sizeof(filter[0]), .filter = filter};
  return prctl(PR_SET_NO_NEW_PRIVS, 1UL, 0UL, 0UL, 0UL) == 0 &&
         prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program, 0UL, 0UL) == 0;
}

}  // namespace

void arm(Deeds& report) noexcept {
  report_to = &report;
  if (!install_filter()) std::abort();
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  deeds = {.minor_faults = -usage.ru_minflt, .major_faults = -usage.ru_majflt};
  armed = true;
}

void disarm() noexcept {
  armed = false;
  rusage usage{};
  getrusage(RUSAGE_THREAD, &usage);
  deeds.minor_faults += usage.ru_minflt;
  deeds.major_faults += usage.ru_majflt;
  *report_to = deeds;
}

}  // namespace tactus::real_time

// Put in front of what the C library has.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* memory);

void* malloc(std::size_t size) {
  tactus::real_time::note_allocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  tactus::real_time::note_allocation();
  return __libc_calloc(number, size);
}
void* realloc(void* memory, std::size_t size) {
  tactus::real_time::note_allocation();
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  tactus::real_time::note_allocation();
  return __libc_memalign(alignment, size);
}
void free(void* memory) {
  tactus::real_time::note_allocation();
  __libc_free(memory);
}
}

namespace {
template <class Function>
Function next(Function, const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}
}  // namespace

#define TACTUS_COUNT_LOCK(name, type)                \
  extern "C" int name(type* object) {                \
    static const auto original = next(&name, #name); \
    tactus::real_time::note_lock();                  \
    return original(object);                         \
  }
TACTUS_COUNT_LOCK(pthread_mutex_lock, pthread_mutex_t)
TACTUS_COUNT_LOCK(pthread_mutex_trylock, pthread_mutex_t)
TACTUS_COUNT_LOCK(pthread_rwlock_rdlock, pthread_rwlock_t)
TACTUS_COUNT_LOCK(pthread_rwlock_wrlock, pthread_rwlock_t)
TACTUS_COUNT_LOCK(pthread_cond_signal, pthread_cond_t)
