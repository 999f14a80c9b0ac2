#include <tactus/simulation/teleoperator.hpp>

namespace tactus::simulation {

Result<Teleoperator> Teleoperator::make(const Params& params, double start_m) {
  if (auto error = validate(params)) return *std::move(error);
  const auto clock = Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const Seconds tick{clock->tick_s};

  auto sites = control::make_sites(params.control, tick);
  if (!sites) return under("control", sites.error());
  auto master = MasterSide::make(params.master, params.person, *clock, std::move(sites->master), start_m);
  if (!master) return master.error();
  const double slave_start_m = params.control.position_scale * start_m;
  auto slave = SlaveSide::make(params.slave, params.environment, *clock, std::move(sites->slave), slave_start_m);
  if (!slave) return slave.error();

  const auto to_slave = Channel::make(params.channel.to_slave, tick, {.position_m = slave_start_m});
  if (!to_slave) return under("channel.to_slave", to_slave.error());
  const auto to_master = Channel::make(params.channel.to_master, tick, {.position_m = slave_start_m});
  if (!to_master) return under("channel.to_master", to_master.error());

  return Teleoperator(Parts{*std::move(master), *std::move(slave), *to_slave, *to_master}, clock->tick_s);
}

Teleoperator::Record Teleoperator::step(double path_m, double path_at_next_tick_m) noexcept {
  const double time_s = static_cast<double>(ticks_) * tick_s_;
  const auto [master_reading, master] = parts_.master.control(arrived_);
  const auto [slave_reading, slave] = parts_.slave.control(parts_.to_slave.step(master.message));
  arrived_ = parts_.to_master.step(slave.message);

  Record record{.time_s = time_s,
                .master_position_m = master_reading.motor_position_m,
                .induced_position_m = master.induced_position_m,
                .command_m = master.message.position_m,
                .slave_position_m = slave_reading.motor_position_m,
                .tip_position_m = parts_.slave.tip_position_m(),
                .displayed_force_N = -master.motor_force_N,
                .handle_force_N = master.handle_force_N,
                .hand_force_N = master_reading.hand_force_N,
                .told_force_N = slave.message.force_N};

  parts_.master.move(path_m, path_at_next_tick_m);
  const auto contact = parts_.slave.move(time_s);
  record.contact_force_N = contact.force_N;
  record.peak_contact_force_N = contact.peak_force_N;
  record.touched = contact.touched;
  record.touched_at_s = contact.touched_at_s;
  ++ticks_;
  return record;
}

bool Teleoperator::healthy() const noexcept {
  return parts_.master.fault() == control::GateFault::none && parts_.slave.fault() == control::GateFault::none;
}

}  // namespace tactus::simulation
