// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/angle.hpp>
#include <tactus/analysis/stability/linear_plant.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::stability {

TipLoad wall_load(const mechanics::Environment::Params& params, double preload_N) {
  // A valid wall is one at any sample time.
  auto wall = mechanics::Environment::make(params, Seconds{1e-5});
  if (!wall) return mechanics::nobody_holds;
  const auto force_N = [&wall, &params](double depth_m, double rate_m_per_s) {
    return wall->step({.position_m = params.position_m + depth_m, .velocity_m_per_s = rate_m_per_s});
  };
  double shallow_m = 0.0, deep_m = 1e-3;
  while (force_N(deep_m, 0.0) < preload_N && deep_m < 1.0) deep_m *= 2.0;
  if (force_N(deep_m, 0.0) < preload_N) return mechanics::nobody_holds;
  for (int i = 0; i < 60; ++i) {
    const double middle_m = 0.5 * (shallow_m + deep_m);
    (force_N(middle_m, 0.0) < preload_N ? shallow_m : deep_m) = middle_m;
  }
  const double small_m = 1e-3 * deep_m;
  // Small enough that the wall does not let go, however viscous.
  double small_m_per_s = 1e-3;
  while (force_N(deep_m, -small_m_per_s) <= 0.5 * preload_N) small_m_per_s *= 0.5;
  return {
      .stiffness_N_per_m = (force_N(deep_m + small_m, 0.0) - force_N(deep_m - small_m, 0.0)) / (2.0 * small_m),
      .damping_N_s_per_m = (force_N(deep_m, small_m_per_s) - force_N(deep_m, -small_m_per_s)) / (2.0 * small_m_per_s)};
}

namespace {

constexpr Eigen::Index tip_velocity_state = 5;

double linkage_stiffness_N_per_m(const mechanics::ElastoSlipSpring::Params& params, double amplitude_m) {
  if (amplitude_m == 0.0) return params.stiffness_N_per_m;
  const auto spring = mechanics::ElastoSlipSpring::make(params, Seconds{1e-5});
  if (!spring) return params.stiffness_N_per_m;
  double stiffness = spring->sustained_stiffness_N_per_m();
  const auto& elements = spring->elements();
  for (std::size_t i = 0; i < elements.count; ++i) {
    stiffness += elements.stiffness_N_per_m[i] * std::min(1.0, elements.slip_m[i] / amplitude_m);
  }
  return stiffness;
}

}  // namespace

StateSpace linear_device(const mechanics::CableChain::Params& mechanism,
                         const mechanics::CurrentAmplifier::Params& amplifier, double sensor_bandwidth_Hz,
                         const TipLoad& load, const Linearisation& linearisation) {
  const double linkage = linkage_stiffness_N_per_m(mechanism.linkage, linearisation.linkage_amplitude_m);
  const auto coupling = [](double cable_, double linkage_, double tip) {
    Eigen::Matrix3d matrix;
    matrix << cable_, -cable_, 0.0, -cable_, cable_ + linkage_, -linkage_, 0.0, -linkage_, linkage_ + tip;
    return matrix;
  };
  const Eigen::Matrix3d stiffness = coupling(mechanism.cable.stiffness_N_per_m, linkage, load.stiffness_N_per_m);
  Eigen::Matrix3d damping =
      coupling(mechanism.cable.damping_N_s_per_m, mechanism.linkage.damping_N_s_per_m, load.damping_N_s_per_m);
  damping(0, 0) += linearisation.rubbing_N_s_per_m(mechanism.motor.friction_N);
  damping(1, 1) += linearisation.rubbing_N_s_per_m(mechanism.drum.friction_N);
  const Eigen::Vector3d per_mass{1.0 / mechanism.motor.mass_kg, 1.0 / mechanism.drum.mass_kg,
                                 1.0 / mechanism.tip.mass_kg};

  // Positions of motor, drum and tip, their velocities, the applied force, the sensor's output and its rate over its
  // corner.
  constexpr Eigen::Index x = 0, v = 3, applied = 6, reading = 7, reading_rate = 8, states = 9;
  static_assert(v + 2 == tip_velocity_state);
  StateSpace device{.a = Eigen::MatrixXd::Zero(states, states),
                    .b = Eigen::MatrixXd::Zero(states, device_inputs),
                    .c = Eigen::MatrixXd::Zero(device_outputs, states),
                    .d = Eigen::MatrixXd::Zero(device_outputs, device_inputs)};
  device.a.block<3, 3>(x, v).setIdentity();
  device.a.block<3, 3>(v, x) = -(per_mass.asDiagonal() * stiffness);
  device.a.block<3, 3>(v, v) = -(per_mass.asDiagonal() * damping);
  device.a(v, applied) = per_mass[0];
  device.b(v + 2, tip_force_in) = per_mass[2];

  const double lag = turn * amplifier.bandwidth_Hz;
  device.a(applied, applied) = -lag;
  device.b(applied, command_in) = lag * amplifier.gain;

  const double corner = turn * sensor_bandwidth_Hz;
  device.a(reading, reading_rate) = corner;
  device.a(reading_rate, reading) = -corner;
  device.a(reading_rate, reading_rate) = -std::numbers::sqrt2 * corner;
  device.a(reading_rate, x + 2) = corner * load.stiffness_N_per_m;
  device.a(reading_rate, v + 2) = corner * load.damping_N_s_per_m;
  device.b(reading_rate, tip_force_in) = -corner;

  device.c(motor_out, x) = 1.0;
  device.c(tip_out, x + 2) = 1.0;
  device.c(tip_velocity_out, v + 2) = 1.0;
  device.c(sensor_out, reading) = 1.0;
  return device;
}

StateSpace linear_master(const mechanics::CableDrivenMaster::Params& master, const TipLoad& load,
                         const Linearisation& linearisation) {
  const StateSpace device =
      linear_device(master.mechanism, master.amplifier, master.force_sensor.bandwidth_Hz, load, linearisation);
  const Eigen::Index n = device.states();
  StateSpace whole{.a = Eigen::MatrixXd::Zero(n + 1, n + 1),
                   .b = Eigen::MatrixXd::Zero(n + 1, device_inputs + 1),
                   .c = Eigen::MatrixXd::Zero(device_outputs, n + 1),
                   .d = Eigen::MatrixXd::Zero(device_outputs, device_inputs + 1)};
  whole.a.topLeftCorner(n, n) = device.a;
  whole.b.topLeftCorner(n, device_inputs) = device.b;
  whole.c.leftCols(n) = device.c;
  const double lag = turn * master.handle_actuator.bandwidth_Hz;
  whole.a(tip_velocity_state, n) = 1.0 / master.mechanism.tip.mass_kg;
  whole.a(n, n) = -lag;
  whole.b(n, tip_command_in) = lag * master.handle_actuator.gain;
  return whole;
}

StateSpace driven(const StateSpace& master) {
  StateSpace system{.a = master.a,
                    .b = Eigen::MatrixXd(master.states(), 2),
                    .c = master.c.row(motor_out),
                    .d = Eigen::MatrixXd::Zero(1, 2)};
  system.b << master.b.col(command_in), master.b.col(tip_command_in);
  return system;
}

}  // namespace tactus::stability
