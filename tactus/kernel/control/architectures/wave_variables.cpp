// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/wave_variables.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::control {

Result<WaveReceiver> WaveReceiver::make(const WaveParams& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  if (auto error = signal::check_below_nyquist("cutoff_Hz", params.cutoff_Hz, dt)) return *std::move(error);
  // |α / (1 − (1 − α) e^{−jω})|² = 1/2 at the cutoff is p² − (4 − 2 cos ω) p + 1 = 0 in the pole p = 1 − α.
  const double half = 2.0 - std::cos(2.0 * std::numbers::pi * params.cutoff_Hz * dt.value);
  const double pole = half - std::sqrt(half * half - 1.0);
  return WaveReceiver(params, 1.0 - pole, dt);
}

WaveReceiver::WaveReceiver(const WaveParams& params, double smoothing, Seconds dt)
    : dt_s_(dt.value),
      smoothing_(smoothing),
      metres_per_wave_(std::sqrt(2.0 / params.impedance_N_s_per_m) * dt.value),
      correction_per_tick_(std::min(1.0, dt.value / params.correction_time_s)) {}

double WaveReceiver::step(const Arrival& arrival, double start_m) noexcept {
  State& s = state_;
  if (!s.started) {
    s.started = true;
    s.sent_m = s.taken_m = start_m;
  }
  if (arrival.fresh) {
    s.purse_J += arrival.message.energy_J - s.sent_J;
    s.sent_J = arrival.message.energy_J;
    s.sent_m = arrival.message.position_m;
  }
  s.filtered += smoothing_ * ((arrival.fresh ? arrival.message.wave : 0.0) - s.filtered);
  // What is still inside the low-pass comes out by itself: its output from now on sums up to y / α.
  const double inside_m = metres_per_wave_ * s.filtered / smoothing_;
  const double missing_m = s.sent_m - s.taken_m - inside_m;
  double wave = s.filtered + correction_per_tick_ * missing_m / metres_per_wave_;
  const double most = std::sqrt(2.0 * std::max(s.purse_J, 0.0) / dt_s_);
  // An energy that is not a number has to reach the motor's gate, which catches it.
  wave = std::isnan(most) ? most : std::clamp(wave, -most, most);
  s.taken_m += metres_per_wave_ * wave;
  s.purse_J -= 0.5 * dt_s_ * wave * wave;
  return wave;
}

Result<WaveMaster> WaveMaster::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto receiver = WaveReceiver::make(params.wave, dt);
  if (!receiver) return under("wave", receiver.error());
  const auto velocity = signal::FilteredDerivative::make(params.wave.velocity, dt);
  if (!velocity) return under("wave.velocity", velocity.error());
  return WaveMaster(params, *receiver, *velocity, dt);
}

WaveMaster::WaveMaster(const Params& params, const WaveReceiver& receiver, const signal::FilteredDerivative& velocity,
                       Seconds dt)
    : position_scale_(params.position_scale),
      force_gain_(params.force_gain),
      force_limit_N_(params.force_limit_N),
      impedance_N_s_per_m_(params.wave.impedance_N_s_per_m),
      dt_s_(dt.value),
      receiver_(receiver),
      velocity_(velocity) {}

WaveMaster::Output WaveMaster::respond(const Input& input) noexcept {
  const double b = impedance_N_s_per_m_;
  const double position_m = position_scale_ * input.motor_position_m;
  const double velocity_m_per_s = position_scale_ * velocity_.step(input.motor_position_m);
  if (!started_) {
    started_ = true;
    sent_m_ = position_m;
  }
  const double in = receiver_.step(input.arrival, position_m);
  const double wanted_N = b * velocity_m_per_s - std::sqrt(2.0 * b) * in;
  const double displayed_N = std::clamp(force_gain_ * wanted_N, -force_limit_N_, force_limit_N_);
  const double out = std::sqrt(2.0 * b) * velocity_m_per_s - in;
  sent_m_ += std::sqrt(2.0 / b) * dt_s_ * out;
  // The square of `out` while the force does not saturate, and never negative: a saturated force lies between none and
  // the wanted one.
  sent_J_ += 0.5 * dt_s_ * std::max(in * in + 2.0 * displayed_N / force_gain_ * velocity_m_per_s, 0.0);
  return {.motor_force_N = -displayed_N,
          .message = {.position_m = sent_m_, .wave = out, .energy_J = sent_J_},
          .intended_position_m = input.motor_position_m};
}

void WaveMaster::reset() noexcept {
  receiver_.reset();
  velocity_.reset();
  started_ = false;
  sent_m_ = 0.0;
  sent_J_ = 0.0;
}

Result<WaveSlave> WaveSlave::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto receiver = WaveReceiver::make(params.wave, dt);
  if (!receiver) return under("wave", receiver.error());
  const auto velocity = signal::FilteredDerivative::make(params.slave.velocity, dt);
  if (!velocity) return under("slave.velocity", velocity.error());
  return WaveSlave(params, *receiver, *velocity, dt);
}

WaveSlave::WaveSlave(const Params& params, const WaveReceiver& receiver, const signal::FilteredDerivative& velocity,
                     Seconds dt)
    : proportional_N_per_m_(params.slave.proportional_N_per_m),
      derivative_N_s_per_m_(params.slave.derivative_N_s_per_m),
      impedance_N_s_per_m_(params.wave.impedance_N_s_per_m),
      dt_s_(dt.value),
      receiver_(receiver),
      velocity_(velocity) {}

WaveSlave::Output WaveSlave::respond(const Input& input) noexcept {
  const double b = impedance_N_s_per_m_;
  const double velocity_m_per_s = velocity_.step(input.motor_position_m);
  if (!started_) {
    started_ = true;
    wanted_m_ = sent_m_ = input.motor_position_m;
  }
  const double in = receiver_.step(input.arrival, input.motor_position_m);
  // With ẋ_d = √(2/b) u − F/b and x_d = x_d,before + ẋ_d dt the law of the servo is linear in F.
  const double unloaded_m_per_s = std::sqrt(2.0 / b) * in;
  const double per_velocity = proportional_N_per_m_ * dt_s_ + derivative_N_s_per_m_;
  const double force_N = (proportional_N_per_m_ * (wanted_m_ - input.motor_position_m) -
                          derivative_N_s_per_m_ * velocity_m_per_s + per_velocity * unloaded_m_per_s) /
                         (1.0 + per_velocity / b);
  wanted_m_ += dt_s_ * (unloaded_m_per_s - force_N / b);
  const double out = in - std::sqrt(2.0 / b) * force_N;
  sent_m_ += std::sqrt(2.0 / b) * dt_s_ * out;
  sent_J_ += 0.5 * dt_s_ * out * out;
  return {.motor_force_N = force_N, .message = {.position_m = sent_m_, .wave = out, .energy_J = sent_J_}};
}

void WaveSlave::reset() noexcept {
  receiver_.reset();
  velocity_.reset();
  started_ = false;
  wanted_m_ = 0.0;
  sent_m_ = 0.0;
  sent_J_ = 0.0;
}

namespace {

Result<Controllers> make_wave_variables(const ControlParams& params, Seconds dt) {
  const auto master = WaveMaster::make({.position_scale = params.position_scale,
                                        .force_gain = params.force_gain,
                                        .force_limit_N = params.force_limit_N,
                                        .wave = params.own<WaveParams>()},
                                       dt);
  if (!master) return master.error();
  const auto slave = WaveSlave::make({.slave = params.slave, .wave = params.own<WaveParams>()}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

}  // namespace

Architecture wave_variables_architecture() {
  return {.name = "wave-variables",
          .summary = "the sites exchange wave variables: passive for every delay",
          .make = make_wave_variables,
          .keys = own_keys<WaveParams>("wave", "Architecture wave-variables."),
          .uses_tip_force = false};
}

}  // namespace tactus::control
