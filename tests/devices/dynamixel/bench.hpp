// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/dynamixel/dynamixel_bus.hpp>
#include <tactus/hardware/emulation/dynamixel/dynamixel_peer.hpp>
#include <tactus/hardware/wire/join.hpp>
#include <tactus/hardware/wire/paced.hpp>

#include <cstdint>
#include <memory>

/// The driver joined to its peer in virtual time, over a line that takes the time that a real one takes.
namespace tactus::devices::dynamixel::bus_test {

using emulation::LineFaults;
using emulation::ServoFault;
using emulation::dynamixel::DynamixelPeer;
using wire::Paced;

inline constexpr std::int64_t ms = 1'000'000;
inline constexpr std::int64_t second = 1000 * ms;

struct Setting {
  std::size_t servos = 7;
  std::int64_t bits_per_s = 1'000'000;
  bool fast = true;
  LineFaults line{};
  std::int64_t seed = 1;
  ServoFault fault = ServoFault::none;  ///< of the servo `faulty`
  std::size_t faulty = 2;
  std::int64_t fault_from_ns = 0;
  bool knows_fast = true;
};

/// XL330-M288, of which a current of 100 is 0.1 A and 0.52 / 1.47 N m/A.
inline constexpr double torque_of_one_Nm = 0.001 * 0.52 / 1.47;

struct Rig {
  explicit Rig(const Setting& setting) : peer(peer_of(setting)), bus(bus_of(setting)) {
    line = std::make_unique<Paced>(peer, wire::byte_ns(setting.bits_per_s), Paced::Line::half_duplex);
  }
  static DynamixelPeer peer_of(const Setting& setting) {
    DynamixelPeer::Params params;
    params.servos.clear();
    for (std::size_t i = 0; i < setting.servos; ++i) {
      DynamixelPeer::Servo servo{.id = static_cast<std::int64_t>(i + 1)};
      if (i == setting.faulty) servo.fault = setting.fault;
      servo.fault_from_ns = setting.fault_from_ns;
      params.servos.push_back(servo);
    }
    params.bits_per_s = setting.bits_per_s;
    params.line = setting.line;
    params.seed = setting.seed;
    params.knows_fast_sync_read = setting.knows_fast;
    return DynamixelPeer::make(params).value();
  }
  static DynamixelBus bus_of(const Setting& setting) {
    DynamixelBus::Params params;
    for (std::size_t i = 0; i < setting.servos; ++i) params.motors.push_back({.id = static_cast<std::int64_t>(i + 1)});
    params.bits_per_s = setting.bits_per_s;
    params.fast_sync_read = setting.fast;
    return DynamixelBus::make(params).value();
  }
  void run(std::int64_t duration_ns) {
    wire::join(bus, *line, now_ns, now_ns + duration_ns);
    now_ns += duration_ns;
    peer.advance(now_ns);
  }
  void command_all(double torque_Nm, std::int64_t enabled) {
    for (std::size_t i = 0; i < bus.motors(); ++i) bus.command(i, {.torque_Nm = torque_Nm, .enabled = enabled});
  }
  std::int64_t goal(std::size_t servo) const { return static_cast<std::int16_t>(peer.stored(servo, 102, 2)); }
  bool torque_on(std::size_t servo) const { return peer.stored(servo, 64, 1) != 0; }

  DynamixelPeer peer;
  DynamixelBus bus;
  std::unique_ptr<Paced> line;
  std::int64_t now_ns = 0;
};

/// The page's table, and the same arithmetic for seven: bits of write, read and answers.
inline double most_cycles_per_s(std::size_t servos, std::int64_t bits_per_s, bool fast) {
  const std::size_t write = 14 + 3 * servos, read = 14 + servos;
  const std::size_t answers = fast ? 8 + 14 * servos : 21 * servos;
  return static_cast<double>(bits_per_s) / (10.0 * static_cast<double>(write + read + answers));
}

}  // namespace tactus::devices::dynamixel::bus_test
