#include <tactus/arm_control/arm_sites.hpp>
#include <tactus/experiments/arm_tapping/arm_pair.hpp>
#include <tactus/experiments/arm_tapping/described_arm.hpp>
#include <tactus/signal/decompositions.hpp>
#include <tactus/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace tactus::experiments {

using arm::JointVector;
using arm::Vector3;
using arm_plants::ArmDevice;
using arm_plants::ArmPlant;
using arm_plants::ToolForce;
using arm_plants::ToolState;

namespace {

int steps_in_a_tick(const ArmClockParams& clock) {
  return std::max(1, static_cast<int>(std::ceil(1.0 / (clock.rate_Hz * clock.plant_step_s) - 1e-9)));
}

Vector3 outward_of(TapDirection direction) {
  switch (direction) {
    case TapDirection::down:
      return Vector3::UnitZ();
    case TapDirection::along_x:
      return -Vector3::UnitX();
    case TapDirection::along_y:
      return -Vector3::UnitY();
  }
  return Vector3::UnitZ();
}

/// How slowly the tool moves at least, for one rad/s of all joints together: 0 where the pose is singular.
double slowest_m_per_rad(const arm::Chain& chain, const JointVector& position, const Vector3& tool_m) {
  const auto moving = chain.jacobian(position, chain.joints() - 1, tool_m).topRows<3>().eval();
  return std::sqrt(std::max(0.0, signal::symmetric_eigenvalues(moving * moving.transpose())[0]));
}

/// Puts the start of `setup` at the pose and the surface in the direction that its task asks for.
Check take_pose(ArmPairSetup& setup) {
  constexpr double within_rad = 0.6;
  constexpr double least_share = 0.75;
  setup.outward = outward_of(setup.params.task.direction);
  if (setup.params.task.pose == 0) return std::nullopt;
  const auto chain = arm::Chain::make(setup.arm.chain);
  if (!chain) return chain.error();
  const double least = least_share * slowest_m_per_rad(*chain, setup.start, setup.arm.tool_m);
  signal::Random random = signal::Random(0).fork(static_cast<std::uint64_t>(setup.params.task.pose));
  constexpr int most_draws = 1000;
  for (int draw = 0; draw < most_draws; ++draw) {
    JointVector drawn = setup.start;
    for (double& joint : drawn) joint += random.uniform(-within_rad, within_rad);
    if (slowest_m_per_rad(*chain, drawn, setup.arm.tool_m) < least) continue;
    setup.start = drawn;
    return std::nullopt;
  }
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "task.pose",
               .message = std::to_string(setup.params.task.pose) + ": of " + std::to_string(most_draws) +
                          " poses near start_rad none is as far from a singular one: begin nearer to one, or write 0",
               .place = {}};
}

}  // namespace

Result<ArmPairSetup> set_up_arm_pair(const ArmTappingParams& params, const std::filesystem::path& folder) {
  const auto described = describe_arm(params.arm, folder);
  if (!described) return described.error();
  const std::size_t joints = described->arm.motors.size();
  ArmPairSetup setup{
      .params = params, .joints = described->joints, .arm = described->arm, .induced = {}, .start = described->start};
  JointVector stiffness = setup.start;
  JointVector damping = setup.start;
  for (std::size_t i = 0; i < joints; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    stiffness[at] = setup.arm.motors[i].joint_stiffness_N_m_per_rad;
    damping[at] = setup.arm.motors[i].joint_damping_N_m_s_per_rad;
  }
  setup.induced = {.chain = setup.arm.chain,
                   .tool_m = setup.arm.tool_m,
                   .joint_stiffness_N_m_per_rad = stiffness,
                   .joint_damping_N_m_s_per_rad = damping};
  if (Check wrong = take_pose(setup)) return *std::move(wrong);
  setup.arm.step_s = 1.0 / (params.servo.rate_Hz * steps_in_a_tick(params.servo));
  return setup;
}

ArmPair::ArmPair(const ArmPairSetup& setup, ArmDevice leader, ArmDevice follower, arm_plants::Person person,
                 station::JointBarePair sites, double wall_m)
    : tick_s_(1.0 / setup.params.servo.rate_Hz),
      steps_(steps_in_a_tick(setup.params.servo)),
      step_s_(setup.arm.step_s),
      leader_(std::move(leader)),
      follower_(std::move(follower)),
      person_(std::move(person)),
      sites_(std::move(sites)),
      outward_(setup.outward),
      began_m_(follower_.plant().tool().position_m),
      wall_{.point_m = began_m_ + wall_m * outward_,
            .normal = outward_,
            .stiffness_N_per_m = setup.params.wall.stiffness_N_per_m,
            .damping_N_s_per_m = setup.params.wall.damping_N_s_per_m} {
  // As long before: both sites at rest, and their commands on the buses.
  station::JointBarePair at_rest = sites_;
  at_rest.step(leader_, follower_, {}, 1.0);
}

Result<ArmPair> ArmPair::make(const ArmPairSetup& setup, const arm_control::InducedMotion::Arm& induced,
                              const arm::HandImpedance& hand, double wall_m) {
  const ArmTappingParams& params = setup.params;
  const Seconds tick{1.0 / params.servo.rate_Hz};
  ArmPlant::Params held = setup.arm;
  held.carried_kg = params.person.hand.mass_kg;
  auto leader = ArmPlant::make(held, setup.start);
  if (!leader) return under("arm", leader.error());
  auto follower = ArmPlant::make(setup.arm, setup.start);
  if (!follower) return under("arm", follower.error());
  auto person = arm_plants::Person::make(params.person, tick, leader->tool());
  if (!person) return under("operator", person.error());
  const Joints<arm_control::DriveGains> gains = params.control.follower.gains.of(setup.arm.chain.joints.size());
  arm_control::ArmLeader::Params control = params.control;
  control.model.hand = hand;
  const std::size_t joints = setup.arm.chain.joints.size();
  const Joints<control::SafetyGate::Params> gates(joints, arm_control::widest_gate());
  auto leader_site =
      arm_control::leader_site(control, {.carried = setup.arm.chain, .induced = induced, .gains = gains}, gates, tick);
  if (!leader_site) return under("control", leader_site.error());
  arm_control::ArmFollower::Arm follows{.chain = setup.arm.chain,
                                        .tool_m = setup.arm.tool_m,
                                        .joint_stiffness_N_m_per_rad = induced.joint_stiffness_N_m_per_rad};
  if (params.control.method == arm_control::ArmMethod::four_channel) {
    follows.four_channel =
        arm_control::FourChannelCoupling{.params = params.control.four_channel, .gain = params.control.force_gain};
  }
  auto follower_site = arm_control::follower_site(params.control.follower, follows, gates, tick);
  if (!follower_site) return under("control.follower", follower_site.error());
  Joints<double> start(joints);
  for (std::size_t i = 0; i < joints; ++i) start[i] = setup.start[static_cast<Eigen::Index>(i)];
  auto sites = station::JointBarePair::around(*std::move(leader_site), *std::move(follower_site), {}, tick, start);
  if (!sites) return sites.error();
  const Joints<station::DeviceLimits> no_limits(joints);
  return ArmPair(setup, {*std::move(leader), no_limits}, {*std::move(follower), no_limits}, *std::move(person),
                 *std::move(sites), wall_m);
}

ArmRecord ArmPair::step(const Vector3& path_m, const Vector3& path_at_next_tick_m) {
  const ToolState at_leader = leader_.plant().tool();
  const ToolState at_follower = follower_.plant().tool();
  follower_.touches({.force_N = wall_.force_N(at_follower)});
  sites_.step(leader_, follower_, {.number = tick_++}, 1.0);
  person_.begin_tick(began_m_ + path_m, began_m_ + path_at_next_tick_m, at_leader);

  ArmRecord record{.hand_N = -person_.force(at_leader, 0.0).force_N.dot(outward_),
                   .leader_m = (at_leader.position_m - began_m_).dot(outward_),
                   .follower_m = (at_follower.position_m - began_m_).dot(outward_),
                   .tools_apart_m = (at_leader.position_m - at_follower.position_m).norm()};
  for (int i = 0; i < steps_; ++i) {
    leader_.step(person_.force(leader_.plant().tool(), i * step_s_));
    const ToolForce contact{.force_N = wall_.force_N(follower_.plant().tool())};
    record.contact_N += contact.force_N.dot(outward_) / steps_;
    follower_.step(contact);
  }
  return record;
}

bool ArmPair::healthy() const { return leader_.plant().healthy() && follower_.plant().healthy(); }

}  // namespace tactus::experiments
