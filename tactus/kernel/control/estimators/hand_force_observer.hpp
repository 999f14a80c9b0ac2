// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <algorithm>

namespace tactus::control {

/// The force of the hand on the master, from motor position and applied force alone: a disturbance observer of the
/// master as one rigid mass,
///
///     f̂_h = B(s)·(m ẍ + f_c sign(ẋ) − F),
///
/// with B a Butterworth low-pass of second order at `cutoff_Hz`. All three terms pass the one filter, so a known motor
/// force that moves the mass is not taken for a hand, at no frequency: with the second difference of the position
/// is the mean of the forces of its two ticks, which is exact for a rigid mass and held forces. A velocity and a
/// filter of its own for each term, the usual form, would leave the difference of their lags as false force.
///
/// Good below the first mode of the device (75 Hz for the default master), so keep the cutoff below that. A position
/// step of Δ gives at most about m (2π·cutoff)² Δ of noise: 0.011 N for 32 g, 30 Hz and 10 µm. Friction is taken as
/// f_c·clamp(v / 5 mm/s, ±1); the estimate of a resting hand is uncertain by f_c, which no observer can determine.
/// Positive when the hand pushes toward the environment. Starts at rest.
/// Source: the disturbance observer of Ohnishi, with the filter's second order taken from the second derivative.
class HandForceObserver {
 public:
  struct Params {
    double mass_kg = 0.03;
    double friction_N = 0.0;
    double cutoff_Hz = 30.0;
    static constexpr auto fields() {
      return List{
          field("mass_kg", &Params::mass_kg, units::kilogram, positive_up_to(1000.0), "All that moves with the hand."),
          field("friction_N", &Params::friction_N, units::newton, between(0.0, 1000.0), "Its Coulomb friction."),
          field("cutoff_Hz", &Params::cutoff_Hz, units::hertz, positive,
                "Where the estimate has fallen by 3 dB; below 0.44 of the sample rate.")};
    }
  };
  struct Input {
    double motor_position_m = 0.0;
    double motor_force_N = 0.0;  ///< that acts from now to the next tick, positive toward the environment
  };
  /// Force of the hand in N, of the ticks before now.
  using Output = double;

  static Result<HandForceObserver> make(const Params& params, Seconds dt) {
    if (auto error = signal::check(params, dt)) return *std::move(error);
    const auto velocity = signal::FilteredDerivative::make({.cutoff_Hz = params.cutoff_Hz}, dt);
    if (!velocity) return velocity.error();
    const auto filter = signal::SecondOrderFilter::make({.frequency_Hz = params.cutoff_Hz}, dt);
    if (!filter) return filter.error();
    return HandForceObserver(params.mass_kg / (dt.value * dt.value), params.friction_N, *velocity, *filter);
  }

  /// The estimate at this sample. Once a tick. Real-time safe.
  double estimate(double motor_position_m) noexcept {
    if (!started_) position_before_m_ = position_at_last_m_ = motor_position_m;
    started_ = true;
    const double inertial_N =
        mass_per_tick2_ * ((motor_position_m - position_at_last_m_) - (position_at_last_m_ - position_before_m_));
    position_before_m_ = position_at_last_m_;
    position_at_last_m_ = motor_position_m;
    constexpr double rest_m_per_s = 0.005;
    const double moving = std::clamp(velocity_.step(motor_position_m) / rest_m_per_s, -1.0, 1.0);
    return filter_.step(inertial_N + friction_N_ * moving - 0.5 * (force_before_N_ + force_at_last_N_));
  }
  /// The force in N that really acts from now to the next tick. Real-time safe.
  void applied(double motor_force_N) noexcept {
    force_before_N_ = force_at_last_N_;
    force_at_last_N_ = motor_force_N;
  }
  /// Both at once.
  Output step(const Input& input) noexcept {
    const double hand_N = estimate(input.motor_position_m);
    applied(input.motor_force_N);
    return hand_N;
  }

  void reset() noexcept {
    velocity_.reset();
    filter_.reset();
    position_at_last_m_ = position_before_m_ = 0.0;
    force_at_last_N_ = force_before_N_ = 0.0;
    started_ = false;
  }

 private:
  HandForceObserver(double mass_per_tick2, double friction_N, const signal::FilteredDerivative& velocity,
                    const signal::SecondOrderFilter& filter)
      : mass_per_tick2_(mass_per_tick2), friction_N_(friction_N), velocity_(velocity), filter_(filter) {}

  double mass_per_tick2_;  ///< kg/s²
  double friction_N_;
  signal::FilteredDerivative velocity_;
  signal::SecondOrderFilter filter_;
  double position_at_last_m_ = 0.0, position_before_m_ = 0.0;
  double force_at_last_N_ = 0.0, force_before_N_ = 0.0;
  bool started_ = false;
};

}  // namespace tactus::control
