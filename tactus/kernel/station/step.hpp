// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/station/device.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>

namespace tactus::station {

/// What the tick asks of what it drives. A `Device` is such, and so is a plant in virtual time.
template <class D>
concept Drivable = requires(D& device, const Tick& tick,
                            const Each<decltype(device.read(tick)), DeviceCommand>& command) {
  requires std::same_as<JointOf<decltype(device.read(tick))>, DeviceReading>;
  { device.read(tick) }
  noexcept;
  { device.write(command) }
  noexcept;
};

/// A site that takes packets and is asked things by an operator. One without supervision receives messages, and is
/// given which share of its controller's force to let in.
template <class Site>
concept Supervised = requires(Site& site, const typename Site::Packet& packet) {
  { site.take(packet) }
  noexcept;
};

/// What one tick of a site showed.
template <class Site>
struct Step {
  Each<typename Site::Sensors, DeviceReading> reading;
  DeviceHealth health = DeviceHealth::good;
  typename Site::Output output;
};

inline void put(const DeviceReading& reading, control::MasterInput& sensors) noexcept {
  sensors.motor_position_m = reading.position_m;
  sensors.motor_age_s = reading.age_s;
  sensors.motor_report = reading.motor_report;
  sensors.hand_force_N = reading.force_N;
  sensors.grip = reading.grip;
}
inline void put(const DeviceReading& reading, control::SlaveInput& sensors) noexcept {
  sensors.motor_position_m = reading.position_m;
  sensors.motor_age_s = reading.age_s;
  sensors.motor_report = reading.motor_report;
  sensors.tip_force_N = reading.force_N;
}
inline DeviceCommand command_of(const control::MasterOutput& output, bool enabled = true) noexcept {
  return {
      .force_N = output.motor_force_N, .handle_force_N = output.handle_force_N, .enabled = enabled, .law = output.law};
}
inline DeviceCommand command_of(const control::SlaveOutput& output, bool enabled = true) noexcept {
  return {.force_N = output.motor_force_N, .handle_force_N = 0.0, .enabled = enabled, .law = output.law};
}

template <class Output>
Joints<DeviceCommand> command_of(const Joints<Output>& output, bool enabled = true) noexcept {
  Joints<DeviceCommand> command(output.size());
  for_each_joint([enabled](DeviceCommand& to, const Output& joint) noexcept { to = command_of(joint, enabled); },
                 command, output);
  return command;
}

/// What the device reads, and its health. Of a device that is lost no position is a number, so that its site releases
/// its force; nor of one that does not respond, where no supervision could make its site hold.
template <class Site, Drivable Device>
auto read(Device& device, const Tick& tick, DeviceHealth& health) noexcept {
  auto reading = device.read(tick);
  if constexpr (requires { device.health(); }) health = device.health();
  const bool trusted = health < (Supervised<Site> ? DeviceHealth::lost : DeviceHealth::not_responding);
  if (trusted) return reading;
  for_each_joint([](DeviceReading& joint) noexcept { joint.position_m = std::numeric_limits<double>::quiet_NaN(); },
                 reading);
  return reading;
}

/// Runs one control cycle of a site. Every run mode, real-time or simulated, calls this function:
/// device → received packets → site, its gate last → device → transport.
///
/// A way of a supervised site has `receive(tick, take)`, which hands each packet that has come to `take`, and
/// `send(packet, tick)`; one of a site without supervision has `hear(sensors)`, which puts what has come there, and
/// `send(message)`. `request` is what the operator presses, or the share of the force. Real-time safe as far as device
/// and way are.
template <class Site, Drivable Device, class Transport>
Step<Site> step(Site& site, Device& device, Transport& transport, const Tick& tick,
                const typename Site::Request& request) noexcept {
  DeviceHealth health = DeviceHealth::good;
  const auto readings = read<Site>(device, tick, health);
  using Sensors = typename Site::Sensors;
  Sensors sensors = same_for_each(readings, JointOf<Sensors>{});
  for_each_joint([](const DeviceReading& reading, JointOf<Sensors>& joint) noexcept { put(reading, joint); }, readings,
                 sensors);
  const std::int64_t elapsed_ticks = tick.missed + 1;
  // The output is made where it is returned: to copy it as soon as it is written costs a tenth of a bare tick.
  if constexpr (Supervised<Site>) {
    transport.receive(tick, [&site](const typename Site::Packet& packet) noexcept { return site.take(packet); });
    Step<Site> done{.reading = readings,
                    .health = health,
                    .output = site.step({.sensors = sensors,
                                         .requests = request,
                                         .elapsed_ticks = elapsed_ticks,
                                         .device_silent = health == DeviceHealth::not_responding})};
    device.write(command_of(done.output.site, done.output.record.enabled));
    transport.send(done.output.packet, tick);
    return done;
  } else {
    transport.hear(sensors);
    Step<Site> done{.reading = readings, .health = health, .output = site.step(sensors, request, elapsed_ticks)};
    device.write(command_of(done.output));
    transport.send(member_of_each(done.output, &JointOf<typename Site::Output>::message));
    return done;
  }
}

}  // namespace tactus::station
