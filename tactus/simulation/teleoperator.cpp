#include <tactus/simulation/teleoperator.hpp>

namespace tactus::simulation {

Result<Teleoperator> Teleoperator::make(const Params& params, double start_m) {
  if (auto error = validate(params)) return *std::move(error);
  const auto clock = Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const double slave_start_m = params.control.position_scale * start_m;
  auto master = MasterPlant::make(params.master, params.person, *clock, start_m);
  if (!master) return master.error();
  auto slave = SlavePlant::make(params.slave, params.environment, *clock, slave_start_m);
  if (!slave) return slave.error();
  auto sites = station::BarePair::make(params.control, params.channel, Seconds{clock->tick_s}, slave_start_m);
  if (!sites) return sites.error();
  return Teleoperator(*master, *slave, *std::move(sites), *clock);
}

Teleoperator::Record Teleoperator::step(double path_m, double path_at_next_tick_m, double share) noexcept {
  const station::BarePair::Output output = sites_.step(master_, slave_, {.number = ticks_}, share);
  Record record = recorded(static_cast<double>(ticks_) * clock_.tick_s, output);
  record.tip_position_m = slave_.tip_position_m();

  master_.begin_tick(path_m, path_at_next_tick_m);
  slave_.begin_tick();
  // In turns, so that the processor works on both at once.
  for (int i = 0; i < clock_.substeps; ++i) {
    master_.substep(i);
    slave_.substep(i);
  }
  add_contact(record, slave_.contact(), clock_);
  ++ticks_;
  return record;
}

void Teleoperator::exchange(Teleoperator& made, const Parts& parts) noexcept {
  if (parts.grip) master_.exchange_grip(made.master_);
  if (parts.environment) slave_.exchange_wall(made.slave_);
  if (parts.channel) sites_.exchange_channels(made.sites_);
  if (parts.controllers) sites_.exchange_controllers(made.sites_);
}

Teleoperator::Record Teleoperator::recorded(double time_s, const station::BarePair::Output& output) noexcept {
  const auto& [master, slave] = output;
  Record record;
  record.time_s = time_s;
  record.master_position_m = master.reading.position_m;
  record.induced_position_m = master.output.induced_position_m;
  record.command_m = master.output.message.position_m;
  record.slave_position_m = slave.reading.position_m;
  record.displayed_force_N = -master.output.motor_force_N;
  record.handle_force_N = master.output.handle_force_N;
  record.hand_force_N = master.reading.force_N;
  record.told_force_N = slave.output.message.force_N;
  return record;
}

void Teleoperator::add_contact(Record& record, const SlavePlant::Contact& contact, const Clock& clock) noexcept {
  record.contact_force_N = contact.sum_N / clock.substeps;
  record.peak_contact_force_N = contact.peak_N;
  record.touched = contact.touched;
  record.touched_at_s =
      contact.touched ? record.time_s + contact.touched_substep * clock.substep_s + contact.touched_after_s : 0.0;
}

}  // namespace tactus::simulation
