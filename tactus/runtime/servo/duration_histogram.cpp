// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/duration_histogram.hpp>

namespace tactus::runtime {

double DurationHistogram::quantile_ns(double q) const noexcept {
  if (count_ == 0) return 0.0;
  const double rank = std::clamp(q, 0.0, 1.0) * static_cast<double>(count_);
  double before = 0.0;
  for (std::size_t i = 0; i < buckets; ++i) {
    const auto here = static_cast<double>(counts_[i]);
    if (here > 0.0 && before + here >= rank) {
      const auto lower = static_cast<double>(lower_ns(i));
      const auto upper = static_cast<double>(lower_ns(i + 1));
      const double value = lower + (upper - lower) * (rank - before) / here;
      return std::clamp(value, static_cast<double>(least_ns_), static_cast<double>(largest_ns_));
    }
    before += here;
  }
  return static_cast<double>(largest_ns_);
}

}  // namespace tactus::runtime
