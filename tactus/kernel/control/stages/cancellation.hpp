// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/model/induced_motion_model.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

namespace tactus::control {

/// Cancellation of induced master motion: what the operator meant, from where the motor is and what force was displayed
/// (paper A, eq. 7 and 8): x̂_intended = x_m − x̂_induced.
///
/// The model's position at a tick comes from the forces displayed up to that tick, so it is subtracted from the sample
/// of the same instant, before the new force acts: one tick of misalignment costs about half of what 10 % error in
/// stiffness does. It uses no signal from the slave, so delay does not affect it. After the sample arrives
/// there is one subtraction to do; the model's own step comes after it.
class Cancellation {
 public:
  struct Params {
    InducedMotionModel::Params model;
    signal::FilteredDerivative::Params intended_velocity{.cutoff_Hz = 30.0};
    static constexpr auto fields() {
      return List{field("model", &Params::model, "The model of induced motion."),
                  field("intended_velocity", &Params::intended_velocity,
                        "Filter for the intended velocity that the model's friction sees.")};
    }
  };
  struct Input {
    double measured_position_m = 0.0;  ///< of the motor, now
    double motor_force_N = 0.0;        ///< that acts from now to the next tick, positive toward the environment
  };
  /// The motor position in m that the operator intended.
  using Output = double;

  static Result<Cancellation> make(const Params& params, Seconds dt);

  /// The position in m that the operator intended, from the one measured now, a finite number: another one stays in the
  /// filter until `reset`. Once a tick. Real-time safe.
  double intended(double measured_position_m) noexcept {
    const double intended_m = measured_position_m - model_.motor_position_m();
    intended_velocity_m_per_s_ = intended_velocity_.step(intended_m);
    return intended_m;
  }
  /// Advances the model to the next tick, under the force that really acts until then, a finite number. Real-time safe.
  void advance(double motor_force_N) noexcept {
    model_.step({.motor_force_N = motor_force_N, .intended_velocity_m_per_s = intended_velocity_m_per_s_});
  }
  /// Both at once.
  Output step(const Input& input) noexcept {
    const double intended_m = intended(input.measured_position_m);
    advance(input.motor_force_N);
    return intended_m;
  }

  void reset() noexcept {
    model_.reset();
    intended_velocity_.reset();
    intended_velocity_m_per_s_ = 0.0;
  }

  [[nodiscard]] const InducedMotionModel& model() const noexcept { return model_; }

 private:
  Cancellation(const InducedMotionModel& model, const signal::FilteredDerivative& intended_velocity)
      : model_(model), intended_velocity_(intended_velocity) {}

  InducedMotionModel model_;
  signal::FilteredDerivative intended_velocity_;
  double intended_velocity_m_per_s_ = 0.0;
};

}  // namespace tactus::control
