#include <tactus/simulation/teleoperator.hpp>

#include <algorithm>
#include <utility>

namespace tactus::simulation {

Result<Teleoperator> Teleoperator::make(const Params& params, double start_m) {
  if (auto error = validate(params)) return *std::move(error);
  const auto clock = Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const Seconds tick{clock->tick_s};
  const Seconds substep{clock->substep_s};

  auto master = mechanics::CableDrivenMaster::make(params.master, params.person.grip, substep);
  if (!master) {
    const Error& error = master.error();
    return under(error.parameter.starts_with("grip.") ? "operator" : "master", error);
  }
  const double factor = params.person.grip_change.factor;
  if (const auto changed =
          mechanics::CableDrivenMaster::make(params.master, mechanics::scaled(params.person.grip, factor), substep);
      !changed) {
    return under("operator", changed.error());
  }
  auto slave = mechanics::ElectricSlave::make(params.slave, params.environment, substep);
  if (!slave) {
    const Error& error = slave.error();
    return error.parameter.starts_with("environment.") ? error : under("slave", error);
  }
  auto person = mechanics::Operator::make(params.person, tick);
  if (!person) return under("operator", person.error());
  auto sites = control::make_sites(params.control, tick);
  if (!sites) return under("control", sites.error());

  const double slave_start_m = params.control.position_scale * start_m;
  master->reset(start_m);
  slave->reset(slave_start_m);
  const auto to_slave = Channel::make(params.channel.to_slave, tick, {.position_m = slave_start_m});
  if (!to_slave) return under("channel.to_slave", to_slave.error());
  const auto to_master = Channel::make(params.channel.to_master, tick, {.position_m = slave_start_m});
  if (!to_master) return under("channel.to_master", to_master.error());

  return Teleoperator(Pieces{*master, *slave, *person, *std::move(sites), *to_slave, *to_master}, *clock,
                      params.person);
}

void Teleoperator::change_grip(double time_s) noexcept {
  const double factor = grip_change_.at(time_s);
  if (factor == grip_factor_) return;
  grip_factor_ = factor;
  parts_.master.hold(mechanics::scaled(grip_, factor));
}

Teleoperator::Record Teleoperator::step(double path_m, double path_at_next_tick_m) noexcept {
  const double time_s = static_cast<double>(ticks_) * clock_.tick_s;
  change_grip(time_s);
  const mechanics::CableDrivenMaster::Reading master_reading = parts_.master.measure();
  const mechanics::ElectricSlave::Reading slave_reading = parts_.slave.measure();

  master_input_ = {.motor_position_m = master_reading.motor_position_m,
                   .hand_force_N = master_reading.hand_force_N,
                   .arrival = arrived_,
                   .grip = grip_factor_};
  const auto master = parts_.sites.master.step(master_input_);
  slave_input_ = {.motor_position_m = slave_reading.motor_position_m,
                  .tip_force_N = slave_reading.tip_force_N,
                  .arrival = parts_.to_slave.step(master.message)};
  const auto slave = parts_.sites.slave.step(slave_input_);
  arrived_ = parts_.to_master.step(slave.message);

  Record record{.time_s = time_s,
                .master_position_m = master_reading.motor_position_m,
                .induced_position_m = master.induced_position_m,
                .command_m = master.message.position_m,
                .slave_position_m = slave_reading.motor_position_m,
                .tip_position_m = parts_.slave.mechanism().tip_position_m(),
                .displayed_force_N = -master.motor_force_N,
                .handle_force_N = master.handle_force_N,
                .hand_force_N = master_reading.hand_force_N,
                .told_force_N = slave.message.force_N};

  const auto aim = parts_.person.step({.path_m = path_m,
                                       .path_at_next_tick_m = path_at_next_tick_m,
                                       .handle_position_m = parts_.master.mechanism().tip_position_m()});
  double contact_sum_N = 0.0;
  for (int i = 0; i < clock_.substeps; ++i) {
    if (i == clock_.late_substeps) {
      master_command_N_ = master.motor_force_N;
      handle_command_N_ = master.handle_force_N;
      slave_command_N_ = slave.motor_force_N;
    }
    const double middle_s = (i + 0.5) * clock_.substep_s;
    parts_.master.step({.commanded_force_N = master_command_N_,
                        .commanded_handle_force_N = handle_command_N_,
                        .grip_position_m = aim.position_m + middle_s * aim.velocity_m_per_s,
                        .grip_velocity_m_per_s = aim.velocity_m_per_s});
    const auto contact = parts_.slave.step(slave_command_N_);
    contact_sum_N += contact.contact_force_N;
    record.peak_contact_force_N = std::max(record.peak_contact_force_N, contact.contact_force_N);
    if (contact.touched && !record.touched) {
      record.touched = true;
      record.touched_at_s = time_s + i * clock_.substep_s + contact.touched_after_s;
    }
  }
  record.contact_force_N = contact_sum_N / clock_.substeps;
  ++ticks_;
  return record;
}

void Teleoperator::exchange(Teleoperator& made, const Parts& parts) noexcept {
  constexpr int ticks_to_rest = 1000;
  if (parts.grip) {
    std::swap(grip_, made.grip_);
    parts_.master.hold(mechanics::scaled(grip_, grip_factor_));
  }
  if (parts.environment) parts_.slave.face(made.parts_.slave.environment());
  if (parts.channel) {
    made.parts_.to_slave.continue_from(parts_.to_slave);
    made.parts_.to_master.continue_from(parts_.to_master);
    std::swap(parts_.to_slave, made.parts_.to_slave);
    std::swap(parts_.to_master, made.parts_.to_master);
  }
  if (parts.controllers) {
    parts_.sites.master.exchange_controller(made.parts_.sites.master, master_input_, master_command_N_, ticks_to_rest);
    parts_.sites.slave.exchange_controller(made.parts_.sites.slave, slave_input_, slave_command_N_, ticks_to_rest);
  }
}

bool Teleoperator::healthy() const noexcept {
  return parts_.sites.master.fault() == control::GateFault::none &&
         parts_.sites.slave.fault() == control::GateFault::none;
}

}  // namespace tactus::simulation
