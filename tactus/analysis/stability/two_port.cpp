// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/two_port.hpp>

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

namespace tactus::stability {

Result<TwoPort> TwoPort::make(const simulation::Teleoperator::Params& params, const Linearisation& linearisation) {
  if (auto error = validate(linearisation)) return *std::move(error);
  auto sites = linear_sites(params, linearisation);
  if (!sites) return sites.error();
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  TwoPort port;
  port.tick_s_ = clock->tick_s;
  port.late_s_ = clock->late_substeps * clock->substep_s;
  port.force_gain_ = params.control.force_gain;
  port.to_slave_ticks_ = ticks_of(params.channel.to_slave, clock->tick_s);
  port.to_master_ticks_ = ticks_of(params.channel.to_master, clock->tick_s) + 1;
  port.sites_ = *std::move(sites);
  port.master_ = linear_master(params.master, mechanics::nobody_holds, linearisation);
  port.slave_ = linear_device(params.slave.mechanism, params.slave.amplifier, params.slave.force_sensor.bandwidth_Hz,
                              mechanics::nobody_holds, linearisation);
  port.sampled_master_ = sampled(driven(port.master_), port.tick_s_, port.late_s_);
  port.sampled_slave_ = sampled(one_channel(port.slave_, command_in, motor_out), port.tick_s_, port.late_s_);
  return port;
}

HybridMatrix TwoPort::at(double frequency_rad_per_s) const {
  using Complex = std::complex<double>;
  const Complex s{0.0, frequency_rad_per_s};
  const double angle = frequency_rad_per_s * tick_s_;
  const Complex z = std::polar(1.0, angle);
  const auto delay = [angle](Eigen::Index ticks) { return std::polar(1.0, -angle * static_cast<double>(ticks)); };
  // A held command as the plant sees its fundamental.
  const Complex hold = (1.0 - 1.0 / z) / (s * tick_s_) * std::exp(-s * late_s_);
  const Eigen::MatrixXcd master = response(master_, s), slave = response(slave_, s);
  const Eigen::MatrixXcd site = response(sites_.master, z);
  const Complex servo = response(sites_.slave, z)(0, 0);
  const Eigen::MatrixXcd motor_answer = response(sampled_master_, z);
  const Complex master_loop = 1.0 - site(motor_force_out, measured_in) * motor_answer(0, 0);
  const Complex slave_loop = 1.0 + servo * response(sampled_slave_, z)(0, 0);

  struct Answer {
    Complex handle_velocity, tip_velocity;
  };
  // Both devices under a force of the hand and one of the environment, everything at the same frequency.
  const auto answer = [&](double hand_N, double environment_N) {
    const Complex arrived_N = -force_gain_ * delay(to_master_ticks_) * slave(sensor_out, tip_force_in) * environment_N;
    // The crossover splits what arrives and nothing else.
    const Complex handle_N = site(handle_force_out, arrived_force_in) * arrived_N;
    const Complex moved_m = motor_answer(0, 1) * handle_N + master(motor_out, tip_force_in) * hand_N;
    const Complex motor_N =
        (site(motor_force_out, measured_in) * moved_m + site(motor_force_out, arrived_force_in) * arrived_N) /
        master_loop;
    const Complex measured_m = motor_answer(0, 0) * motor_N + moved_m;
    const Complex command_m =
        site(message_out, measured_in) * measured_m + site(message_out, arrived_force_in) * arrived_N;
    const Complex servo_N =
        servo * (delay(to_slave_ticks_) * command_m + slave(motor_out, tip_force_in) * environment_N) / slave_loop;
    return Answer{.handle_velocity = master(tip_velocity_out, command_in) * hold * motor_N +
                                     master(tip_velocity_out, tip_command_in) * hold * handle_N +
                                     master(tip_velocity_out, tip_force_in) * hand_N,
                  .tip_velocity = slave(tip_velocity_out, command_in) * hold * servo_N -
                                  slave(tip_velocity_out, tip_force_in) * environment_N};
  };
  const Answer hand = answer(1.0, 0.0), environment = answer(0.0, 1.0);
  const Complex h11 = 1.0 / hand.handle_velocity;
  return {.h11 = h11,
          .h12 = -environment.handle_velocity * h11,
          .h21 = -hand.tip_velocity * h11,
          .h22 = hand.tip_velocity * h11 * environment.handle_velocity - environment.tip_velocity};
}

double llewellyn_index(const HybridMatrix& h) {
  if (h.h11.real() < 0.0 || h.h22.real() < 0.0) return -1.0;
  const std::complex<double> through = h.h12 * h.h21;
  return (2.0 * h.h11.real() * h.h22.real() - through.real()) / std::abs(through);
}

double scattering_norm(const HybridMatrix& h, double reference_N_s_per_m) {
  Eigen::Matrix2cd scaled;
  scaled << h.h11 / reference_N_s_per_m, h.h12, h.h21, h.h22 * reference_N_s_per_m;
  const Eigen::Matrix2cd unit = Eigen::Matrix2cd::Identity();
  // The sign of the second wave does not change a singular value.
  const Eigen::Matrix2cd scattering = (scaled - unit) * (scaled + unit).inverse();
  return scattering.jacobiSvd().singularValues()[0];
}

double passivity_index(const HybridMatrix& h, double reference_N_s_per_m) {
  const double own = h.h11.real() / reference_N_s_per_m, other = h.h22.real() * reference_N_s_per_m;
  return 0.5 * (own + other) - std::hypot(0.5 * (own - other), 0.5 * std::abs(h.h12 + std::conj(h.h21)));
}

std::complex<double> transmitted_impedance(const HybridMatrix& h, std::complex<double> environment_N_s_per_m) {
  return h.h11 - h.h12 * h.h21 * environment_N_s_per_m / (1.0 + h.h22 * environment_N_s_per_m);
}

}  // namespace tactus::stability
