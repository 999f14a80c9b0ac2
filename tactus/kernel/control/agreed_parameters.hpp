// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/agreement.hpp>
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/own_params.hpp>
#include <tactus/kernel/core/binding.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <optional>
#include <span>
#include <string>

namespace tactus::control {

/// The parameters that both sites must have in common before they arm, each under the key of an experiment file. They
/// are those with which both sites compute, and those on which an operator at one site relies at the other: limits and
/// time-outs. The groups of all architectures count, so both sites must have the same ones registered. What is not here
/// either concerns one site alone, as the master's model and filters and where the slave's force comes from, or the
/// host that it runs on, as the longest stall.
struct AgreedParams {
  std::string architecture;
  double rate_Hz = 0.0;
  double position_scale = 0.0;
  double force_gain = 0.0;
  double force_limit_N = 0.0;
  ServoPd::Params slave;
  SafetyGate::Params gate;
  ForceGate::Params handle_gate;
  SafetyGate::Params slave_gate;
  OwnParams groups;
  PacketJudgeParams packets;
  MessageFollower::Params silence;
  Watchdog::Params watchdog;
  double answer_within_s = 0.0;
  double blend_s = 0.0;
  static constexpr auto fields() {
    using P = AgreedParams;
    return List{
        field("control.architecture", &P::architecture, "Each site takes the other to be its half."),
        field("servo.rate_Hz", &P::rate_Hz, units::hertz, positive, "Control cycles per second, equal at both sites."),
        field("control.position_scale", &P::position_scale, units::none, positive, "The master commands by it."),
        field("control.force_gain", &P::force_gain, units::none, non_negative, "The master displays by it."),
        field("control.force_limit_N", &P::force_limit_N, units::newton, positive, "What the hand gets at most."),
        field("control.slave", &P::slave, "Both ends of a spring between the sites."),
        field("control.gate", &P::gate, "What the master's motor does at most."),
        field("control.handle_gate", &P::handle_gate, "What the actuator on the handle does at most."),
        field("control.slave_gate", &P::slave_gate, "What the slave's motor does at most."),
        field("control", &P::groups, "All that architectures have of their own."),
        field("control.supervision.packets", &P::packets, "What a site accepts of the other."),
        field("control.supervision.silence", &P::silence, "What a site does in silence."),
        field("control.supervision.watchdog", &P::watchdog, "When it holds."),
        field("control.supervision.answer_within_s", &P::answer_within_s, units::second, positive,
              "When an arming is given up."),
        field("control.supervision.blend_s", &P::blend_s, units::second, positive, "How a force comes and goes.")};
  }
};

/// What both sites of an experiment's `[control]` section must have in common, at a sample time. Allocates.
AgreedParams agreed_params(const ControlParams& params, Seconds dt);

/// Of values under keys, in order, groups left out: a cell for each, and four for a text. Allocates.
Agreement agreement_of(std::span<const Binding> values);
/// Of the `[control]` section of an experiment at a sample time. Allocates.
Agreement agreement_of(const ControlParams& params, Seconds dt);
/// Of all joints of a device: a cell for each, which holds the digest of what is agreed for it. So the first cell that
/// differs (`SiteRecord::differs`) is the number of the joint; `first_disagreement` is for one axis. Allocates.
Agreement agreement_of(const JointParams auto& params, Seconds dt);

/// One key with both values, as an operator writes them.
struct Disagreement {
  std::string key;
  std::string own;
  std::string other;
};

/// The first key in which the sites of `check` are known to differ; none where they agree, or where the other site
/// knows other keys, being of another build. Allocates.
std::optional<Disagreement> first_disagreement(const AgreementCheck& check);
/// The same where the own agreement is that of `values`.
std::optional<Disagreement> first_disagreement(const AgreementCheck& check, std::span<const Binding> values);

}  // namespace tactus::control
