// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/protective_limits.hpp>
#include <tactus/kernel/station/make_device_guard.hpp>

#include <algorithm>
#include <string>

namespace tactus::station {

namespace {

void tighten(double& limit, double of_device) {
  if (of_device > 0.0) limit = std::min(limit, of_device);
}

/// Where nobody chose how much force must move a joint, a change by one and a half of what it may have: friction and an
/// operator's hand hold a joint against less. Of one that gives no force, none must. Only for a device that reports its
/// velocity: there this check is the last of three.
void choose_threshold(control::SafetyGate::Params& gate, const DeviceLimits& device) {
  double& threshold_N = gate.encoder.frozen_force_N;
  if (threshold_N != control::SafetyGate::Params{}.encoder.frozen_force_N) return;
  constexpr double gives_none_N = 1e-6, never_N = 200.0;
  const double most_N = device.force_N > 0.0 ? std::min(gate.force_limit_N, device.force_N) : gate.force_limit_N;
  threshold_N = most_N < gives_none_N ? never_N : 1.5 * most_N;
}

void tighten(control::SafetyGate::Params& gate, const DeviceLimits& device) {
  tighten(gate.force_limit_N, device.force_N);
  tighten(gate.rate_limit_N_per_s, device.rate_N_per_s);
  tighten(gate.velocity_limit_m_per_s, device.velocity_m_per_s / control::SafetyGate::fault_factor);
  tighten(gate.position_limit_m, device.position_m / control::SafetyGate::fault_factor);
  if (!(device.velocity_step_m_per_s > 0.0)) return;
  gate.motion.velocity_step_m_per_s = device.velocity_step_m_per_s;
  choose_threshold(gate, device);
  // What a joint may give for ever is less than it can give at all, or no account would ever grow.
  const double most_W = gate.force_limit_N * control::SafetyGate::fault_factor * gate.velocity_limit_m_per_s;
  gate.energy.drain_W = std::min(gate.energy.drain_W, 0.5 * most_W);
}

/// Motors that report their own velocity are those of a bus, where no sensor measures a force.
bool senses_force(const DeviceLimits& device) { return !(device.velocity_step_m_per_s > 0.0); }

/// The parameters with the thresholds that nobody chose, for a device that has them follow.
control::ControlParams with_threshold(const control::ControlParams& control, control::SiteRole role,
                                      const DeviceLimits& device) {
  control::ControlParams own = control;
  if (device.velocity_step_m_per_s > 0.0) {
    choose_threshold(role == control::SiteRole::master ? own.gate : own.slave_gate, device);
  }
  return own;
}

}  // namespace

template <class Reading>
Result<std::unique_ptr<GuardedDeviceOf<Reading>>> make_device_guard(DeviceOf<Reading>& device, std::size_t joints,
                                                                    control::SiteRole role) {
  const char* site = role == control::SiteRole::master ? "master" : "slave";
  if (auto error = check_limits(device)) return under(site, *std::move(error));
  if (const std::size_t own = joints_of(device.limits()); own != joints) {
    return Error{
        .code = ErrorCode::inconsistent,
        .parameter = site,
        .message = "has " + std::to_string(own) + " joints, and the parameters are of " + std::to_string(joints),
        .place = {}};
  }
  if (device.simulated()) return std::unique_ptr<GuardedDeviceOf<Reading>>();
  return std::make_unique<GuardedDeviceOf<Reading>>(device);
}

template <class Reading>
Result<std::unique_ptr<GuardedDeviceOf<Reading>>> make_device_guard(
    DeviceOf<Reading>& device, const Each<Reading, control::ControlParams>& control, control::SiteRole role) {
  auto guard = make_device_guard(device, joints_of(control), role);
  if (!guard || !*guard) return guard;
  const auto allowed = device.limits();
  for (std::size_t joint = 0; joint < joints_of(control); ++joint) {
    const control::ControlParams& own = joint_of(control, joint);
    const DeviceLimits& limits = joint_of(allowed, joint);
    auto error = control::refuse_default_limits(with_threshold(own, role, limits), role, senses_force(limits));
    if (!error) error = control::refuse_unreachable(tightened(own, role, limits), role, senses_force(limits));
    if (error) return under("control", under_joint<Reading>(joint, *std::move(error)));
  }
  return guard;
}

template Result<std::unique_ptr<GuardedDevice>> make_device_guard(Device&, std::size_t, control::SiteRole);
template Result<std::unique_ptr<GuardedJointDevice>> make_device_guard(JointDevice&, std::size_t, control::SiteRole);
template Result<std::unique_ptr<GuardedDevice>> make_device_guard(Device&, const control::ControlParams&,
                                                                  control::SiteRole);
template Result<std::unique_ptr<GuardedJointDevice>> make_device_guard(JointDevice&,
                                                                       const Joints<control::ControlParams>&,
                                                                       control::SiteRole);

control::SafetyGate::Params tightened(const control::SafetyGate::Params& gate, const DeviceLimits& device) {
  control::SafetyGate::Params own = gate;
  tighten(own, device);
  return own;
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

Joints<control::ControlParams> tightened(const Joints<control::ControlParams>& control, control::SiteRole role,
                                         const Joints<DeviceLimits>& device) {
  Joints<control::ControlParams> own = control;
  for_each_joint(
      [role](control::ControlParams& joint, const DeviceLimits& limits) { joint = tightened(joint, role, limits); },
      own, device);
  return own;
}

}  // namespace tactus::station
