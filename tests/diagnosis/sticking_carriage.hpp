// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/mechanics/encoder.hpp>
#include <tactus/kernel/mechanics/friction.hpp>
#include <tactus/kernel/station/device.hpp>
#include <tactus/simulation/teleoperator/clock.hpp>

#include <cmath>

namespace tactus::known {

/// A slave that sticks: one mass in free motion whose friction at rest is higher than in motion,
///
///     f(v) = Coulomb + (static − Coulomb)·exp(−(v/v_s)²).
///
/// The devices of the library have one level of friction, with which nothing sticks and slips by itself. Source of the
/// curve: Armstrong-Hélouvry, Dupont and Canudas de Wit, A survey of models, analysis tools and compensation methods
/// for the control of machines with friction, Automatica 30(7), 1994.
class StickingCarriage {
 public:
  struct Params {
    double mass_kg = 0.1;
    double static_N = 0.5;
    double coulomb_N = 0.3;
    double stribeck_m_per_s = 0.005;
    double viscous_N_s_per_m = 0.5;
    double resolution_m = 1e-5;
  };

  StickingCarriage(const Params& params, const simulation::Clock& clock, double start_m)
      : params_(params), clock_(clock), position_m_(start_m) {}

  station::DeviceReading read(const station::Tick&) noexcept {
    return {.position_m = mechanics::quantised(position_m_, params_.resolution_m)};
  }
  void write(const station::DeviceCommand& command) noexcept { next_N_ = command.force_N; }
  void begin_tick() noexcept {}
  void substep(int index) noexcept {
    if (index == clock_.late_substeps) command_N_ = next_N_;
    const double dt_s = clock_.substep_s;
    const double slow = velocity_m_per_s_ / params_.stribeck_m_per_s;
    const double friction_N = params_.coulomb_N + (params_.static_N - params_.coulomb_N) * std::exp(-slow * slow);
    const double free =
        velocity_m_per_s_ + dt_s * (command_N_ - params_.viscous_N_s_per_m * velocity_m_per_s_) / params_.mass_kg;
    velocity_m_per_s_ = mechanics::soft_threshold(free, dt_s * friction_N / params_.mass_kg);
    position_m_ += dt_s * velocity_m_per_s_;
  }

 private:
  Params params_;
  simulation::Clock clock_;
  double position_m_;
  double velocity_m_per_s_ = 0.0;
  double command_N_ = 0.0;
  double next_N_ = 0.0;
};

}  // namespace tactus::known
