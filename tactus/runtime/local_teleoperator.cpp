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

template <class GateParams>
void tighten(GateParams& gate, double limit_N) {
  if (limit_N > 0.0) gate.force_limit_N = std::min(gate.force_limit_N, limit_N);
}

}  // namespace

Result<LocalTeleoperator> LocalTeleoperator::make(const control::ControlParams& control,
                                                  const simulation::LinkParams& channel, Seconds tick,
                                                  double slave_start_m, Device& master, Device& slave) {
  control::ControlParams tightened = control;
  tighten(tightened.gate, master.limits().force_N);
  tighten(tightened.handle_gate, master.limits().handle_force_N);
  tighten(tightened.slave_gate, slave.limits().force_N);
  auto sites = simulation::SitePair::make(tightened, channel, tick, slave_start_m);
  if (!sites) return sites.error();
  return LocalTeleoperator(*std::move(sites), master, slave);
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
  master_->write({});
  slave_->write({});
}

}  // namespace tactus::runtime
