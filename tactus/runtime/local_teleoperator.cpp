#include <tactus/control/site_supervisor.hpp>
#include <tactus/runtime/local_teleoperator.hpp>

#include <algorithm>
#include <limits>

namespace tactus::runtime {

namespace {

DeviceReading trusted_reading(Device& device, const Tick& tick) noexcept {
  DeviceReading reading = device.read(tick);
  if (device.health() == DeviceHealth::lost) reading.position_m = std::numeric_limits<double>::quiet_NaN();
  return reading;
}

void tighten(double& limit, double of_device) {
  if (of_device > 0.0) limit = std::min(limit, of_device);
}

/// Within what the device allows, so that the gate acts before the device's own wall does.
void tighten(control::SafetyGate::Params& gate, const DeviceLimits& device) {
  tighten(gate.force_limit_N, device.force_N);
  tighten(gate.rate_limit_N_per_s, device.rate_N_per_s);
  tighten(gate.velocity_limit_m_per_s, device.velocity_m_per_s / control::SafetyGate::fault_factor);
  tighten(gate.position_limit_m, device.position_m / control::SafetyGate::fault_factor);
}

/// What must stand before a device that is not simulated; null for one that is.
Result<std::unique_ptr<GuardedDevice>> wall_before(Device& device, const control::ControlParams& control,
                                                   control::SiteRole role) {
  if (auto error = check_limits(device)) {
    return under(role == control::SiteRole::master ? "master" : "slave", *std::move(error));
  }
  static_cast<void>(control);
  if (device.simulated()) return std::unique_ptr<GuardedDevice>();
  return std::make_unique<GuardedDevice>(device);
}

}  // namespace

Result<LocalTeleoperator> LocalTeleoperator::make(const control::ControlParams& control,
                                                  const simulation::LinkParams& channel, Seconds tick,
                                                  double slave_start_m, Device& master, Device& slave) {
  auto master_wall = wall_before(master, control, control::SiteRole::master);
  if (!master_wall) return master_wall.error();
  auto slave_wall = wall_before(slave, control, control::SiteRole::slave);
  if (!slave_wall) return slave_wall.error();
  control::ControlParams tightened = control;
  tighten(tightened.gate, master.limits());
  tighten(tightened.handle_gate.force_limit_N, master.limits().handle_force_N);
  tighten(tightened.handle_gate.rate_limit_N_per_s, master.limits().rate_N_per_s);
  tighten(tightened.slave_gate, slave.limits());
  auto sites = simulation::SitePair::make(tightened, channel, tick, slave_start_m);
  if (!sites) return sites.error();
  return LocalTeleoperator(*std::move(sites), {*std::move(master_wall), *std::move(slave_wall)}, master, slave);
}

LocalTeleoperator::Output LocalTeleoperator::advance(const Tick& tick, double share) noexcept {
  Output output;
  output.master = trusted_reading(*master_, tick);
  output.slave = trusted_reading(*slave_, tick);
  output.sites = sites_.step({.master_position_m = output.master.position_m,
                              .hand_force_N = output.master.force_N,
                              .grip = output.master.grip,
                              .slave_position_m = output.slave.position_m,
                              .tip_force_N = output.slave.force_N},
                             tick.missed + 1, share);
  master_->write({.force_N = output.sites.master.motor_force_N, .handle_force_N = output.sites.master.handle_force_N});
  slave_->write({.force_N = output.sites.slave.motor_force_N});
  return output;
}

void LocalTeleoperator::release() noexcept {
  master_->write({.enabled = false});
  slave_->write({.enabled = false});
}

}  // namespace tactus::runtime
