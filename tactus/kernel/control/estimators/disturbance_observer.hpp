// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/force_estimator.hpp>
#include <tactus/kernel/control/estimators/slave_model.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>
#include <tactus/kernel/signal/rational_filter.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

namespace tactus::control {

/// Disturbance observer: what the nominal model cannot explain is the environment.
///
///     F̂_e = Q(s)·[ (M s² + h s)·x + friction(v) − K_a·u ],   Q(s) = 1 / (s²/ω² + √2 s/ω + 1),   ω = 2π cutoff
///
/// Q has the least order that makes Q·s² proper. With an exact model F̂_e = Q·F_e. All is sampled by the bilinear
/// transform, prewarped at the cutoff. It is the inverse model of paper B without prediction, with both its low-passes
/// in Q; a delay of actuator or sensor appears as false force in free motion. Starts at rest at zero position.
/// Cutoff below 0.44 of the sample rate.
/// Source: K. Ohnishi, M. Shibata, T. Murakami, Motion control for advanced mechatronics, IEEE/ASME Trans. Mechatronics
/// 1(1), 1996.
class DisturbanceObserver {
 public:
  struct Params {
    SlaveModel model{};
    double cutoff_Hz = 100.0;
    static constexpr auto fields() {
      return List{field("model", &Params::model, "The nominal slave."),
                  field("cutoff_Hz", &Params::cutoff_Hz, units::hertz, positive, "-3 dB frequency of the estimate.")};
    }
  };
  using Input = SlaveMotionSample;
  using Output = ForceEstimate;

  static Result<DisturbanceObserver> make(const Params& params, Seconds dt);

  /// Once a tick. Real-time safe.
  Output step(const Input& sample) noexcept {
    const double friction_N = friction_(velocity_.step(sample.position));
    return {.force = inertia_.step(sample.position) + low_pass_.step(friction_N - actuator_gain_ * sample.command)};
  }
  void reset() noexcept {
    velocity_.reset();
    inertia_.reset();
    low_pass_.reset();
  }

 private:
  DisturbanceObserver(const SlaveModel& model, const signal::FilteredDerivative& velocity,
                      const signal::RationalFilter& inertia, const signal::SecondOrderFilter& low_pass)
      : friction_(model.friction),
        actuator_gain_(model.actuator_gain),
        velocity_(velocity),
        inertia_(inertia),
        low_pass_(low_pass) {}

  FrictionFunction friction_;
  double actuator_gain_;
  signal::FilteredDerivative velocity_;
  signal::RationalFilter inertia_;
  signal::SecondOrderFilter low_pass_;
};

}  // namespace tactus::control
