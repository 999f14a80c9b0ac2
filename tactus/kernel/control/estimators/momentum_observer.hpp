// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/force_estimator.hpp>
#include <tactus/kernel/control/estimators/slave_model.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>

#include <numbers>

namespace tactus::control {

/// Generalised-momentum observer, for one axis the reaction force observer: momentum that the model did not put in came
/// from the environment. No acceleration is needed.
///
///     F̂_e = g·( M v − ∫ (K_a u − h v − friction(v) + F̂_e) dt ),   g = 2π·cutoff
///
/// With an exact model and velocity F̂_e = g/(s + g)·F_e: first order, where the disturbance observer is second order.
/// The integral is summed tick by tick with the values at its beginning, so that the step response after k ticks is
/// 1 − (1 − g·dt)^k. v is the low-passed difference of the measured position and lags by what its filter lags. Starts
/// at rest wherever the first sample is.
/// Range: cutoff up to 1/(2π·dt), where the observer answers in one tick.
/// Sources: A. De Luca, R. Mattone, Actuator failure detection and isolation using generalized momenta, ICRA 2003;
/// T. Murakami, F. Yu, K. Ohnishi, Torque sensorless control in multidegree-of-freedom manipulator, IEEE Trans.
/// Industrial Electronics 40(2), 1993.
class MomentumObserver {
 public:
  struct Params {
    SlaveModel model{};
    double cutoff_Hz = 100.0;
    signal::FilteredDerivative::Params velocity{.cutoff_Hz = 300.0};
    static constexpr auto fields() {
      return List{field("model", &Params::model, "The nominal slave."),
                  field("cutoff_Hz", &Params::cutoff_Hz, units::hertz, positive,
                        "-3 dB frequency of the estimate, if the velocity is exact."),
                  field("velocity", &Params::velocity, "Low-pass of the velocity.")};
    }
  };
  using Input = SlaveMotionSample;
  using Output = ForceEstimate;

  static Result<MomentumObserver> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    const double highest_Hz = 1.0 / (2.0 * std::numbers::pi * dt.value);
    if (params.cutoff_Hz > highest_Hz) {
      return out_of_bounds("cutoff_Hz", params.cutoff_Hz, positive_up_to(highest_Hz), units::hertz);
    }
    const auto velocity = signal::FilteredDerivative::make(params.velocity, dt);
    if (!velocity) return under("velocity", velocity.error());
    return MomentumObserver(params, *velocity, dt);
  }

  /// Once a tick. Real-time safe.
  Output step(const Input& sample) noexcept {
    const double velocity = velocity_.step(sample.position);
    momentum_ += rate_ * dt_s_;
    const double force = gain_per_s_ * (model_.mass_kg * velocity - momentum_);
    rate_ = model_.actuator_gain * sample.command - model_.viscous_damping_N_s_per_m * velocity -
            model_.friction(velocity) + force;
    return {.force = force};
  }
  void reset() noexcept {
    velocity_.reset();
    momentum_ = 0.0;
    rate_ = 0.0;
  }

 private:
  MomentumObserver(const Params& params, const signal::FilteredDerivative& velocity, Seconds dt)
      : model_(params.model),
        velocity_(velocity),
        gain_per_s_(2.0 * std::numbers::pi * params.cutoff_Hz),
        dt_s_(dt.value) {}

  SlaveModel model_;
  signal::FilteredDerivative velocity_;
  double gain_per_s_;
  double dt_s_;
  double momentum_ = 0.0;  ///< that model and estimate have put in, N s
  double rate_ = 0.0;      ///< at the last sample, N
};

}  // namespace tactus::control
