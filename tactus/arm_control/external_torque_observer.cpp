#include <tactus/arm_control/external_torque_observer.hpp>
#include <tactus/signal/checks.hpp>

#include <cmath>
#include <numbers>

namespace tactus::arm_control {

ExternalTorqueObserver::ExternalTorqueObserver(const arm::Chain& model, Seconds dt, double kept)
    : model_(model),
      dt_s_(dt.value),
      kept_(kept),
      velocity_(JointVector::Zero(model.joints())),
      unmoved_(velocity_),
      estimate_(velocity_) {}

Result<ExternalTorqueObserver> ExternalTorqueObserver::make(const Params& params, const arm::Chain& model, Seconds dt) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  if (Check wrong = signal::check_below_nyquist("cutoff_Hz", params.cutoff_Hz, dt)) return *std::move(wrong);
  return ExternalTorqueObserver(model, dt, std::exp(-2.0 * std::numbers::pi * params.cutoff_Hz * dt.value));
}

JointVector ExternalTorqueObserver::step(const ArmReading& reading) noexcept {
  const JointVector bias = model_.bias(reading.position, reading.velocity);
  const JointVector unmoved = reading.torque - bias - model_.friction(reading.velocity, bias);
  if (started_) {
    const JointVector change = model_.mass_matrix(reading.position) * (reading.velocity - velocity_);
    estimate_ = kept_ * estimate_ + (1.0 - kept_) * (change / dt_s_ - 0.5 * (unmoved + unmoved_));
  } else {
    estimate_.setZero();
    started_ = true;
  }
  velocity_ = reading.velocity;
  unmoved_ = unmoved;
  return estimate_;
}

}  // namespace tactus::arm_control
