// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/energy_tank.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::control {

Result<EnergyTank> EnergyTank::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  if (params.capacity_J < params.desired_level_J) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "capacity_J",
                 .message = rounded_number(params.capacity_J) + " J is less than desired_level_J, " +
                            rounded_number(params.desired_level_J) + " J: raise one or lower the other",
                 .place = {}};
  }
  return EnergyTank(params, dt);
}

EnergyTank::EnergyTank(const Params& params, Seconds dt)
    : desired_level_J_(params.desired_level_J),
      capacity_J_(params.capacity_J),
      transfer_share_(-std::expm1(-params.transfer_per_s * dt.value)),
      refill_damping_N_s_per_m_(params.refill_damping_N_s_per_m),
      longest_step_m_(params.fastest_m_per_s * dt.value),
      level_J_(params.desired_level_J) {}

void EnergyTank::settle(double motor_position_m, const Arrival& arrival) noexcept {
  if (started_) level_J_ -= applied_N_ * (motor_position_m - position_before_m_);
  started_ = true;
  position_before_m_ = motor_position_m;
  level_J_ += arrival.message.energy_J - received_J_;
  received_J_ = arrival.message.energy_J;
  level_J_ = std::min(level_J_, capacity_J_);
  const double packet_J = transfer_share_ * std::max(level_J_, 0.0);
  level_J_ -= packet_J;
  sent_J_ += packet_J;
}

double EnergyTank::limit(double motor_force_N) const noexcept {
  const double most_N = std::max(level_J_, 0.0) / longest_step_m_;
  // A level that is not a number has to reach the motor's gate, which catches it.
  return std::isnan(most_N) ? most_N : std::clamp(motor_force_N, -most_N, most_N);
}

double EnergyTank::refill_damping() const noexcept {
  return refill_damping_N_s_per_m_ * std::clamp(1.0 - level_J_ / desired_level_J_, 0.0, 1.0);
}

void EnergyTank::reset() noexcept {
  level_J_ = desired_level_J_;
  received_J_ = 0.0;
  sent_J_ = 0.0;
  applied_N_ = 0.0;
  position_before_m_ = 0.0;
  started_ = false;
}

Result<TankMaster> TankMaster::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto display = PositionForceMaster::make(params.display, dt);
  if (!display) return under("display", display.error());
  const auto tank = EnergyTank::make(params.tank, dt);
  if (!tank) return under("tank", tank.error());
  const auto velocity = signal::FilteredDerivative::make(params.tank.velocity, dt);
  if (!velocity) return under("tank.velocity", velocity.error());
  return TankMaster(*display, *tank, *velocity);
}

TankMaster::Output TankMaster::respond(const Input& input) noexcept {
  tank_.settle(input.motor_position_m, input.arrival);
  const double drawing_N = tank_.refill_damping() * velocity_.step(input.motor_position_m);
  Output output = display_.respond(input);
  // An empty tank gives no force, but its damper may always act: it takes energy from the hand.
  output.motor_force_N = tank_.level_J() > 0.0 ? tank_.limit(output.motor_force_N - drawing_N) : -drawing_N;
  output.message.energy_J = tank_.sent_J();
  return output;
}

void TankMaster::reset() noexcept {
  display_.reset();
  tank_.reset();
  velocity_.reset();
}

Result<TankSlave> TankSlave::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto site = PositionForceSlave::make(params.slave, dt);
  if (!site) return under("slave", site.error());
  const auto tank = EnergyTank::make(params.tank, dt);
  if (!tank) return under("tank", tank.error());
  return TankSlave(*site, *tank);
}

TankSlave::Output TankSlave::respond(const Input& input) noexcept {
  tank_.settle(input.motor_position_m, input.arrival);
  Output output = site_.respond(input);
  output.motor_force_N = tank_.limit(output.motor_force_N);
  output.message.energy_J = tank_.sent_J();
  return output;
}

void TankSlave::reset() noexcept {
  site_.reset();
  tank_.reset();
}

namespace {

Result<Controllers> make_energy_tank(const ControlParams& params, Seconds dt) {
  const auto master = TankMaster::make({.display = params, .tank = params.own<EnergyTank::Params>()}, dt);
  if (!master) return out_of("display", master.error());
  const auto slave = TankSlave::make({.slave = params.slave, .tank = params.own<EnergyTank::Params>()}, dt);
  if (!slave) return slave.error();
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

}  // namespace

Architecture energy_tank_architecture() {
  return {.name = "energy-tank",
          .summary = "position-force, its forces paid from a tank of energy at each site",
          .make = make_energy_tank,
          .keys = own_keys<EnergyTank::Params>("tank", "Architecture energy-tank.")};
}

}  // namespace tactus::control
