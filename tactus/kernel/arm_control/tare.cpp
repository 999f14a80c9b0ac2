// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/tare.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::arm_control {

Tare::Tare(const Params& params, const arm::Chain& model, const Drives& drives, Seconds dt)
    : model_(model),
      drives_(drives),
      amplitude_rad_(params.amplitude_rad),
      first_(std::lround(1.0 / (params.frequency_Hz * dt.value))),
      last_((1 + params.cycles) * first_),
      start_(JointVector::Zero(model.joints())),
      sum_(start_),
      lowest_(start_),
      highest_(start_) {
  turn_rad_ = 2.0 * std::numbers::pi / static_cast<double>(first_);
}

Result<Tare> Tare::make(const Params& params, const arm::Chain& model, const Drives& drives, Seconds dt) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  return Tare(params, model, drives, dt);
}

void Tare::restart() noexcept {
  tick_ = 0;
  sum_.setZero();
}

ArmCommand Tare::step(const ArmReading& reading) noexcept {
  if (tick_ == 0) start_ = reading.position;
  const JointVector gravity = model_.gravity_torque(reading.position);
  if (tick_ == first_) lowest_ = highest_ = reading.position;
  if (tick_ >= first_ && tick_ < last_) {
    sum_ += reading.torque - gravity;
    lowest_ = lowest_.cwiseMin(reading.position);
    highest_ = highest_.cwiseMax(reading.position);
  }
  const double share = std::min(1.0, static_cast<double>(tick_) / static_cast<double>(first_));
  const double angle = turn_rad_ * static_cast<double>(tick_);
  ++tick_;
  away_rad_ = share * amplitude_rad_ * std::sin(angle);
  return {.position = start_ + JointVector::Constant(start_.size(), away_rad_),
          .velocity = JointVector::Zero(start_.size()),
          .stiffness = drives_.stiffness_N_m_per_rad,
          .damping = drives_.damping_N_m_s_per_rad,
          .torque = gravity};
}

}  // namespace tactus::arm_control
