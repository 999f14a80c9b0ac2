// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace tactus::runtime {

/// How often durations of which length occurred, in fixed buckets: exact below 64 ns, then 64 buckets for each
/// doubling, up to 18 minutes; what is longer counts in the last. A bucket is at most 1/64 wide, so a quantile errs by
/// at most 1.6 %. Least and largest are exact.
///
/// A value without pointers. `add` is real-time safe: no allocation, no branch on what was added before.
class DurationHistogram {
 public:
  static constexpr int exact_bits = 6;
  static constexpr int longest_bits = 40;
  static constexpr std::size_t per_doubling = std::size_t{1} << exact_bits;
  static constexpr std::size_t buckets = (longest_bits - exact_bits + 1) * per_doubling;

  /// A negative duration counts as 0.
  void add(std::int64_t duration_ns) noexcept {
    const std::int64_t value = std::max<std::int64_t>(duration_ns, 0);
    ++counts_[bucket_of(static_cast<std::uint64_t>(value))];
    ++count_;
    least_ns_ = std::min(least_ns_, value);
    largest_ns_ = std::max(largest_ns_, value);
  }

  /// Adds what another one has counted.
  void add(const DurationHistogram& other) noexcept {
    for (std::size_t i = 0; i < buckets; ++i) counts_[i] += other.counts_[i];
    count_ += other.count_;
    least_ns_ = std::min(least_ns_, other.least_ns_);
    largest_ns_ = std::max(largest_ns_, other.largest_ns_);
  }

  [[nodiscard]] std::int64_t count() const noexcept { return count_; }
  /// 0 without a value.
  [[nodiscard]] std::int64_t least_ns() const noexcept { return count_ == 0 ? 0 : least_ns_; }
  [[nodiscard]] std::int64_t largest_ns() const noexcept { return largest_ns_; }

  /// The duration in ns that a share `q` (0 to 1) of the values does not exceed, evenly spread within its bucket; 0
  /// without a value.
  [[nodiscard]] double quantile_ns(double q) const noexcept;

  [[nodiscard]] std::int64_t count_of(std::size_t bucket) const noexcept { return counts_[bucket]; }
  /// The durations of a bucket: from `lower_ns(i)`, included, to `lower_ns(i + 1)`.
  static std::uint64_t lower_ns(std::size_t bucket) noexcept {
    if (bucket < per_doubling) return bucket;
    const std::size_t shift = bucket / per_doubling - 1;
    return (per_doubling + bucket % per_doubling) << shift;
  }
  static std::size_t bucket_of(std::uint64_t duration_ns) noexcept {
    const std::uint64_t value = std::min(duration_ns, (std::uint64_t{1} << longest_bits) - 1);
    if (value < per_doubling) return static_cast<std::size_t>(value);
    const auto shift = static_cast<std::size_t>(std::bit_width(value)) - 1 - exact_bits;
    return shift * per_doubling + static_cast<std::size_t>(value >> shift);
  }

 private:
  std::array<std::int64_t, buckets> counts_{};
  std::int64_t count_ = 0;
  std::int64_t least_ns_ = std::numeric_limits<std::int64_t>::max();
  std::int64_t largest_ns_ = 0;
};

}  // namespace tactus::runtime
