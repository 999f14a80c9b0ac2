// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/arm_advise.hpp>
#include <tactus/analysis/advice/arm_trial.hpp>
#include <tactus/analysis/advice/internal/arm_costs.hpp>

#include <cstddef>

namespace tactus::advice {

Result<ArmCosts> ArmCosts::make(const ArmBench& bench, const Method& bare) {
  ArmCosts costs(bench);
  auto plain = costs.of(bare, 1.0);
  if (!plain) return plain.error();
  costs.plain_ = *std::move(plain);
  return costs;
}

Result<std::vector<experiments::ArmReach>> ArmCosts::of(const Method& method, double gain) const {
  const auto params = params_of(*bench_, method, {{"control.force_gain", format_number(gain)}});
  if (!params) return params.error();
  return reaches(*bench_, *params);
}

bool ArmCosts::allow(const std::vector<experiments::ArmReach>& reach) const {
  for (std::size_t i = 0; i < reach.size(); ++i) {
    if (reach[i].lag_m > plain_[i].lag_m + most_lag_more_m) return false;
  }
  for (std::size_t hand = 0; hand < bench_->hands.size(); ++hand) {
    if (reach[hand].effort_N > most_effort_factor * plain_[hand].effort_N) return false;
  }
  return true;
}

bool ArmCosts::allow(const Method& method, double gain) const {
  const auto reach = of(method, gain);
  return reach && allow(*reach);
}

}  // namespace tactus::advice
