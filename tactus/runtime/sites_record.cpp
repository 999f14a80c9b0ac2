#include <tactus/runtime/sites_record.hpp>

namespace tactus::runtime {

SitesRecord recorded(std::int64_t tap, const station::Tick& tick, const station::BarePair::Output& step) noexcept {
  const auto& [master, slave] = step;
  const control::Message& to_slave = master.output.message;
  const control::Message& to_master = slave.output.message;
  return {.tap = tap,
          .tick = tick.number,
          .missed = tick.missed,
          .master_position_m = master.reading.position_m,
          .hand_force_N = master.reading.force_N,
          .grip = master.reading.grip,
          .slave_position_m = slave.reading.position_m,
          .tip_force_N = slave.reading.force_N,
          .master_force_N = master.output.motor_force_N,
          .handle_force_N = master.output.handle_force_N,
          .induced_position_m = master.output.induced_position_m,
          .intended_position_m = master.output.intended_position_m,
          .to_slave_position_m = to_slave.position_m,
          .to_slave_velocity_m_per_s = to_slave.velocity_m_per_s,
          .to_slave_force_N = to_slave.force_N,
          .to_slave_wave = to_slave.wave,
          .to_slave_energy_J = to_slave.energy_J,
          .slave_force_N = slave.output.motor_force_N,
          .to_master_position_m = to_master.position_m,
          .to_master_velocity_m_per_s = to_master.velocity_m_per_s,
          .to_master_force_N = to_master.force_N,
          .to_master_wave = to_master.wave,
          .to_master_energy_J = to_master.energy_J};
}

}  // namespace tactus::runtime
