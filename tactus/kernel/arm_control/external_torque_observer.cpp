// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/external_torque_observer.hpp>
#include <tactus/kernel/arm_control/joint_cutoff.hpp>

#include <cmath>
#include <numbers>

namespace tactus::arm_control {

ExternalTorqueObserver::ExternalTorqueObserver(const arm::Chain& model, Seconds dt, const JointVector& kept)
    : model_(model),
      dt_s_(dt.value),
      kept_(kept),
      velocity_(JointVector::Zero(model.joints())),
      unmoved_(velocity_),
      estimate_(velocity_) {}

Result<ExternalTorqueObserver> ExternalTorqueObserver::make(const Params& params, const arm::Chain& model, Seconds dt) {
  const auto each_Hz = corners(params, model.joints(), dt);
  if (!each_Hz) return each_Hz.error();
  const JointVector kept =
      each_Hz->unaryExpr([dt](double Hz) { return std::exp(-2.0 * std::numbers::pi * Hz * dt.value); });
  return ExternalTorqueObserver(model, dt, kept);
}

JointVector ExternalTorqueObserver::step(const ArmReading& reading) noexcept {
  const JointVector bias = model_.bias(reading.position, reading.velocity);
  const JointVector unmoved = reading.torque - bias - model_.friction(reading.velocity, bias);
  if (started_) {
    const JointVector change = model_.mass_matrix(reading.position) * (reading.velocity - velocity_);
    const JointVector outside = change / dt_s_ - 0.5 * (unmoved + unmoved_);
    for (Eigen::Index i = 0; i < outside.size(); ++i) {
      estimate_[i] = kept_[i] * estimate_[i] + (1.0 - kept_[i]) * outside[i];
    }
  } else {
    estimate_.setZero();
    started_ = true;
  }
  velocity_ = reading.velocity;
  unmoved_ = unmoved;
  return estimate_;
}

Result<JointVector> corners(const ExternalTorqueObserver::Params& params, int joints, Seconds dt) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  const Check wrong = check_cutoffs("cutoff_Hz", params.cutoff_Hz, "cutoff_each", params.cutoff_each, joints, dt);
  if (wrong) return *wrong;
  return cutoffs(params.cutoff_Hz, params.cutoff_each, joints);
}

}  // namespace tactus::arm_control
