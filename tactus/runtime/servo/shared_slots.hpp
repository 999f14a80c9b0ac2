// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

namespace tactus::runtime {

/// The latest values of one producer, for readers in other threads and other processes: it lies in shared memory as it
/// is, holds no pointer and takes no lock. Wait-free on both sides, without a system call or an allocation: every call
/// is a bounded number of steps whatever the other side does, also where that was killed in the middle of a step.
///
/// A ring of slots, each a seqlock: the number of its value is taken away before the value is written and put back
/// after it. With more than one slot the producer writes where nobody reads: a reader finds a value in motion only if
/// the producer went once around the ring meanwhile, and detects it. The words are atomics, stored with `release` and
/// loaded with `acquire`, so that whoever saw a word of a new value also sees that the old number is gone; no fence is
/// needed, and thread sanitizers understand it.
///
/// Memory of zeros is a valid, empty one.
template <class Value, std::size_t count>
class SharedSlots {
  static_assert(std::is_trivially_copyable_v<Value> && sizeof(Value) % sizeof(std::uint64_t) == 0);
  static_assert(std::has_single_bit(count), "a power of two, so that numbers run over without a jump");
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free, "a lock would be of one process");

 public:
  static constexpr std::uint64_t capacity = count;

  /// Producer only.
  void publish(const Value& value) noexcept {
    const std::uint64_t number = published_.load(std::memory_order_relaxed);
    Slot& slot = slots_[number % count];
    slot.holds.store(in_motion, std::memory_order_relaxed);
    const auto words = std::bit_cast<Words>(value);
    for (std::size_t i = 0; i < words.size(); ++i) slot.words[i].store(words[i], std::memory_order_release);
    slot.holds.store(number + 1, std::memory_order_release);
    published_.store(number + 1, std::memory_order_release);
  }

  /// How many values were published. Any thread.
  [[nodiscard]] std::uint64_t published() const noexcept { return published_.load(std::memory_order_acquire); }

  /// The value of that number, counted from 0; none where it is not there yet, not there any more, or being
  /// overwritten. Any thread.
  [[nodiscard]] std::optional<Value> at(std::uint64_t number) const noexcept {
    const Slot& slot = slots_[number % count];
    if (slot.holds.load(std::memory_order_acquire) != number + 1) return std::nullopt;
    Words words;
    for (std::size_t i = 0; i < words.size(); ++i) words[i] = slot.words[i].load(std::memory_order_acquire);
    if (slot.holds.load(std::memory_order_relaxed) != number + 1) return std::nullopt;
    return std::bit_cast<Value>(words);
  }

  /// The latest value; none before the first, or where the producer went around the ring twice during the call.
  /// Any thread.
  [[nodiscard]] std::optional<Value> newest() const noexcept {
    for (int attempt = 0; attempt < 2; ++attempt) {
      const std::uint64_t number = published();
      if (number == 0) return std::nullopt;
      if (auto value = at(number - 1)) return value;
    }
    return std::nullopt;
  }

 private:
  using Words = std::array<std::uint64_t, sizeof(Value) / sizeof(std::uint64_t)>;
  static constexpr std::uint64_t in_motion = std::numeric_limits<std::uint64_t>::max();
  static constexpr std::size_t cache_line = 64;

  struct alignas(cache_line) Slot {
    std::atomic<std::uint64_t> holds;  ///< number of its value, from 1; 0 where it never had one
    std::array<std::atomic<std::uint64_t>, sizeof(Value) / sizeof(std::uint64_t)> words;
  };

  alignas(cache_line) std::atomic<std::uint64_t> published_;
  std::array<Slot, count> slots_;
};

}  // namespace tactus::runtime
