// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/arm_plants/tool_operator.hpp>

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace tactus::arm_plants {

ToolOperator::ToolOperator(const Params& params, Seconds tick, const ToolState& tool, const signal::LowPass& low_pass)
    : hand_(params.hand),
      correction_gain_per_s_(params.correction_gain_per_s),
      tremor_amplitude_m_(params.tremor_amplitude_m),
      tremor_frequency_Hz_(params.tremor_frequency_Hz),
      tick_s_(tick.value),
      attitude_(tool.rotation),
      low_pass_{low_pass, low_pass, low_pass},
      felt_m_(static_cast<std::size_t>(std::lround(params.reaction_time_s / tick.value)) + 1, Vector3::Zero()),
      aim_m_(tool.position_m) {}

Result<ToolOperator> ToolOperator::make(const Params& params, Seconds tick, const ToolState& tool) {
  if (Check wrong = validate(params)) return *std::move(wrong);
  const auto low_pass = signal::LowPass::make({.cutoff_Hz = params.correction_bandwidth_Hz}, tick);
  if (!low_pass) return under("correction_bandwidth_Hz", low_pass.error());
  return ToolOperator(params, tick, tool, *low_pass);
}

Vector3 ToolOperator::tremor_m(std::int64_t tick) const {
  if (tremor_amplitude_m_ == 0.0) return Vector3::Zero();
  Vector3 shakes;
  for (int axis = 0; axis < 3; ++axis) {
    const double cycles = tremor_frequency_Hz_ * tick_s_ * static_cast<double>(tick) + axis / 3.0;
    shakes[axis] = tremor_amplitude_m_ * std::sin(2.0 * std::numbers::pi * cycles);
  }
  return shakes;
}

void ToolOperator::begin_tick(const Vector3& path_m, const Vector3& path_at_next_tick_m, const ToolState& tool) {
  Vector3 felt;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    felt[axis] = low_pass_[i].step(tool.position_m[axis] - path_m[axis]);
  }
  felt_m_[next_] = felt;
  next_ = next_ + 1 == felt_m_.size() ? 0 : next_ + 1;
  const Vector3 correction_m_per_s = -correction_gain_per_s_ * felt_m_[next_];
  const Vector3 tremor_now_m = tremor_m(tick_), tremor_next_m = tremor_m(++tick_);
  aim_m_ = path_m + tremor_now_m + correction_m_;
  aim_m_per_s_ = (path_at_next_tick_m - path_m + tremor_next_m - tremor_now_m) / tick_s_ + correction_m_per_s;
  correction_m_ += correction_m_per_s * tick_s_;
}

ToolForce ToolOperator::force(const ToolState& tool, double since_tick_s) const {
  // Half of the sum of the axes' cross products: the turn that is missing, for small ones.
  Vector3 turned = Vector3::Zero();
  for (int axis = 0; axis < 3; ++axis) turned += 0.5 * tool.rotation.col(axis).cross(attitude_.col(axis));
  const double lever2_m2 = hand_.lever_m * hand_.lever_m;
  const Vector3 off_m = aim_m_ + since_tick_s * aim_m_per_s_ - tool.position_m;
  return {
      .force_N = hand_.stiffness_N_per_m * off_m + hand_.damping_N_s_per_m * (aim_m_per_s_ - tool.velocity_m_per_s),
      .moment_N_m = lever2_m2 * (hand_.stiffness_N_per_m * turned - hand_.damping_N_s_per_m * tool.turning_rad_per_s)};
}

}  // namespace tactus::arm_plants
