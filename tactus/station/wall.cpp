#include <tactus/control/protective_limits.hpp>
#include <tactus/station/wall.hpp>

#include <algorithm>

namespace tactus::station {

namespace {

void tighten(double& limit, double of_device) {
  if (of_device > 0.0) limit = std::min(limit, of_device);
}

void tighten(control::SafetyGate::Params& gate, const DeviceLimits& device) {
  tighten(gate.force_limit_N, device.force_N);
  tighten(gate.rate_limit_N_per_s, device.rate_N_per_s);
  tighten(gate.velocity_limit_m_per_s, device.velocity_m_per_s / control::SafetyGate::fault_factor);
  tighten(gate.position_limit_m, device.position_m / control::SafetyGate::fault_factor);
}

}  // namespace

Result<std::unique_ptr<GuardedDevice>> wall_before(Device& device, const control::ControlParams& control,
                                                   control::SiteRole role) {
  if (auto error = check_limits(device)) {
    return under(role == control::SiteRole::master ? "master" : "slave", *std::move(error));
  }
  if (device.simulated()) return std::unique_ptr<GuardedDevice>();
  if (auto error = control::refuse_default_limits(control, role)) return under("control", *std::move(error));
  return std::make_unique<GuardedDevice>(device);
}

control::ControlParams tightened(const control::ControlParams& control, control::SiteRole role,
                                 const DeviceLimits& device) {
  control::ControlParams own = control;
  if (role == control::SiteRole::slave) {
    tighten(own.slave_gate, device);
    return own;
  }
  tighten(own.gate, device);
  tighten(own.handle_gate.force_limit_N, device.handle_force_N);
  tighten(own.handle_gate.rate_limit_N_per_s, device.rate_N_per_s);
  return own;
}

}  // namespace tactus::station
