// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/motors.hpp>
#include <tactus/kernel/arm_control/each_joint.hpp>
#include <tactus/kernel/core/parameters.hpp>

/// What controls an arm's joints together.
namespace tactus::arm_control {

using arm::ArmCommand;
using arm::ArmReading;
using arm::JointVector;

/// External torque of a rigid arm from its motors alone: the momentum that torque, gravity and friction did not put in
/// came from outside (generalised-momentum observer with the full model).
///
///     r = g/(s + g) · (d/dt(M q̇) − Ṁ q̇ + c + gravity + friction − τ),   g = 2π·cutoff of the joint
///
/// Ticks are in for the integral: M·(q̇_k − q̇_{k−1})/dt is what d/dt(M q̇) − Ṁ q̇ comes to, torque, bias and friction
/// are the means of both ticks, and r answers a step of external torque by exactly 1 − exp(−g·k·dt) after k ticks. That
/// form has no integrator that could drift. Velocity is what the drive reports: its step δ makes a noise of about
/// M·δ·g. On elastic joints the link's own swing is taken for a torque from outside: `ElasticTorqueObserver` is for
/// those. Positive in the direction in which the position grows. Cutoff: up to half the sample rate. Starts at rest.
/// Source: A. De Luca, R. Mattone, Actuator failure detection and isolation using generalized momenta, ICRA 2003.
class ExternalTorqueObserver {
 public:
  struct Params {
    double cutoff_Hz = 30.0;
    EachJoint<JointCutoff> cutoff_each = {};
    static constexpr auto fields() {
      return List{field("cutoff_Hz", &Params::cutoff_Hz, units::hertz, positive_up_to(1000.0),
                        "-3 dB frequency of the estimate of external torque, if the velocity is exact."),
                  field("cutoff_each", &Params::cutoff_each, "Separate corner frequencies for single joints.")};
    }
  };

  /// `model` is what the arm is assumed to be. Errors: a cutoff out of bounds or beyond half the sample rate.
  static Result<ExternalTorqueObserver> make(const Params& params, const arm::Chain& model, Seconds dt);

  /// Torque in N m that is not the motors', the model's gravity's, motion's or friction's. Once a tick, with the
  /// readings of one instant. Real-time safe.
  JointVector step(const ArmReading& reading) noexcept;
  void reset() noexcept { started_ = false; }

 private:
  ExternalTorqueObserver(const arm::Chain& model, Seconds dt, const JointVector& kept);

  arm::Chain model_;
  double dt_s_;
  JointVector kept_;  ///< of the estimate from tick to tick
  bool started_ = false;
  JointVector velocity_;  ///< at the tick before
  JointVector unmoved_;   ///< torque less bias and friction, then
  JointVector estimate_;
};

/// The corner of each joint. Errors: a number out of bounds, or a corner beyond half the sample rate.
Result<JointVector> corners(const ExternalTorqueObserver::Params& params, int joints, Seconds dt);

}  // namespace tactus::arm_control
