// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/arm_bench.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>

#include <utility>
#include <vector>

namespace tactus::advice {

/// What a configuration may cost in free reaches (`most_lag_more_m`, `most_effort_factor`).
class ArmCosts {
 public:
  /// Beside `bare` at gain 1. The bench outlives it. Errors: those of `reaches`.
  static Result<ArmCosts> make(const ArmBench& bench, const Method& bare);

  /// What `reaches` has for a method at a gain. Errors: those of it, and of reading the document.
  [[nodiscard]] Result<std::vector<experiments::ArmReach>> of(const Method& method, double gain) const;
  [[nodiscard]] bool allow(const std::vector<experiments::ArmReach>& reach) const;
  [[nodiscard]] bool allow(const Method& method, double gain) const;
  /// Of `bare`.
  [[nodiscard]] const std::vector<experiments::ArmReach>& plain() const { return plain_; }

 private:
  explicit ArmCosts(const ArmBench& bench) : bench_(&bench) {}

  const ArmBench* bench_;
  std::vector<experiments::ArmReach> plain_;
};

}  // namespace tactus::advice
