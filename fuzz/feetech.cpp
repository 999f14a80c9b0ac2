// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/feetech/feetech_bus.hpp>
#include <tactus/hardware/emulation/feetech/feetech_peer.hpp>

#include "servo_conversation.hpp"

using namespace tactus;

/// What is said to two servos: a goal beyond the torque that is commanded is none.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using devices::feetech::FeetechModel;
  // 0.015 N m at 0.8 N m/A, 6.5 mA a unit.
  static const fuzz::Conversation<devices::feetech::FeetechBus, emulation::feetech::FeetechPeer> begun{
      .bus = devices::feetech::FeetechBus::make(
                 {.motors = {{.id = 1, .model = FeetechModel::hls3625, .torque_Nm_per_A = 0.8},
                             {.id = 2, .model = FeetechModel::hls3625, .torque_Nm_per_A = 0.8}}})
                 .value(),
      .peer = emulation::feetech::FeetechPeer::make({.line = {}}).value(),
      .goal = {.size = 8 + 2 * 3,
               .at = 7,
               .stride = 3,
               .instruction_at = 4,
               .instruction = 0x83,
               .address_at = 5,
               .address = 44,
               .most = 3,
               .sign_bit = true}};
  fuzz::converse(begun, {data, size});
  return 0;
}
