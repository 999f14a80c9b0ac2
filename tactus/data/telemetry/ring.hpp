// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactus::telemetry {

/// A queue from one producer thread to one consumer thread, wait-free on both sides: each call is a bounded number of
/// steps whatever the other side does. Fixed capacity, no allocation.
///
/// One counter for each side, ever growing, taken modulo the capacity; each is written by one thread only. `release` on
/// the own counter and `acquire` on the other's hand the slot over. Each side keeps the last value it saw of the
/// other's counter, so the shared cache line is touched only when that states full or empty.
///
/// Where the ring is full the new value is dropped and counted, and the old ones stay: what is lost is then one gap
/// with a known place.
template <class T, std::size_t Capacity>
class Ring {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert(std::has_single_bit(Capacity), "a power of two, so that the remainder is a mask");

 public:
  /// Producer only. False, and counted, where the ring is full. Real-time safe.
  bool try_push(const T& value) noexcept {
    const std::uint64_t tail = tail_.load(std::memory_order_relaxed);
    if (tail - seen_head_ == Capacity) {
      seen_head_ = head_.load(std::memory_order_acquire);
      if (tail - seen_head_ == Capacity) {
        dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        return false;
      }
    }
    slots_[tail & (Capacity - 1)] = value;
    tail_.store(tail + 1, std::memory_order_release);
    return true;
  }

  /// Consumer only. False where the ring is empty. Real-time safe.
  bool try_pop(T& value) noexcept {
    const std::uint64_t head = head_.load(std::memory_order_relaxed);
    if (head == seen_tail_) {
      seen_tail_ = tail_.load(std::memory_order_acquire);
      if (head == seen_tail_) return false;
    }
    value = slots_[head & (Capacity - 1)];
    head_.store(head + 1, std::memory_order_release);
    return true;
  }

  /// How many values were dropped so far. Any thread.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  static constexpr std::size_t cache_line = 64;
  alignas(cache_line) std::atomic<std::uint64_t> tail_{0};
  std::uint64_t seen_head_ = 0;
  std::atomic<std::uint64_t> dropped_{0};
  alignas(cache_line) std::atomic<std::uint64_t> head_{0};
  std::uint64_t seen_tail_ = 0;
  alignas(cache_line) std::array<T, Capacity> slots_{};
};

}  // namespace tactus::telemetry
