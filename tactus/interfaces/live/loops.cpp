// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/arm_loop.hpp>
#include <tactus/interfaces/live/axis_loop.hpp>

namespace tactus::live {

Result<std::unique_ptr<Loop>> make_loop(const LoopParams& params, double start_m) {
  if (const auto* arms = std::get_if<experiments::ArmPairSetup>(&params)) return ArmLoop::make(*arms);
  return AxisLoop::make(std::get<simulation::Teleoperator::Params>(params), start_m);
}

Result<LoopChange> change_loop(const LoopParams& before, const LoopParams& after, double start_m) {
  if (const auto* arms = std::get_if<experiments::ArmPairSetup>(&before)) {
    return ArmLoop::change(*arms, std::get<experiments::ArmPairSetup>(after));
  }
  using Params = simulation::Teleoperator::Params;
  return AxisLoop::change(std::get<Params>(before), std::get<Params>(after), start_m);
}

double force_limit_N(const LoopParams& params) {
  const auto* axis = std::get_if<simulation::Teleoperator::Params>(&params);
  return axis == nullptr ? 0.0 : axis->control.force_limit_N;
}

}  // namespace tactus::live
