// SPDX-License-Identifier: Apache-2.0
// For LD_PRELOAD: makes one call of a program fail, as a full disk, a lack of memory or a signal would.
//
//   TACTUS_FAIL_SITES=FILE          appends a line "function site" to FILE when a function is first called from a site
//   TACTUS_FAIL="function site N"   lets the Nth call of that function from that site fail, and all after it when a `+`
//                                   stands behind N; a line "failed function site" is appended to FILE, and
//                                   one "through library(function)" for each that stands between the two
//
// A site is the place in the program itself that leads to the call, also through libraries of others: the offsets of
// the two innermost return addresses in the program. Where there is none, as in a thread of a library, it is the
// caller's place in its library. `scripts/fail-calls` uses it.
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <poll.h>
#include <pthread.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>
#include <unwind.h>

extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
}

namespace {

struct Site {
  std::uintptr_t inner = 0;  ///< offset in the program, or address in a library
  std::uintptr_t outer = 0;  ///< offset in the program
  bool in_program = false;
  bool operator==(const Site&) const = default;
};

std::uintptr_t program_base = 0, program_begin = 0, program_end = 0;
std::array<char, 512> report{}, wanted{};
std::uint64_t wanted_call = 0;
bool and_after = false;
std::atomic<std::uint64_t> calls_of_wanted = 0;
std::atomic<bool> ready = false;
// While this thread looks after a call, its own calls are passed through. Not allocated on first use.
[[gnu::tls_model("initial-exec")]] thread_local bool inside = false;

constexpr std::size_t slots = 1 << 16;
std::array<std::atomic<std::uint64_t>, slots> seen{};

int note_program(dl_phdr_info* info, std::size_t, void*) {
  program_base = info->dlpi_addr;
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    const auto& header = info->dlpi_phdr[i];
    if (header.p_type != PT_LOAD || (header.p_flags & PF_X) == 0) continue;
    program_begin = program_base + header.p_vaddr;
    program_end = program_begin + header.p_memsz;
  }
  return 1;  // the first one is the program
}

[[gnu::constructor]] void begin() {
  inside = true;
  dl_iterate_phdr(note_program, nullptr);
  if (const char* file = std::getenv("TACTUS_FAIL_SITES")) std::snprintf(report.data(), report.size(), "%s", file);
  if (const char* call = std::getenv("TACTUS_FAIL")) {
    std::snprintf(wanted.data(), wanted.size(), "%s", call);
    char* number = std::strrchr(wanted.data(), ' ');
    if (number != nullptr) {
      *number = '\0';
      char* end = nullptr;
      wanted_call = std::strtoull(number + 1, &end, 10);
      and_after = *end == '+';
    }
  }
  inside = false;
  ready = report[0] != '\0';
}

struct Walk {
  Site site;
  int depth = 0;
  std::uintptr_t caller = 0;
  std::array<std::uintptr_t, 16> libraries{};  ///< on the way
  std::size_t passed = 0;
};

_Unwind_Reason_Code look(_Unwind_Context* context, void* data) {
  auto& walk = *static_cast<Walk*>(data);
  const std::uintptr_t address = _Unwind_GetIP(context);
  Dl_info own{};
  if (walk.caller == 0) {
    // Frames of this library come first.
    static const std::uintptr_t here = [&own] {
      dladdr(reinterpret_cast<void*>(&note_program), &own);
      return reinterpret_cast<std::uintptr_t>(own.dli_fbase);
    }();
    if (address - here < 0x40000) return _URC_NO_REASON;
    walk.caller = address;
  }
  if (address >= program_begin && address < program_end) {
    (walk.site.in_program ? walk.site.outer : walk.site.inner) = address - program_base;
    if (walk.site.in_program) return _URC_END_OF_STACK;
    walk.site.in_program = true;
  } else if (walk.passed < walk.libraries.size()) {
    walk.libraries[walk.passed++] = address;
  }
  return ++walk.depth > 60 ? _URC_END_OF_STACK : _URC_NO_REASON;
}

void tell(const char* word, const char* function, const char* site) {
  std::array<char, 700> line{};
  const int size = std::snprintf(line.data(), line.size(), "%s%s %s\n", word, function, site);
  const long file = syscall(SYS_openat, AT_FDCWD, report.data(), O_WRONLY | O_APPEND | O_CREAT | O_CLOEXEC, 0600);
  if (file < 0) return;
  syscall(SYS_write, file, line.data(), static_cast<std::size_t>(size));
  syscall(SYS_close, file);
}

/// Whether this call is to fail.
bool fails(const char* function) noexcept {
  if (!ready.load(std::memory_order_relaxed) || inside) return false;
  inside = true;
  const int kept = errno;
  Walk walk;
  _Unwind_Backtrace(look, &walk);
  if (!walk.site.in_program) walk.site = {.inner = walk.caller};
  std::uint64_t hash = walk.site.inner * 0x9e3779b97f4a7c15U ^ walk.site.outer * 0xc2b2ae3d27d4eb4fU;
  for (const char* c = function; *c != '\0'; ++c) hash = (hash ^ static_cast<unsigned char>(*c)) * 0x100000001b3U;
  hash |= 1;
  bool fresh = false;
  for (std::size_t i = hash >> 48;; i = (i + 1) % slots) {
    std::uint64_t there = 0;
    if (seen[i % slots].compare_exchange_strong(there, hash)) fresh = true;
    if (fresh || there == hash) break;
  }
  bool failing = false;
  if (fresh || wanted_call > 0) {
    std::array<char, 300> site{};
    if (walk.site.in_program) {
      std::snprintf(site.data(), site.size(), "%lx:%lx", walk.site.inner, walk.site.outer);
    } else {
      Dl_info where{};
      if (dladdr(reinterpret_cast<void*>(walk.site.inner), &where) == 0) where.dli_fname = "?";
      const char* name = std::strrchr(where.dli_fname, '/');
      std::snprintf(site.data(), site.size(), "%s+%lx", name == nullptr ? where.dli_fname : name + 1,
                    walk.site.inner - reinterpret_cast<std::uintptr_t>(where.dli_fbase));
    }
    if (fresh) tell("", function, site.data());
    const std::size_t length = std::strlen(function);
    if (wanted_call > 0 && std::strncmp(wanted.data(), function, length) == 0 && wanted[length] == ' ' &&
        std::strcmp(wanted.data() + length + 1, site.data()) == 0) {
      const std::uint64_t call = ++calls_of_wanted;
      failing = call == wanted_call || (and_after && call > wanted_call);
      if (failing && call == wanted_call) {
        tell("failed ", function, site.data());
        for (const std::uintptr_t address : walk.libraries) {
          Dl_info where{};
          if (address == 0 || dladdr(reinterpret_cast<void*>(address), &where) == 0) continue;
          tell("through ", where.dli_fname, where.dli_sname == nullptr ? "" : where.dli_sname);
        }
      }
    }
  }
  errno = kept;
  inside = false;
  return failing;
}

template <class Function>
Function* real(const char* name) {
  const bool before = inside;
  inside = true;
  auto* found = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
  inside = before;
  return found;
}

void* newed(std::size_t size, std::size_t alignment) {
  if (fails("new")) throw std::bad_alloc();
  void* memory = alignment > 0 ? __libc_memalign(alignment, size) : __libc_malloc(size > 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return newed(size, 0); }
void* operator new[](std::size_t size) { return newed(size, 0); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  return newed(size, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return newed(size, static_cast<std::size_t>(alignment));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return fails("new") ? nullptr : __libc_malloc(size);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return fails("new") ? nullptr : __libc_malloc(size);
}

extern "C" {

void* malloc(std::size_t size) {
  if (fails("malloc")) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  if (fails("calloc")) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  if (fails("realloc")) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_realloc(old, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  if (fails("posix_memalign")) return ENOMEM;
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  if (fails("aligned_alloc")) {
    errno = ENOMEM;
    return nullptr;
  }
  return __libc_memalign(alignment, size);
}

int open(const char* file, int flags, ...) {
  std::va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (fails("open")) {
    errno = EMFILE;
    return -1;
  }
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, file, flags, mode));
}
int open64(const char* file, int flags, ...) {
  std::va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (fails("open")) {
    errno = EMFILE;
    return -1;
  }
  return static_cast<int>(syscall(SYS_openat, AT_FDCWD, file, flags, mode));
}
int openat(int folder, const char* file, int flags, ...) {
  std::va_list more;
  va_start(more, flags);
  const mode_t mode = (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(more, mode_t) : 0;
  va_end(more);
  if (fails("openat")) {
    errno = EMFILE;
    return -1;
  }
  return static_cast<int>(syscall(SYS_openat, folder, file, flags, mode));
}

// What is closed must be closed, also where that tells of data that did not arrive.
int fclose(FILE* file) {
  static auto* const next = real<int(FILE*)>("fclose");
  const int told = next(file);
  if (!fails("fclose")) return told;
  errno = EIO;
  return EOF;
}

// Standard error, which says what has failed, does not fail itself.
std::size_t fwrite(const void* bytes, std::size_t size, std::size_t count, FILE* file) {
  static auto* const next = real<std::size_t(const void*, std::size_t, std::size_t, FILE*)>("fwrite");
  if (file == stderr || !fails("fwrite")) return next(bytes, size, count, file);
  errno = ENOSPC;
  return 0;
}
int fflush(FILE* file) {
  static auto* const next = real<int(FILE*)>("fflush");
  if (file == stderr || !fails("fflush")) return next(file);
  errno = ENOSPC;
  return EOF;
}

// FAILING(result, name, failure, errno, parameters, arguments)
#define FAILING(result, name, failure, error, parameters, arguments) \
  result name parameters {                                           \
    static auto* const next = real<result parameters>(#name);        \
    if (fails(#name)) {                                              \
      errno = (error);                                               \
      return failure;                                                \
    }                                                                \
    return next arguments;                                           \
  }
using Size = std::size_t;
FAILING(ssize_t, write, -1, ENOSPC, (int f, const void* b, Size n), (f, b, n))
FAILING(ssize_t, writev, -1, ENOSPC, (int f, const iovec* v, int n), (f, v, n))
FAILING(ssize_t, pwrite, -1, ENOSPC, (int f, const void* b, Size n, off_t o), (f, b, n, o))
FAILING(ssize_t, pwrite64, -1, ENOSPC, (int f, const void* b, Size n, off64_t o), (f, b, n, o))
FAILING(ssize_t, read, -1, EIO, (int f, void* b, Size n), (f, b, n))
FAILING(ssize_t, readv, -1, EIO, (int f, const iovec* v, int n), (f, v, n))
FAILING(ssize_t, pread, -1, EIO, (int f, void* b, Size n, off_t o), (f, b, n, o))
FAILING(Size, fread, 0, EIO, (void* b, Size s, Size n, FILE* f), (b, s, n, f))
FAILING(FILE*, fopen, nullptr, EMFILE, (const char* p, const char* m), (p, m))
FAILING(FILE*, fopen64, nullptr, EMFILE, (const char* p, const char* m), (p, m))
FAILING(int, fsync, -1, EIO, (int f), (f))
FAILING(int, fdatasync, -1, EIO, (int f), (f))
FAILING(int, ftruncate, -1, EIO, (int f, off_t n), (f, n))
FAILING(int, ftruncate64, -1, EIO, (int f, off64_t n), (f, n))
FAILING(int, posix_fallocate, ENOSPC, errno, (int f, off_t o, off_t n), (f, o, n))
FAILING(int, rename, -1, EIO, (const char* a, const char* b), (a, b))
FAILING(int, link, -1, EIO, (const char* a, const char* b), (a, b))
FAILING(int, mkdir, -1, ENOSPC, (const char* p, mode_t m), (p, m))
FAILING(int, fstat, -1, EIO, (int f, struct stat* s), (f, s))
FAILING(ssize_t, send, -1, ENOBUFS, (int f, const void* b, Size n, int o), (f, b, n, o))
FAILING(ssize_t, sendto, -1, ENOBUFS, (int f, const void* b, Size n, int o, const sockaddr* a, socklen_t l),
        (f, b, n, o, a, l))
FAILING(ssize_t, sendmsg, -1, ENOBUFS, (int f, const msghdr* m, int o), (f, m, o))
FAILING(ssize_t, recv, -1, ENOMEM, (int f, void* b, Size n, int o), (f, b, n, o))
FAILING(ssize_t, recvfrom, -1, ENOMEM, (int f, void* b, Size n, int o, sockaddr* a, socklen_t* l), (f, b, n, o, a, l))
FAILING(ssize_t, recvmsg, -1, ENOMEM, (int f, msghdr* m, int o), (f, m, o))
FAILING(int, recvmmsg, -1, ENOMEM, (int f, mmsghdr* m, unsigned n, int o, timespec* t), (f, m, n, o, t))
FAILING(int, sendmmsg, -1, ENOBUFS, (int f, mmsghdr* m, unsigned n, int o), (f, m, n, o))
FAILING(int, socket, -1, EMFILE, (int d, int t, int p), (d, t, p))
FAILING(int, bind, -1, EADDRINUSE, (int f, const sockaddr* a, socklen_t l), (f, a, l))
FAILING(int, connect, -1, ENETUNREACH, (int f, const sockaddr* a, socklen_t l), (f, a, l))
FAILING(int, listen, -1, EADDRINUSE, (int f, int n), (f, n))
FAILING(int, accept, -1, EMFILE, (int f, sockaddr* a, socklen_t* l), (f, a, l))
FAILING(int, accept4, -1, EMFILE, (int f, sockaddr* a, socklen_t* l, int o), (f, a, l, o))
FAILING(int, setsockopt, -1, ENOMEM, (int f, int l, int n, const void* v, socklen_t s), (f, l, n, v, s))
FAILING(int, getsockopt, -1, ENOBUFS, (int f, int l, int n, void* v, socklen_t* s), (f, l, n, v, s))
FAILING(int, getsockname, -1, ENOBUFS, (int f, sockaddr* a, socklen_t* l), (f, a, l))
FAILING(int, poll, -1, EINTR, (pollfd * p, nfds_t n, int t), (p, n, t))
FAILING(int, ppoll, -1, EINTR, (pollfd * p, nfds_t n, const timespec* t, const sigset_t* s), (p, n, t, s))
FAILING(int, epoll_create1, -1, EMFILE, (int o), (o))
FAILING(int, epoll_ctl, -1, ENOMEM, (int e, int o, int f, epoll_event* v), (e, o, f, v))
FAILING(int, epoll_wait, -1, EINTR, (int e, epoll_event* v, int n, int t), (e, v, n, t))
FAILING(int, eventfd, -1, EMFILE, (unsigned n, int o), (n, o))
FAILING(int, timerfd_create, -1, EMFILE, (int c, int o), (c, o))
FAILING(int, pipe, -1, EMFILE, (int* p), (p))
FAILING(int, pipe2, -1, EMFILE, (int* p, int o), (p, o))
FAILING(void*, mmap, reinterpret_cast<void*>(-1), ENOMEM, (void* a, Size n, int p, int o, int f, off_t s),
        (a, n, p, o, f, s))
FAILING(int, shm_open, -1, EMFILE, (const char* n, int o, mode_t m), (n, o, m))
FAILING(ssize_t, getrandom, -1, ENOSYS, (void* b, Size n, unsigned o), (b, n, o))
FAILING(int, pthread_create, EAGAIN, errno, (pthread_t * t, const pthread_attr_t* a, void* (*f)(void*), void* d),
        (t, a, f, d))
FAILING(int, pthread_setschedparam, EPERM, errno, (pthread_t t, int p, const sched_param* s), (t, p, s))
FAILING(int, mlockall, -1, ENOMEM, (int o), (o))
FAILING(int, usleep, -1, EINTR, (useconds_t t), (t))
FAILING(int, nanosleep, -1, EINTR, (const timespec* t, timespec* r), (t, r))
FAILING(int, clock_nanosleep, EINTR, errno, (clockid_t c, int o, const timespec* t, timespec* r), (c, o, t, r))
#undef FAILING
}
