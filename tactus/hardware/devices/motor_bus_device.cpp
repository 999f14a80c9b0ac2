// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/motor_bus_device.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace tactus::devices {

namespace {

using station::DeviceHealth;

/// To clear a fault from before and to switch on.
constexpr std::int64_t power_within_ns = 250'000'000;

}  // namespace

Result<std::unique_ptr<MotorBusDevice>> MotorBusDevice::make(MotorLink& bus, const Params& params) {
  if (params.joints.size() != bus.motors()) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "joints",
                 .message = std::to_string(params.joints.size()) + " joints for a bus of " +
                            std::to_string(bus.motors()) + " motors: state one for each",
                 .place = {}};
  }
  return std::unique_ptr<MotorBusDevice>(new MotorBusDevice(bus, params));
}

MotorBusDevice::MotorBusDevice(MotorLink& bus, const Params& params)
    : bus_(&bus), params_(params), reading_(params.joints.size()) {}

MotorBusDevice::~MotorBusDevice() {
  commands_.motors = {};
  bus_->command(commands_);
}

Joints<station::DeviceLimits> MotorBusDevice::limits() const {
  Joints<station::DeviceLimits> limits(params_.joints.size());
  for_each_joint([](station::DeviceLimits& to, const MotorJoint& joint) { to = joint.limits(); }, limits,
                 params_.joints);
  return limits;
}

Joints<station::DeviceReading> MotorBusDevice::read(const station::Tick& tick) noexcept {
  now_ns_ = tick.began_ns;
  if (const auto newest = bus_->newest()) last_ = *newest;
  for (std::size_t joint = 0; joint < reading_.size(); ++joint) {
    const MotorJoint& own = params_.joints[joint];
    const MotorReading& motor = last_.motors[joint];
    const double told_rad = own.position_rad(motor.position_rad);
    if (motor.answers > 0 && !std::exchange(placed_[joint], true)) {
      turns_rad_[joint] = own.first_position_rad(motor.position_rad) - told_rad;
    }
    reading_[joint].position_m = told_rad + turns_rad_[joint];
    reading_[joint].motor_report = {.velocity_m_per_s = own.velocity_rad_per_s(motor.velocity_rad_per_s),
                                    .force_N = own.torque_Nm(motor.torque_Nm)};
    reading_[joint].age_s = 1e-9 * static_cast<double>(tick.deadline_ns - motor.received_ns);
  }
  const DeviceTrouble now = found();
  if (health_ < DeviceHealth::not_responding || now.what >= trouble_.what) judge(now);
  return reading_;
}

DeviceTrouble MotorBusDevice::found() noexcept {
  DeviceTrouble found;
  std::int64_t oldest_ns = now_ns_;
  for (std::size_t joint = 0; joint < reading_.size(); ++joint) {
    if (last_.motors[joint].received_ns >= oldest_ns) continue;
    oldest_ns = last_.motors[joint].received_ns;
    found.joint = joint;
  }
  found.age_s = 1e-9 * static_cast<double>(now_ns_ - oldest_ns);
  found.cycle_age_s = 1e-9 * static_cast<double>(now_ns_ - last_.time_ns);
  const auto with = [&found](Trouble what) {
    found.what = what;
    return found;
  };
  if (!bus_->running()) return with(Trouble::bus_ended);
  if (last_.state == BusState::refused) return with(Trouble::bus_refused);
  if (last_.state == BusState::asking) return with(Trouble::not_responding);  // it failed, and is opened again
  if (last_.guard == GuardState::gone) return with(Trouble::guard_gone);
  if (last_.guard == GuardState::acted) return with(Trouble::guard_acted);
  bool silent = found.age_s > params_.silence_s;
  for (std::size_t joint = 0; joint < reading_.size(); ++joint) {
    const MotorReading& motor = last_.motors[joint];
    if (motor.fault == MotorFault::stays_on) {
      found.joint = joint;
      found.fault = motor.fault;
      found.status = motor.status;
      return with(Trouble::motor_fault);
    }
    if (commands_.motors[joint].enabled == 0) continue;
    if (motor.enabled != 0) had_power_[joint] = true;
    const MotorJoint& own = params_.joints[joint];
    const bool powerless =
        motor.enabled == 0 && (had_power_[joint] || now_ns_ - wanted_since_ns_[joint] >= power_within_ns);
    const bool faulty = motor.fault != MotorFault::none && (had_power_[joint] || powerless);
    Trouble what = Trouble::none;
    const bool unheard = (faulty && motor.fault == MotorFault::lost_master) || (powerless && last_.unheard != 0);
    if (unheard || (faulty && motor.fault == MotorFault::not_responding)) {
      if (!std::exchange(silent, true)) found.joint = joint;
      found.fault = unheard ? MotorFault::lost_master : MotorFault::not_responding;
    } else if (faulty) {
      what = Trouble::motor_fault;
    } else if (!own.contains(reading_[joint].position_m)) {
      what = Trouble::position;
    } else if (!own.allows_speed(motor)) {
      what = Trouble::velocity;
    } else if (!own.allows_warmth(motor)) {
      what = Trouble::temperature;
    } else if (powerless) {
      what = Trouble::no_power;
    }
    if (what == Trouble::none) continue;
    found.joint = joint;
    found.fault = motor.fault;
    found.status = motor.status;
    return with(what);
  }
  if (silent) return with(Trouble::not_responding);
  return with(found.age_s > params_.late_s ? Trouble::late : Trouble::none);
}

void MotorBusDevice::judge(const DeviceTrouble& trouble) noexcept {
  trouble_ = trouble;
  switch (trouble_.what) {
    case Trouble::none:
      health_ = DeviceHealth::good;
      return;
    case Trouble::late:
      health_ = DeviceHealth::degraded;
      return;
    case Trouble::not_responding:
      health_ = DeviceHealth::not_responding;
      return;
    default:
      health_ = DeviceHealth::lost;
  }
}

void MotorBusDevice::write(const Joints<station::DeviceCommand>& command) noexcept {
  bool any = false;
  for (std::size_t joint = 0; joint < reading_.size(); ++joint) {
    MotorCommand& motor = commands_.motors[joint];
    const MotorJoint& own = params_.joints[joint];
    const bool wanted = command[joint].enabled && own.gives_force;
    if (wanted && motor.enabled == 0) {
      wanted_since_ns_[joint] = now_ns_;
      had_power_[joint] = false;
    }
    motor = own.motor_command(command[joint], reading_[joint], turns_rad_[joint]);
    motor.enabled = wanted ? 1 : 0;
    any = any || wanted;
  }
  if (!any && health_ >= DeviceHealth::not_responding) judge(found());
  commands_.time_ns = now_ns_;
  bus_->command(commands_);
}

}  // namespace tactus::devices
