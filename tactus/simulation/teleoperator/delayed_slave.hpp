// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <complex>
#include <functional>
#include <vector>

/// A slave with delays in free motion (paper B, Figs. 4 and 5): the plant alongside which force estimators are judged.
namespace tactus::simulation {

/// P controller, actuator, body and sensor of paper B. Actuator and sensor: gain·exp(−s·delay)/(lag·s + 1).
struct DelayedSlaveParams {
  double controller_gain_N_per_m = 100.0;
  double actuator_gain = 1.0;
  double actuator_delay_s = 0.002;
  double actuator_lag_s = 0.002;
  double mass_kg = 10.0;
  double viscous_damping_N_s_per_m = 1.0;
  double sensor_gain = 1.0;
  double sensor_delay_s = 0.002;
  double sensor_lag_s = 0.002;
  static constexpr auto fields() {
    using P = DelayedSlaveParams;
    return List{
        field("controller_gain_N_per_m", &P::controller_gain_N_per_m, units::newton_per_metre, positive,
              "K_c: command to the actuator per metre of measured position error."),
        field("actuator_gain", &P::actuator_gain, units::none, positive_up_to(1e6),
              "K_a: force in N per unit of the command."),
        field("actuator_delay_s", &P::actuator_delay_s, units::second, between(0.0, 1.0), "T1a: transport delay."),
        field("actuator_lag_s", &P::actuator_lag_s, units::second, between(1e-4, 1.0), "T2a: first-order lag."),
        field("mass_kg", &P::mass_kg, units::kilogram, positive, "M_s: moving mass."),
        field("viscous_damping_N_s_per_m", &P::viscous_damping_N_s_per_m, units::newton_second_per_metre, non_negative,
              "h_e: viscous damping."),
        field("sensor_gain", &P::sensor_gain, units::none, positive_up_to(1e6),
              "K_s: measured position per metre of true position."),
        field("sensor_delay_s", &P::sensor_delay_s, units::second, between(0.0, 1.0), "T1s: transport delay."),
        field("sensor_lag_s", &P::sensor_lag_s, units::second, between(1e-4, 1.0), "T2s: first-order lag.")};
  }
  [[nodiscard]] double delay_s() const { return actuator_delay_s + sensor_delay_s; }
  /// All that lies between command and measured position alongside the body: what prediction must make up for.
  [[nodiscard]] double delays_and_lags_s() const { return delay_s() + actuator_lag_s + sensor_lag_s; }
};

/// Measured position over command at `s` in 1/s.
std::complex<double> transfer(const DelayedSlaveParams& params, std::complex<double> s);

/// Phase margin in degrees of the closed position loop at its highest gain crossover; 180 without a crossover.
double phase_margin_deg(const DelayedSlaveParams& params);

/// A path of the master and its rate.
struct PathPoint {
  double position_m = 0.0;
  double velocity_m_per_s = 0.0;
};
using Path = std::function<PathPoint(double time_s)>;

/// What an estimator sees, one sample each `sample_time_s`.
struct SlaveRecord {
  std::vector<double> time_s;
  std::vector<double> command;
  std::vector<double> position;
};

/// The closed loop in continuous time from rest, without environment force.
///
/// In a linear loop at rest the two delays may be lumped in front of the actuator: command and measured position are
/// the same functions of time. What is left are four states under a command of the past: the method of steps. They are
/// advanced by the classical Runge-Kutta scheme in equal substeps of at most 0.1 ms and at most the delay, the past
/// command by cubic Hermite interpolation from its values and exact rates; error of order 4. None of it is shared with
/// the estimators. Errors: `out_of_bounds` for a parameter or more than 10 million samples.
Result<SlaveRecord> follow(const DelayedSlaveParams& params, const Path& path, double duration_s, double sample_time_s);

}  // namespace tactus::simulation
