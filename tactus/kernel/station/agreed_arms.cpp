// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/agreement.hpp>
#include <tactus/kernel/core/binding.hpp>
#include <tactus/kernel/station/agreed_arms.hpp>

#include <bit>
#include <cstdint>
#include <variant>

namespace tactus::station {

namespace {

/// Of the dynamics of an arm, in 16 hexadecimal digits.
std::string digest_of(arm::Chain::Params chain) {
  control::Agreement all;
  for (auto& joint : chain.joints) {
    for (const Binding& binding : bind(joint)) {
      if (const auto* number = std::get_if<double*>(&binding.target)) {
        all.add(binding.path, std::bit_cast<std::uint64_t>(**number));
      }
    }
  }
  std::string text;
  for (int bits = 60; bits >= 0; bits -= 4) text += "0123456789abcdef"[all.digest() >> bits & 0xf];
  return text;
}

}  // namespace

AgreedArms agreed_arms(const ArmTeleoperatorParams& params, const DescribedArms& arms) {
  const ArmRigParams& rig = params.rig;
  const ArmPairParams& pair = params.arm;
  return {.leader = digest_of(arms.leader.arm.chain),
          .follower = digest_of(arms.follower.arm.chain),
          .leader_tool = pair.tool,
          .follower_tool = differs(pair) ? pair.follower.tool : pair.tool,
          .rate_Hz = params.servo.rate_Hz,
          .control = params.control,
          .leader_gate = rig.leader_gate,
          .follower_gate = rig.follower_gate,
          .gripper = rig.gripper,
          .packets = rig.supervision.packets,
          .silence = rig.supervision.silence,
          .watchdog = rig.supervision.watchdog,
          .answer_within_s = rig.supervision.answer_within_s,
          .blend_s = rig.supervision.blend_s};
}

}  // namespace tactus::station
