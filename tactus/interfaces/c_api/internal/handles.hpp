// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace tactus::c_api {

/// The objects behind the handles of one kind.
///
/// A handle is the number of a place, a count of how often that place was used, and the kind: a handle that was
/// released finds nothing, even if its place has another object since. Places are never given back to the system, so a
/// look at one is always a look at memory of ours. At most `capacity` objects at a time.
///
/// Any thread. `find` neither locks nor allocates; the object that it finds is good until its handle is released.
template <class T, unsigned kind>
class Handles {
 public:
  static constexpr std::size_t capacity = 65536;

  /// The new object's handle; 0 where there are `capacity` of them.
  std::uint64_t add(T object) {
    auto owned = std::make_unique<T>(std::move(object));
    const std::lock_guard lock(mutex_);
    if (free_.empty() && !add_block()) return 0;
    const std::size_t at = free_.back();
    Place* const place = place_of(at);
    if (place == nullptr) return 0;
    free_.pop_back();
    place->object = std::move(owned);
    const std::uint64_t handle = (++place->uses << use_shift) | (at << kind_bits) | kind;
    place->handle.store(handle, std::memory_order_release);
    return handle;
  }

  /// Null for a handle that was released, was never given out, or is of another kind.
  T* find(std::uint64_t handle) noexcept {
    Place* const place = used_place(handle);
    return place != nullptr ? place->object.get() : nullptr;
  }

  /// False where `find` finds nothing.
  bool release(std::uint64_t handle) {
    std::unique_ptr<T> object;  // goes after the lock
    const std::lock_guard lock(mutex_);
    Place* const place = used_place(handle);
    if (place == nullptr) return false;
    place->handle.store(0, std::memory_order_release);
    object = std::move(place->object);
    free_.push_back(index_of(handle));
    return true;
  }

 private:
  static constexpr unsigned kind_bits = 4, use_shift = 24;
  static constexpr std::size_t block_size = 256;
  static_assert(kind > 0 && kind < 1U << kind_bits);
  static_assert(capacity << kind_bits <= std::size_t{1} << use_shift);

  struct Place {
    std::atomic<std::uint64_t> handle{0};  ///< 0 while the place is free
    std::uint64_t uses = 0;
    std::unique_ptr<T> object;
  };
  using Block = std::array<Place, block_size>;

  static std::size_t index_of(std::uint64_t handle) noexcept {
    return static_cast<std::size_t>((handle & ((std::uint64_t{1} << use_shift) - 1)) >> kind_bits);
  }

  Place* place_of(std::size_t at) noexcept {
    if (at >= capacity) return nullptr;
    Block* const block = blocks_[at / block_size].load(std::memory_order_acquire);
    return block != nullptr ? &(*block)[at % block_size] : nullptr;
  }

  Place* used_place(std::uint64_t handle) noexcept {
    Place* const place = place_of(index_of(handle));
    const bool used = handle != 0 && place != nullptr && place->handle.load(std::memory_order_acquire) == handle;
    return used ? place : nullptr;
  }

  bool add_block() {
    if (owned_.size() == blocks_.size()) return false;
    const std::size_t first = owned_.size() * block_size;
    free_.reserve(capacity);
    owned_.push_back(std::make_unique<Block>());
    for (std::size_t i = block_size; i > 0; --i) free_.push_back(first + i - 1);
    blocks_[first / block_size].store(owned_.back().get(), std::memory_order_release);
    return true;
  }

  std::mutex mutex_;
  std::vector<std::size_t> free_;
  std::vector<std::unique_ptr<Block>> owned_;
  std::array<std::atomic<Block*>, capacity / block_size> blocks_{};
};

}  // namespace tactus::c_api
