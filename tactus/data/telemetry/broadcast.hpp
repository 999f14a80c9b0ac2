// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <type_traits>
#include <utility>

namespace tactus::telemetry {

/// From one producer thread to any number of consumers, each of which sees every value: one copy for all observers. The
/// producer never waits and never looks at a consumer. Fixed capacity, no allocation after it was made.
///
/// A consumer that falls behind by more than the capacity finds the oldest values overwritten: it continues with the
/// oldest that is left and counts what it lost. Others lose nothing by that.
///
/// A value travels as words, each stored with `release` behind the count of pushes that have begun and loaded with
/// `acquire` before that count is read again. So a consumer that met a word of a later value sees the later count too,
/// and drops what it has copied.
template <class T, std::size_t Capacity>
class Broadcast {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(std::uint64_t) == 0);
  static_assert(std::has_single_bit(Capacity), "a power of two, so that the remainder is a mask");

 public:
  /// One consumer: one thread at a time. It sees what is pushed after it was made, and keeps the broadcast alive.
  class Reader {
   public:
    explicit Reader(std::shared_ptr<const Broadcast> source)
        : source_(std::move(source)), next_(source_->done_.load(std::memory_order_acquire)) {}

    /// The oldest value that was not read yet and is still there; false without one.
    bool next(T& value) noexcept {
      while (next_ != source_->done_.load(std::memory_order_acquire)) {
        const Slot& slot = source_->slots_[next_ & (Capacity - 1)];
        Words words;
        for (std::size_t i = 0; i < words.size(); ++i) words[i] = slot.words[i].load(std::memory_order_acquire);
        const std::uint64_t begun = source_->begun_.load(std::memory_order_relaxed);
        if (begun - next_ <= Capacity) {
          ++next_;
          std::memcpy(static_cast<void*>(&value), words.data(), sizeof(T));
          return true;
        }
        lost_ += begun - Capacity - next_;
        next_ = begun - Capacity;
      }
      return false;
    }

    /// Values that were overwritten before this consumer read them. Its thread.
    [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }

   private:
    std::shared_ptr<const Broadcast> source_;
    std::uint64_t next_;
    std::uint64_t lost_ = 0;
  };

  /// Producer only. Real-time safe: wait-free, one copy, no system call.
  void push(const T& value) noexcept {
    const std::uint64_t number = done_.load(std::memory_order_relaxed);
    begun_.store(number + 1, std::memory_order_relaxed);
    Words words;
    std::memcpy(words.data(), &value, sizeof(T));
    Slot& slot = slots_[number & (Capacity - 1)];
    for (std::size_t i = 0; i < words.size(); ++i) slot.words[i].store(words[i], std::memory_order_release);
    done_.store(number + 1, std::memory_order_release);
  }

 private:
  static constexpr std::size_t cache_line = 64;
  using Words = std::array<std::uint64_t, sizeof(T) / sizeof(std::uint64_t)>;
  struct alignas(cache_line) Slot {
    std::array<std::atomic<std::uint64_t>, sizeof(T) / sizeof(std::uint64_t)> words{};
  };

  alignas(cache_line) std::atomic<std::uint64_t> begun_{0};  ///< pushes
  std::atomic<std::uint64_t> done_{0};                       ///< of them, ended
  std::array<Slot, Capacity> slots_;
};

}  // namespace tactus::telemetry
