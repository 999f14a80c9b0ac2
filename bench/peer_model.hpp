// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <boost/numeric/odeint/stepper/euler.hpp>

namespace tactus::bench {

/// The six-state model of induced motion (paper A, Fig. 10 and Table I) as one would write it for Boost.odeint, apart
/// from the code of tactus: the rival that `InducedMotionModel` is measured against.
class PeerModel {
 public:
  enum class Friction {
    projected,  ///< the force, within ±f, that brings the mass to rest in this step: the same law as in tactus
    hyperbolic  ///< f·tanh(v / 1 mm/s), the textbook's smooth law
  };
  /// Positions, then velocities, of motor, drum and handle.
  using State = std::array<double, 6>;

  PeerModel(Friction friction, double step_s) : friction_(friction), step_s_(step_s) {}

  /// Advances by `steps` forward Euler steps under a constant force on the motor.
  void advance(double force_N, int steps) {
    for (int i = 0; i < steps; ++i) {
      stepper_.do_step([this, force_N](const State& x, State& rate, double) { derive(x, force_N, rate); }, state_, 0.0,
                       step_s_);
    }
  }

  [[nodiscard]] double motor_position_m() const { return state_[0]; }

 private:
  void derive(const State& x, double force_N, State& rate) const {
    const double cable = 39500.0 * (x[0] - x[1]) + 3.6 * (x[3] - x[4]);
    const double linkage = 3950.0 * (x[1] - x[2]) + 0.02 * (x[4] - x[5]);
    const double squared = x[2] * x[2];
    const double hand = 40.0 * x[2] + 3.125e13 * squared * squared * x[2] + 23.0 * x[5];
    constexpr double motor_kg = 0.0075, drum_kg = 0.01075, handle_kg = 0.014;
    rate[0] = x[3];
    rate[1] = x[4];
    rate[2] = x[5];
    rate[3] = (1.0 / motor_kg) * rub(force_N - cable, x[3], motor_kg / step_s_, 0.01);
    rate[4] = (1.0 / drum_kg) * rub(cable - linkage, x[4], drum_kg / step_s_, 0.0144);
    rate[5] = (1.0 / handle_kg) * (linkage - hand);
  }

  /// `force` less friction of at most `most`.
  [[nodiscard]] double rub(double force, double velocity, double mass_per_step, double most) const {
    if (friction_ == Friction::hyperbolic) return force - most * std::tanh(velocity * 1000.0);
    return force - std::clamp(force + mass_per_step * velocity, -most, most);
  }

  Friction friction_;
  double step_s_;
  State state_{};
  boost::numeric::odeint::euler<State> stepper_;
};

}  // namespace tactus::bench
