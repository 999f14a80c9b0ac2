// SPDX-License-Identifier: Apache-2.0
#include "tests/allocation_counter.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>

#include "tests/sanitizers.hpp"

// A sanitizer owns the heap of its program and offers a hook; elsewhere glibc's own entry points are put in front.
#if TACTUS_UNDER_ADDRESS_SANITIZER || TACTUS_UNDER_THREAD_SANITIZER
#define TACTUS_SANITIZED_HEAP 1
#else
#define TACTUS_SANITIZED_HEAP 0
#endif

namespace {
std::atomic<std::uint64_t> count{0};
thread_local constinit std::uint64_t own_count = 0;
void note() noexcept {
  count.fetch_add(1, std::memory_order_relaxed);
  ++own_count;
}
}  // namespace

namespace tactus::laws {
std::uint64_t allocation_count() noexcept { return count.load(std::memory_order_relaxed); }
std::uint64_t own_allocation_count() noexcept { return own_count; }
}  // namespace tactus::laws

#if TACTUS_SANITIZED_HEAP

// Declared here because GCC ships the function without its header.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*on_malloc)(const volatile void*, std::size_t),
                                                         void (*on_free)(const volatile void*));

namespace {
[[maybe_unused]] const int installed = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { note(); }, [](const volatile void*) {});
}  // namespace

#else

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

// operator new of libstdc++ ends here too.
void* malloc(std::size_t size) {
  note();
  return __libc_malloc(size);
}
void* calloc(std::size_t number, std::size_t size) {
  note();
  return __libc_calloc(number, size);
}
void* realloc(void* memory, std::size_t size) {
  note();
  return __libc_realloc(memory, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) {
  note();
  *memory = __libc_memalign(alignment, size);
  return *memory == nullptr ? ENOMEM : 0;
}
}

#endif
