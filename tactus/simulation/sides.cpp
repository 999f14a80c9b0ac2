#include <tactus/simulation/sides.hpp>

#include <algorithm>

namespace tactus::simulation {

Result<MasterSide> MasterSide::make(const mechanics::CableDrivenMaster::Params& master,
                                    const mechanics::Operator::Params& person, const Clock& clock,
                                    control::MasterSite site, double start_m) {
  const Seconds substep{clock.substep_s};
  auto plant = mechanics::CableDrivenMaster::make(master, person.grip, substep);
  if (!plant) {
    const Error& error = plant.error();
    return under(error.parameter.starts_with("grip.") ? "operator" : "master", error);
  }
  const double factor = person.grip_change.factor;
  if (const auto changed = mechanics::CableDrivenMaster::make(master, mechanics::scaled(person.grip, factor), substep);
      !changed) {
    return under("operator", changed.error());
  }
  const auto hand = mechanics::Operator::make(person, Seconds{clock.tick_s});
  if (!hand) return under("operator", hand.error());
  plant->reset(start_m);
  return MasterSide(*plant, *hand, std::move(site), clock, person);
}

MasterSide::Controlled MasterSide::control(const control::Arrival& arrival) noexcept {
  change_grip();
  const auto reading = master_.measure();
  output_ = site_.step({.motor_position_m = reading.motor_position_m,
                        .hand_force_N = reading.hand_force_N,
                        .arrival = arrival,
                        .grip = grip_factor_});
  return {.reading = reading, .output = output_};
}

void MasterSide::change_grip() noexcept {
  const double factor = grip_change_.at(static_cast<double>(ticks_) * clock_.tick_s);
  if (factor == grip_factor_) return;
  grip_factor_ = factor;
  master_.hold(mechanics::scaled(grip_, factor));
}

void MasterSide::move(double path_m, double path_at_next_tick_m) noexcept {
  const auto aim = person_.step({.path_m = path_m,
                                 .path_at_next_tick_m = path_at_next_tick_m,
                                 .handle_position_m = master_.mechanism().tip_position_m()});
  for (int i = 0; i < clock_.substeps; ++i) {
    if (i == clock_.late_substeps) {
      motor_command_N_ = output_.motor_force_N;
      handle_command_N_ = output_.handle_force_N;
    }
    const double middle_s = (i + 0.5) * clock_.substep_s;
    master_.step({.commanded_force_N = motor_command_N_,
                  .commanded_handle_force_N = handle_command_N_,
                  .grip_position_m = aim.position_m + middle_s * aim.velocity_m_per_s,
                  .grip_velocity_m_per_s = aim.velocity_m_per_s});
  }
  ++ticks_;
}

Result<SlaveSide> SlaveSide::make(const mechanics::ElectricSlave::Params& slave,
                                  const mechanics::Environment::Params& environment, const Clock& clock,
                                  control::SlaveSite site, double start_m) {
  auto plant = mechanics::ElectricSlave::make(slave, environment, Seconds{clock.substep_s});
  if (!plant) {
    const Error& error = plant.error();
    return error.parameter.starts_with("environment.") ? error : under("slave", error);
  }
  plant->reset(start_m);
  return SlaveSide(*plant, std::move(site), clock);
}

SlaveSide::Controlled SlaveSide::control(const control::Arrival& arrival) noexcept {
  const auto reading = slave_.measure();
  const auto output = site_.step(
      {.motor_position_m = reading.motor_position_m, .tip_force_N = reading.tip_force_N, .arrival = arrival});
  next_motor_command_N_ = output.motor_force_N;
  return {.reading = reading, .output = output};
}

SlaveSide::Contact SlaveSide::move(double time_s) noexcept {
  Contact contact;
  double sum_N = 0.0;
  for (int i = 0; i < clock_.substeps; ++i) {
    if (i == clock_.late_substeps) motor_command_N_ = next_motor_command_N_;
    const auto substep = slave_.step(motor_command_N_);
    sum_N += substep.contact_force_N;
    contact.peak_force_N = std::max(contact.peak_force_N, substep.contact_force_N);
    if (substep.touched && !contact.touched) {
      contact.touched = true;
      contact.touched_at_s = time_s + i * clock_.substep_s + substep.touched_after_s;
    }
  }
  contact.force_N = sum_N / clock_.substeps;
  return contact;
}

}  // namespace tactus::simulation
