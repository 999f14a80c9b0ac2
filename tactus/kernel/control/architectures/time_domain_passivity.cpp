// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/time_domain_passivity.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::control {

Result<PassivityMaster> PassivityMaster::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  if (params.display.force_gain == 0.0) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "display.force_gain",
                 .message = "0 leaves no force whose energy could be counted: write a gain above 0",
                 .place = {}};
  }
  const auto display = PositionForceMaster::make(params.display, dt);
  if (!display) return under("display", display.error());
  const auto velocity = signal::FilteredDerivative::make(params.passivity.velocity, dt);
  if (!velocity) return under("passivity.velocity", velocity.error());
  return PassivityMaster(params, *display, *velocity, dt);
}

PassivityMaster::PassivityMaster(const Params& params, const PositionForceMaster& display,
                                 const signal::FilteredDerivative& velocity, Seconds dt)
    : power_scale_(params.display.position_scale / params.display.force_gain),
      damping_limit_N_s_per_m_(params.passivity.damping_limit_N_s_per_m),
      dt_s_(dt.value),
      display_(display),
      velocity_(velocity) {}

PassivityMaster::Output PassivityMaster::respond(const Input& input) noexcept {
  const double position_m = input.motor_position_m;
  const double step_m = started_ ? position_m - position_before_m_ : 0.0;
  started_ = true;
  position_before_m_ = position_m;
  // The motor force is positive along the motion, so what it does is work out of the line.
  port_.count(-power_scale_ * reflected_N_ * step_m);
  port_.dissipate(-power_scale_ * (applied_N_ - reflected_N_) * step_m);

  const double velocity_m_per_s = velocity_.step(position_m);
  const double lack_J = -port_.available_J(input.arrival.message.energy_J) / power_scale_;
  Output output = display_.respond(input);
  reflected_N_ = output.motor_force_N;
  // Written so that an energy that is not a number reaches the gate.
  if (!(lack_J <= 0.0) && velocity_m_per_s != 0.0) {
    const double braking_N = -lack_J / (dt_s_ * velocity_m_per_s);
    const double driving_N = reflected_N_ * velocity_m_per_s > 0.0 ? std::fabs(reflected_N_) : 0.0;
    const double most_N = std::max(damping_limit_N_s_per_m_ * std::fabs(velocity_m_per_s), driving_N);
    output.motor_force_N += std::clamp(braking_N, -most_N, most_N);
  }
  output.message.energy_J = port_.in_J();
  return output;
}

void PassivityMaster::applied(double motor_force_N) noexcept {
  applied_N_ = motor_force_N;
  display_.applied(motor_force_N);
}

void PassivityMaster::reset() noexcept {
  display_.reset();
  velocity_.reset();
  port_ = {};
  started_ = false;
  position_before_m_ = 0.0;
  reflected_N_ = 0.0;
  applied_N_ = 0.0;
}

Result<PassivitySlave> PassivitySlave::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto servo = ServoPd::make(params.slave, dt);
  if (!servo) return under("slave", servo.error());
  return PassivitySlave(params, *servo, dt);
}

PassivitySlave::PassivitySlave(const Params& params, const ServoPd& servo, Seconds dt)
    : reflected_force_(params.passivity.reflected_force),
      recovery_per_tick_(std::min(1.0, dt.value / params.passivity.recovery_time_s)),
      servo_(servo) {}

PassivitySlave::Output PassivitySlave::respond(const Input& input) noexcept {
  const double command_m = input.arrival.message.position_m;
  if (!started_) {
    started_ = true;
    command_before_m_ = wanted_m_ = command_m;
  }
  const double reflected_N = reflected_force_ == ReflectedForce::tip ? input.tip_force_N : applied_N_;
  double step_m = command_m - command_before_m_ + recovery_per_tick_ * (command_before_m_ - wanted_m_);
  command_before_m_ = command_m;
  const double work_J = reflected_N * step_m;
  port_.count(-work_J);
  const double lack_J = -port_.available_J(input.arrival.message.energy_J);
  // β f T = lack / f. The lack is no more than the work of this very step, unless the other site started anew: then
  // the slave stands still.
  if (!(lack_J <= 0.0) && work_J > 0.0) {
    const double slip_J = std::min(lack_J, work_J);
    step_m -= slip_J / reflected_N;
    port_.dissipate(slip_J);
  }
  wanted_m_ += step_m;
  return {.motor_force_N = servo_.step(wanted_m_ - input.motor_position_m),
          .message = {.force_N = reflected_N, .energy_J = port_.in_J()}};
}

void PassivitySlave::reset() noexcept {
  servo_.reset();
  port_ = {};
  started_ = false;
  command_before_m_ = 0.0;
  wanted_m_ = 0.0;
  applied_N_ = 0.0;
}

namespace {

Result<Controllers> make_time_domain_passivity(const ControlParams& params, Seconds dt) {
  const auto master = PassivityMaster::make({.display = params, .passivity = params.own<PassivityParams>()}, dt);
  if (!master) return out_of("display", master.error());
  const auto slave = PassivitySlave::make({.slave = params.slave, .passivity = params.own<PassivityParams>()}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

}  // namespace

Architecture time_domain_passivity_architecture() {
  return {.name = "time-domain-passivity",
          .summary = "position-force between two passivity observers and controllers",
          .make = make_time_domain_passivity,
          .keys = own_keys<PassivityParams>("passivity", "Architecture time-domain-passivity.")};
}

}  // namespace tactus::control
