#include <tactus/devices/motor_bus_device.hpp>

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
  }
  const DeviceHealth now = judge();
  if (health_ != DeviceHealth::lost) health_ = now;
  return reading_;
}

DeviceHealth MotorBusDevice::judge() noexcept {
  std::int64_t oldest_ns = now_ns_;
  for (std::size_t joint = 0; joint < reading_.size(); ++joint) {
    const MotorReading& motor = last_.motors[joint];
    oldest_ns = std::min(oldest_ns, motor.heard_ns);
    if (commands_.motors[joint].enabled == 0) continue;
    if (motor.enabled != 0) had_power_[joint] = true;
    if (!params_.joints[joint].allows(motor, reading_[joint].position_m)) return DeviceHealth::lost;
    const bool has_it = motor.enabled != 0 && motor.fault == MotorFault::none;
    const bool in_time = !had_power_[joint] && now_ns_ - wanted_since_ns_[joint] < power_within_ns;
    if (!has_it && !in_time) return DeviceHealth::lost;
  }
  const double age_s = 1e-9 * static_cast<double>(now_ns_ - oldest_ns);
  if (!bus_->running() || last_.state == BusState::refused || age_s > params_.silence_s) return DeviceHealth::lost;
  return age_s > params_.late_s ? DeviceHealth::degraded : DeviceHealth::good;
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
    motor = {.torque_Nm = own.motor_torque_Nm(command[joint].force_N), .enabled = wanted ? 1 : 0};
    any = any || wanted;
  }
  if (!any && health_ == DeviceHealth::lost) health_ = judge();
  commands_.time_ns = now_ns_;
  bus_->command(commands_);
}

}  // namespace tactus::devices
