// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/mechanics/cable_chain.hpp>

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include <boost/numeric/odeint.hpp>

/// A frictionless chain without hysteresis, written down a second time for oracles that share nothing with the library:
/// its equations of motion for Boost.odeint, and its modes and response in closed form.
struct ReferenceChain {
  double motor_kg = 0.0075, drum_kg = 0.01075, tip_kg = 0.014;
  double cable_N_per_m = 39500.0, cable_N_s_per_m = 3.6;
  double linkage_N_per_m = 3950.0, linkage_N_s_per_m = 0.02;
  double grip_N_per_m = 0.0, grip_N_s_per_m = 0.0;

  /// Positions of motor, drum and tip, then their velocities.
  using State = std::array<double, 6>;
  struct Forces {
    double motor_N = 0.0, tip_N = 0.0;
  };

  [[nodiscard]] tactus::mechanics::CableChain::Params params() const {
    return {.motor = {.mass_kg = motor_kg, .friction_N = 0.0},
            .cable = {.stiffness_N_per_m = cable_N_per_m, .damping_N_s_per_m = cable_N_s_per_m},
            .drum = {.mass_kg = drum_kg, .friction_N = 0.0},
            .linkage = {.stiffness_N_per_m = linkage_N_per_m,
                        .damping_N_s_per_m = linkage_N_s_per_m,
                        .hysteretic_fraction = 0.0},
            .tip = {.mass_kg = tip_kg}};
  }
  [[nodiscard]] tactus::mechanics::LinearSpring::Params grip() const {
    return {.stiffness_N_per_m = grip_N_per_m, .damping_N_s_per_m = grip_N_s_per_m};
  }
  [[nodiscard]] double total_kg() const { return motor_kg + drum_kg + tip_kg; }

  /// ẋ under `forces`, the grip pulling toward the place and speed that `forces` already contains.
  void derivative(const State& x, State& change, const Forces& forces) const {
    const double cable = cable_N_per_m * (x[0] - x[1]) + cable_N_s_per_m * (x[3] - x[4]);
    const double linkage = linkage_N_per_m * (x[1] - x[2]) + linkage_N_s_per_m * (x[4] - x[5]);
    const double grip = grip_N_per_m * x[2] + grip_N_s_per_m * x[5];
    change = {x[3],
              x[4],
              x[5],
              (forces.motor_N - cable) / motor_kg,
              (cable - linkage) / drum_kg,
              (linkage - grip + forces.tip_N) / tip_kg};
  }

  /// The state at `end_s`, from `start` at time 0, under `forces(time, state)`: an adaptive 7(8) method at the limit of
  /// double precision. For forces that are smooth.
  template <class Forcing>
  [[nodiscard]] State integrate(State start, double end_s, Forcing forces) const {
    namespace odeint = boost::numeric::odeint;
    const auto system = [&](const State& x, State& change, double time_s) { derivative(x, change, forces(time_s, x)); };
    odeint::integrate_adaptive(odeint::make_controlled<odeint::runge_kutta_fehlberg78<State>>(1e-15, 1e-13), system,
                               start, 0.0, end_s, 1e-6);
    return start;
  }

  /// Angular frequencies in rad/s of the two undamped modes of the chain with both ends free, the slower first.
  [[nodiscard]] std::array<double, 2> free_modes() const {
    const double sum =
        cable_N_per_m * (1.0 / motor_kg + 1.0 / drum_kg) + linkage_N_per_m * (1.0 / drum_kg + 1.0 / tip_kg);
    return roots(sum, cable_N_per_m * linkage_N_per_m * total_kg() / (motor_kg * drum_kg * tip_kg));
  }
  /// The same with the tip held still.
  [[nodiscard]] std::array<double, 2> held_modes() const {
    const double sum = cable_N_per_m / motor_kg + (cable_N_per_m + linkage_N_per_m) / drum_kg;
    return roots(sum, cable_N_per_m * linkage_N_per_m / (motor_kg * drum_kg));
  }
  /// Shape of a free mode: how far each mass swings.
  [[nodiscard]] std::array<double, 3> free_shape(double mode_rad_per_s) const {
    const double square = mode_rad_per_s * mode_rad_per_s;
    const double drum = 1.0 - square * motor_kg / cable_N_per_m;
    return {1.0, drum, drum * linkage_N_per_m / (linkage_N_per_m - square * tip_kg)};
  }

  /// Motor position over motor force at the complex frequency `s`, in m/N: each mass carries what lies beyond it.
  [[nodiscard]] std::complex<double> compliance(std::complex<double> s) const {
    const auto series = [](std::complex<double> a, std::complex<double> b) { return a * b / (a + b); };
    const std::complex<double> tip = tip_kg * s * s + grip_N_s_per_m * s + grip_N_per_m;
    const std::complex<double> drum = drum_kg * s * s + series(linkage_N_s_per_m * s + linkage_N_per_m, tip);
    return 1.0 / (motor_kg * s * s + series(cable_N_s_per_m * s + cable_N_per_m, drum));
  }
  [[nodiscard]] double gain(double frequency_Hz) const {
    return std::abs(compliance({0.0, 2.0 * std::numbers::pi * frequency_Hz}));
  }

 private:
  /// Square roots of the solutions of u² − sum·u + product = 0.
  static std::array<double, 2> roots(double sum, double product) {
    const double larger = 0.5 * (sum + std::sqrt(sum * sum - 4.0 * product));
    return {std::sqrt(product / larger), std::sqrt(larger)};
  }
};
