#include <tactus/control/protective_limits.hpp>
#include <tactus/station/local_teleoperator.hpp>

#include <algorithm>

namespace tactus::station {

namespace {

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
  if (device.simulated()) return std::unique_ptr<GuardedDevice>();
  if (auto error = control::refuse_default_limits(control, role)) return under("control", *std::move(error));
  return std::make_unique<GuardedDevice>(device);
}

}  // namespace

template <class Pair>
Result<DevicePair<Pair>> DevicePair<Pair>::make(const control::ControlParams& control, const LinkParams& channel,
                                                Seconds tick, double slave_start_m, Device& master, Device& slave) {
  auto master_wall = wall_before(master, control, control::SiteRole::master);
  if (!master_wall) return master_wall.error();
  auto slave_wall = wall_before(slave, control, control::SiteRole::slave);
  if (!slave_wall) return slave_wall.error();
  if (std::is_same_v<Pair, BarePair> && (*master_wall || *slave_wall)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = *master_wall ? "master" : "slave",
                 .message =
                     "a device that is not simulated needs supervised sites, which a person arms and can stop: "
                     "drive it by a LocalTeleoperator",
                 .place = {}};
  }
  control::ControlParams tightened = control;
  tighten(tightened.gate, master.limits());
  tighten(tightened.handle_gate.force_limit_N, master.limits().handle_force_N);
  tighten(tightened.handle_gate.rate_limit_N_per_s, master.limits().rate_N_per_s);
  tighten(tightened.slave_gate, slave.limits());
  auto sites = Pair::make(tightened, channel, tick, slave_start_m);
  if (!sites) return sites.error();
  return DevicePair(*std::move(sites), {*std::move(master_wall), *std::move(slave_wall)}, master, slave);
}

template class DevicePair<SupervisedPair>;
template class DevicePair<BarePair>;

}  // namespace tactus::station
