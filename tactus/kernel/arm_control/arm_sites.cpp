// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/arm_sites.hpp>

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace tactus::arm_control {
namespace {

using control::DriveLaw;
using control::MasterInput;
using control::MasterOutput;
using control::SlaveInput;
using control::SlaveOutput;

/// One number of each of the arm's joints, of a member of a member.
template <class Input, class Get>
JointVector each(const Joints<Input>& joints, std::size_t of_arm, Get&& get) noexcept {
  JointVector found(static_cast<Eigen::Index>(of_arm));
  for (std::size_t i = 0; i < of_arm; ++i) found[static_cast<Eigen::Index>(i)] = get(joints[i]);
  return found;
}

template <class Input>
ArmReading reading_of(const Joints<Input>& input, std::size_t of_arm) noexcept {
  return {.position = each(input, of_arm, [](const Input& joint) { return joint.motor_position_m; }),
          .velocity = each(input, of_arm, [](const Input& joint) { return joint.motor_report.velocity_m_per_s; }),
          .torque = each(input, of_arm, [](const Input& joint) { return joint.motor_report.force_N; })};
}

/// What a joint tells as force resists it, and so has the other sign than the torque that turns it up.
template <class Input>
ArmMessage message_of(const Joints<Input>& input, std::size_t of_arm) noexcept {
  return {.position = each(input, of_arm, [](const Input& joint) { return joint.arrival.message.position_m; }),
          .velocity = each(input, of_arm, [](const Input& joint) { return joint.arrival.message.velocity_m_per_s; }),
          .external_torque = each(input, of_arm, [](const Input& joint) { return -joint.arrival.message.force_N; }),
          .energy_J = each(input, of_arm, [](const Input& joint) { return joint.arrival.message.energy_J; })};
}

template <class Output>
void put(const ArmCommand& command, const JointVector& support, const ArmMessage& message,
         Joints<Output>& output) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(support.size()); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    Output& joint = output[i];
    joint.motor_force_N = command.torque[at];
    joint.support_N = support[at];
    joint.law = {.position_m = command.position[at],
                 .velocity_m_per_s = command.velocity[at],
                 .stiffness_N_per_m = command.stiffness[at],
                 .damping_N_s_per_m = command.damping[at]};
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(message.position.size()); ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    Output& joint = output[i];
    joint.message.position_m = message.position[at];
    joint.message.velocity_m_per_s = message.velocity[at];
    joint.message.force_N = -message.external_torque[at];
    if (message.energy_J.size() > 0) joint.message.energy_J = message.energy_J[at];
  }
}

/// The joints behind the arm's, each pulled to the other side's.
template <class Input, class Output>
void put_beside(const Joints<DriveGains>& beside, const Joints<Input>& input, Joints<Output>& output) noexcept {
  for (std::size_t i = 0; i < beside.size(); ++i) {
    const std::size_t at = input.size() - beside.size() + i;
    const control::Message& other = input[at].arrival.message;
    output[at].law = {.position_m = other.position_m,
                      .velocity_m_per_s = other.velocity_m_per_s,
                      .stiffness_N_per_m = beside[i].stiffness_N_m_per_rad,
                      .damping_N_s_per_m = beside[i].damping_N_m_s_per_rad};
    output[at].message.position_m = input[at].motor_position_m;
    output[at].message.velocity_m_per_s = input[at].motor_report.velocity_m_per_s;
  }
}

/// A controller of all joints. Not an element: what an arm's model holds is not trivially copyable.
template <class Input, class Output, class Controlled>
class ControllerOfArm final : public control::SiteController<Joints<Input>, Joints<Output>> {
 public:
  ControllerOfArm(const Controlled& made, std::size_t of_arm, const Joints<DriveGains>& beside)
      : made_(made), now_(made), of_arm_(of_arm), beside_(beside) {}
  Joints<Output> respond(const Joints<Input>& input) noexcept override;
  void applied([[maybe_unused]] Joints<double> motor_force_N) noexcept override {
    if constexpr (requires { now_.applied(JointVector()); }) {
      now_.applied(each(motor_force_N, of_arm_, [](double force_N) { return force_N; }));
    }
  }
  void reset() noexcept override { now_.continue_as(made_); }
  [[nodiscard]] std::optional<double> force_gain() const noexcept override {
    if constexpr (requires { now_.force_gain(); }) {
      return now_.force_gain();
    } else {
      return std::nullopt;
    }
  }
  void set_force_gain(double gain) noexcept override {
    if constexpr (requires { now_.set_force_gain(gain); }) now_.set_force_gain(gain);
  }
  bool begin_tare() noexcept override {
    now_.tare().begin();
    return true;
  }
  void stop_tare() noexcept override { now_.tare().stop(); }
  [[nodiscard]] control::TareReport tare() const noexcept override { return now_.tare().report(); }
  [[nodiscard]] Joints<double> tared_N(const Joints<double>& joints) const noexcept override {
    Joints<double> tared = same_for_each(joints, 0.0);
    for (std::size_t i = 0; i < of_arm_; ++i) tared[i] = now_.tare().found_N_m()[static_cast<Eigen::Index>(i)];
    return tared;
  }
  [[nodiscard]] std::unique_ptr<control::SiteController<Joints<Input>, Joints<Output>>> clone() const override {
    return std::make_unique<ControllerOfArm>(*this);
  }

 private:
  Controlled made_;
  Controlled now_;
  std::size_t of_arm_;
  Joints<DriveGains> beside_;
};

using LeaderController = ControllerOfArm<MasterInput, MasterOutput, ArmLeader>;
using FollowerController = ControllerOfArm<SlaveInput, SlaveOutput, ArmFollower>;

template <>
Joints<MasterOutput> LeaderController::respond(const Joints<MasterInput>& input) noexcept {
  const auto arm = now_.step(reading_of(input, of_arm_), message_of(input, of_arm_));
  Joints<MasterOutput> output(input.size());
  put(arm.command, arm.support, arm.message, output);
  put_beside(beside_, input, output);
  for (std::size_t i = 0; i < of_arm_; ++i) {
    output[i].induced_position_m = arm.induced[static_cast<Eigen::Index>(i)];
    output[i].intended_position_m = input[i].motor_position_m - output[i].induced_position_m;
  }
  return output;
}

template <>
Joints<SlaveOutput> FollowerController::respond(const Joints<SlaveInput>& input) noexcept {
  const JointVector sensed = each(input, of_arm_, [](const SlaveInput& joint) { return -joint.tip_force_N; });
  const auto arm = now_.step(reading_of(input, of_arm_), sensed, message_of(input, of_arm_));
  Joints<SlaveOutput> output(input.size());
  put(arm.command, arm.support, arm.message, output);
  put_beside(beside_, input, output);
  return output;
}

template <class Site, class Controller, class Controlled>
Result<Site> site_of(const Controlled& controlled, std::size_t of_arm, const Joints<DriveGains>& beside,
                     const Joints<control::SafetyGate::Params>& gates, Seconds dt) {
  const std::size_t joints = of_arm + beside.size();
  if (gates.size() != joints || joints > most_joints) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "gate",
                 .message = std::to_string(gates.size()) + " gates for " + std::to_string(joints) +
                            " joints: state one for each, of " + std::to_string(most_joints) + " at most",
                 .place = {}};
  }
  const auto made = make_each<control::SafetyGate>(gates, dt);
  if (!made) return under("gate", made.error());
  typename Site::Gates before_each(made->size(), (*made)[0]);
  for (std::size_t i = 0; i < made->size(); ++i) before_each[i] = (*made)[i];
  return Site(std::make_unique<Controller>(controlled, of_arm, beside), before_each);
}

}  // namespace

control::SafetyGate::Params widest_gate() {
  control::SafetyGate::Params gate;
  gate.force_limit_N = 100.0;
  gate.rate_limit_N_per_s = 1e6;
  gate.velocity_limit_m_per_s = 100.0;
  gate.encoder.frozen_force_N = 200.0;
  gate.energy = {.damp_above_J = 100.0, .hold_above_J = 200.0, .credit_J = 100.0, .drain_W = 50.0};
  return gate;
}

Result<control::JointMasterSite> leader_site(const ArmLeader::Params& params, const ArmLeader::Arm& arm,
                                             const Joints<control::SafetyGate::Params>& gates, Seconds dt,
                                             const Joints<DriveGains>& beside) {
  const auto leader = ArmLeader::make(params, arm, dt);
  if (!leader) return leader.error();
  return site_of<control::JointMasterSite, LeaderController>(*leader, arm.carried.joints.size(), beside, gates, dt);
}

Result<control::JointSlaveSite> follower_site(const ArmFollower::Params& params, const ArmFollower::Arm& arm,
                                              const Joints<control::SafetyGate::Params>& gates, Seconds dt,
                                              const Joints<DriveGains>& beside) {
  const auto follower = ArmFollower::make(params, arm, dt);
  if (!follower) return follower.error();
  return site_of<control::JointSlaveSite, FollowerController>(*follower, arm.chain.joints.size(), beside, gates, dt);
}

}  // namespace tactus::arm_control
