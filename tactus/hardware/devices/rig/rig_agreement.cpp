// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/rig_agreement.hpp>
#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/kernel/core/binding.hpp>

#include <bit>
#include <cstdint>
#include <utility>
#include <variant>
#include <vector>

namespace tactus::devices {

namespace {

constexpr const char* remedy = "start both with the same experiment, the same --set and the same joints";

/// Of both arms' sites.
struct AgreedArms {
  std::string leader, follower;  ///< digests of what is believed of the arms
  station::ToolPoint leader_tool, follower_tool;
  double rate_Hz = 0.0;
  station::ArmControlParams control;
  control::SafetyGate::Params leader_gate, follower_gate;
  station::GripperParams gripper;
  control::PacketJudgeParams packets;
  control::MessageFollower::Params silence;
  control::Watchdog::Params watchdog;
  double answer_within_s = 0.0, blend_s = 0.0;
  static constexpr auto fields() {
    using P = AgreedArms;
    return List{
        field("arm", &P::leader, "Dynamics of the leader."),
        field("arm.follower", &P::follower, "The same of the follower."),
        field("arm.tool", &P::leader_tool, "Where the leader's hand is."),
        field("arm.follower.tool", &P::follower_tool, "Where the follower touches."),
        field("servo.rate_Hz", &P::rate_Hz, units::hertz, positive, "Control cycles per second, equal at both sites."),
        field("control", &P::control, "Each site takes the other to be its half."),
        field("rig.leader_gate", &P::leader_gate, "What the leader's motors do at most."),
        field("rig.follower_gate", &P::follower_gate, "What the follower's motors do at most."),
        field("rig.gripper", &P::gripper, "Both ends of a spring between the sites."),
        field("rig.supervision.packets", &P::packets, "What a site accepts of the other."),
        field("rig.supervision.silence", &P::silence, "What a site does in silence."),
        field("rig.supervision.watchdog", &P::watchdog, "When it holds."),
        field("rig.supervision.answer_within_s", &P::answer_within_s, units::second, positive,
              "When an arming is given up."),
        field("rig.supervision.blend_s", &P::blend_s, units::second, positive, "How a force comes and goes.")};
  }
};

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

/// The bindings point into the rest.
struct RigAgreement::Values {
  std::string kind;
  std::vector<std::string> joints;
  std::variant<control::AgreedParams, AgreedArms> params;
  std::vector<Binding> all;

  Values(std::string kind_, const RigSide& side, std::variant<control::AgreedParams, AgreedArms> params_)
      : kind(std::move(kind_)), params(std::move(params_)) {
    for (const RigJoint& joint : side.joints) {
      joints.push_back(std::string(joint.name()) + " in " + joint.words().position_unit);
    }
    const auto add = [this](std::string path, std::string& text) {
      all.push_back({.path = std::move(path), .unit = {}, .bounds = {}, .doc = {}, .target = &text});
    };
    add("task.kind", kind);
    for (std::size_t i = 0; i < joints.size(); ++i) add("joint " + std::to_string(i + 1) + " of the rig", joints[i]);
    std::visit([this](auto& agreed) { append_bindings(agreed, {}, all); }, params);
  }
  Values(const Values&) = delete;
  Values& operator=(const Values&) = delete;
  ~Values() = default;
};

RigAgreement RigAgreement::of(const RigSide& side, const control::ControlParams& control, Seconds tick) {
  return RigAgreement(std::make_shared<const Values>("tapping", side, control::agreed_params(control, tick)));
}

RigAgreement RigAgreement::of(const RigSide& side, const station::ArmTeleoperatorParams& params,
                              const station::DescribedArms& arms) {
  const station::ArmRigParams& rig = params.rig;
  const station::ArmPairParams& pair = params.arm;
  return RigAgreement(
      std::make_shared<const Values>("arm-tapping", side,
                                     AgreedArms{.leader = digest_of(arms.leader.arm.chain),
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
                                                .blend_s = rig.supervision.blend_s}));
}

control::Agreement RigAgreement::agreement() const { return control::agreement_of(values_->all); }

std::string RigAgreement::describe(const runtime::SiteMismatch& mismatch, control::SiteRole role) const {
  const auto found = control::first_disagreement(mismatch.agreement, values_->all);
  return runtime::describe(mismatch, role, found ? &*found : nullptr, remedy);
}

}  // namespace tactus::devices
