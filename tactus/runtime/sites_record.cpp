#include <tactus/runtime/sites_record.hpp>

namespace tactus::runtime {

SitesRecord recorded(std::int64_t tap, const Tick& tick, const LocalTeleoperator::Output& step) noexcept {
  const control::Message& to_slave = step.sites.master.message;
  const control::Message& to_master = step.sites.slave.message;
  return {.tap = tap,
          .tick = tick.number,
          .missed = tick.missed,
          .master_position_m = step.master.position_m,
          .hand_force_N = step.master.force_N,
          .grip = step.master.grip,
          .slave_position_m = step.slave.position_m,
          .tip_force_N = step.slave.force_N,
          .master_force_N = step.sites.master.motor_force_N,
          .handle_force_N = step.sites.master.handle_force_N,
          .induced_position_m = step.sites.master.induced_position_m,
          .intended_position_m = step.sites.master.intended_position_m,
          .to_slave_position_m = to_slave.position_m,
          .to_slave_velocity_m_per_s = to_slave.velocity_m_per_s,
          .to_slave_force_N = to_slave.force_N,
          .to_slave_wave = to_slave.wave,
          .to_slave_energy_J = to_slave.energy_J,
          .slave_force_N = step.sites.slave.motor_force_N,
          .to_master_position_m = to_master.position_m,
          .to_master_velocity_m_per_s = to_master.velocity_m_per_s,
          .to_master_force_N = to_master.force_N,
          .to_master_wave = to_master.wave,
          .to_master_energy_J = to_master.energy_J};
}

}  // namespace tactus::runtime
