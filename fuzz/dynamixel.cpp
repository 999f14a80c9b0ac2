// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/dynamixel/dynamixel_bus.hpp>
#include <tactus/hardware/emulation/dynamixel/dynamixel_peer.hpp>

#include "servo_conversation.hpp"

using namespace tactus;

/// What is said to three servos: a goal beyond the torque that is commanded is none.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // 0.015 N m of an XL330-M288: 0.52 / 1.47 N m/A, 1 mA a unit.
  static const fuzz::Conversation<devices::dynamixel::DynamixelBus, emulation::dynamixel::DynamixelPeer> begun{
      .bus = devices::dynamixel::DynamixelBus::make({.motors = {{.id = 1}, {.id = 2}, {.id = 3}}}).value(),
      .peer =
          emulation::dynamixel::DynamixelPeer::make({.servos = {{.id = 1}, {.id = 2}, {.id = 3}}, .line = {}}).value(),
      .goal = {.size = 14 + 3 * 3,
               .at = 12,
               .stride = 3,
               .instruction_at = 7,
               .instruction = 0x83,
               .address_at = 8,
               .address = 102,
               .most = 42,
               .sign_bit = false}};
  fuzz::converse(begun, {data, size});
  return 0;
}
