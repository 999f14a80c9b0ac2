// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/shared_mapping.hpp>

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>

#include <sys/mman.h>

namespace tactus::runtime {

namespace {

/// A mapping, as the handler sees it. All that it needs is written before `begin`.
struct Place {
  std::atomic<bool> taken{false};
  std::atomic<char*> begin{nullptr};
  std::size_t bytes = 0;
  void* zeros = nullptr;  ///< as many, in the place of the mapping once that is cut
  std::atomic<bool> cut{false};
};
static_assert(std::atomic<char*>::is_always_lock_free && std::atomic<bool>::is_always_lock_free, "for a handler");

std::array<Place, 64> places;
struct sigaction handler_before {};

/// What would have happened without us.
void pass_on(int signal, siginfo_t* info, void* context) {
  if ((handler_before.sa_flags & SA_SIGINFO) != 0) return handler_before.sa_sigaction(signal, info, context);
  if (handler_before.sa_handler != SIG_DFL && handler_before.sa_handler != SIG_IGN)
    return handler_before.sa_handler(signal);
  struct sigaction ending {};
  ending.sa_handler = SIG_DFL;
  sigaction(SIGBUS, &ending, nullptr);
  raise(SIGBUS);
}

/// Calls only what a handler of signals may, `mremap` being a bare system call.
void survive(int signal, siginfo_t* info, void* context) {
  const int error = errno;
  for (Place& place : places) {
    char* const begin = place.begin.load(std::memory_order_acquire);
    if (begin == nullptr || info->si_code <= 0) continue;
    const auto offset = reinterpret_cast<std::uintptr_t>(info->si_addr) - reinterpret_cast<std::uintptr_t>(begin);
    if (offset >= place.bytes) continue;
    // Of several threads that touch it at once one moves the zeros; the others touch it again, until they are there.
    const bool first = !place.cut.exchange(true, std::memory_order_acq_rel);
    if (first && mremap(place.zeros, place.bytes, place.bytes, MREMAP_MAYMOVE | MREMAP_FIXED, begin) == MAP_FAILED) {
      break;
    }
    errno = error;
    return;
  }
  pass_on(signal, info, context);
}

bool install() {
  struct sigaction ours {};
  ours.sa_sigaction = &survive;
  ours.sa_flags = SA_SIGINFO | SA_ONSTACK;
  sigemptyset(&ours.sa_mask);
  return sigaction(SIGBUS, nullptr, &handler_before) == 0 && sigaction(SIGBUS, &ours, nullptr) == 0;
}

void* mapped(std::size_t bytes, int flags, int file) {
  return mmap(nullptr, bytes, PROT_READ | PROT_WRITE, flags | MAP_POPULATE, file, 0);
}

}  // namespace

std::optional<SharedMapping> SharedMapping::map(int file, std::size_t bytes) {
  static const bool installed = install();
  if (!installed) return std::nullopt;
  for (std::size_t i = 0; i < places.size(); ++i) {
    Place& place = places[i];
    if (place.taken.exchange(true, std::memory_order_acq_rel)) continue;
    place.bytes = bytes;
    place.cut.store(false);
    place.zeros = mapped(bytes, MAP_PRIVATE | MAP_ANONYMOUS, -1);
    void* const memory = place.zeros == MAP_FAILED ? MAP_FAILED : mapped(bytes, MAP_SHARED, file);
    if (memory != MAP_FAILED) {
      place.begin.store(static_cast<char*>(memory), std::memory_order_release);
      return SharedMapping(i);
    }
    const int error = errno;
    if (place.zeros != MAP_FAILED) munmap(place.zeros, bytes);
    place.taken.store(false, std::memory_order_release);
    errno = error;
    return std::nullopt;
  }
  errno = EMFILE;
  return std::nullopt;
}

SharedMapping::~SharedMapping() {
  if (place_ == none) return;
  Place& place = places[place_];
  char* const begin = place.begin.exchange(nullptr);
  munmap(begin, place.bytes);
  if (!place.cut.load()) munmap(place.zeros, place.bytes);
  place.taken.store(false, std::memory_order_release);
}

void* SharedMapping::data() const noexcept { return places[place_].begin.load(std::memory_order_relaxed); }

bool SharedMapping::is_cut() const noexcept { return places[place_].cut.load(std::memory_order_acquire); }

}  // namespace tactus::runtime
