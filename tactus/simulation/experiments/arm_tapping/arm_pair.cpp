// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/arm_sites.hpp>
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/random.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>

#include <Eigen/Cholesky>

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

using MovesTool = Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::ColMajor, 3, arm::most>;

/// The part of the Jacobian that moves the tool's point.
MovesTool moves_tool(const arm::Chain& chain, const JointVector& position, const Vector3& tool_m) {
  return chain.jacobian(position, chain.joints() - 1, tool_m).topRows<3>();
}

Vector3 tool_at(const arm::Chain& chain, const JointVector& position, const Vector3& tool_m) {
  const arm::LinkPose last = chain.poses(position)[static_cast<std::size_t>(chain.joints() - 1)];
  return last.rotation * tool_m + last.position_m;
}

/// The force at the tool whose torques are nearest to these, by least squares; what no force at the tool does is left
/// out.
Vector3 force_nearest_to(const MovesTool& moves, const JointVector& torque) {
  // A singular pose moves the tool nowhere along some axis: nothing of the torque is seen there.
  constexpr double least_m2 = 1e-9;
  const arm::Matrix3 squared = moves * moves.transpose() + least_m2 * arm::Matrix3::Identity();
  return squared.ldlt().solve(moves * torque);
}

/// How slowly the tool moves at least, for one rad/s of all joints together: 0 where the pose is singular.
double slowest_m_per_rad(const arm::Chain& chain, const JointVector& position, const Vector3& tool_m) {
  const MovesTool moving = moves_tool(chain, position, tool_m);
  return std::sqrt(std::max(0.0, signal::symmetric_eigenvalues(moving * moving.transpose())[0]));
}

/// The same of an arm as it is described, where its chain is sound.
double slowest_m_per_rad(const DescribedArm& of, const JointVector& position) {
  return slowest_m_per_rad(*arm::Chain::make(of.arm.chain), position, of.arm.tool_m);
}

bool leads_joints(const ArmTappingParams& params) {
  return params.control.follower.coupling == arm_control::Coupling::joints;
}

/// Puts the start of `setup` at the pose and the surface in the direction that its task asks for.
Check take_pose(ArmPairSetup& setup) {
  constexpr double within_rad = 0.6;
  constexpr double least_share = 0.75;
  setup.outward = outward_of(setup.params.task.direction);
  if (setup.params.task.pose == 0) return std::nullopt;
  const bool by_joints = leads_joints(setup.params);
  const auto far_from_singular = [&](const DescribedArm& of, const JointVector& position) {
    return slowest_m_per_rad(of, position) >= least_share * slowest_m_per_rad(of, of.start);
  };
  signal::Random random = signal::Random(0).fork(static_cast<std::uint64_t>(setup.params.task.pose));
  constexpr int most_draws = 1000;
  for (int draw = 0; draw < most_draws; ++draw) {
    JointVector drawn = setup.follower.start;
    for (double& joint : drawn) joint += random.uniform(-within_rad, within_rad);
    if (by_joints && !far_from_singular(setup.leader, drawn)) continue;
    if (!far_from_singular(setup.follower, drawn)) continue;
    setup.follower.start = drawn;
    if (by_joints) setup.leader.start = drawn;
    return std::nullopt;
  }
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "task.pose",
               .message = std::to_string(setup.params.task.pose) + ": of " + std::to_string(most_draws) +
                          " poses near start_rad none is as far from a singular one: begin nearer to one, or write 0",
               .place = {}};
}

/// `ArmPairSetup::tool_scale` of arms that differ: the leader's tool goes outward and keeps its attitude, by the least
/// motion of its joints.
Result<double> tool_scale(const ArmPairSetup& setup) {
  const auto jacobian = [&](const DescribedArm& of) {
    const arm::Chain chain = *arm::Chain::make(of.arm.chain);
    return chain.jacobian(of.start, chain.joints() - 1, of.arm.tool_m);
  };
  constexpr double singular = 1e-6;  // below this, squared, a motion of the leader's tool is left out
  const arm::Jacobian leader = jacobian(setup.leader);
  Eigen::Matrix<double, 6, 1> outward = Eigen::Matrix<double, 6, 1>::Zero();
  outward.head<3>() = setup.outward;
  const Eigen::MatrixXd moves = leader * leader.transpose() + singular * Eigen::Matrix<double, 6, 6>::Identity();
  const Vector3 follows =
      (jacobian(setup.follower) * (leader.transpose() * signal::solve_definite(moves, outward))).head<3>();
  const double along = follows.dot(setup.outward);
  const double aside = (follows - along * setup.outward).norm();
  if (along > 0.0 && aside <= along) return along;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "arm.follower.urdf",
               .message = "as the leader's tool goes to the surface, the follower's goes at " +
                          std::to_string(std::lround(std::atan2(aside, along) * 180.0 / std::numbers::pi)) +
                          " degrees from there, and at most 45 do: both arms need the same zero and sense of each "
                          "joint and bases turned alike, and a start_rad at which neither arm is stretched",
               .place = {}};
}

/// Refuses an arm whose motors cannot bear what it weighs where it starts.
Check check_weight(const DescribedArm& of, const char* key) {
  const JointVector weight = arm::Chain::make(of.arm.chain)->gravity_torque(of.start);
  for (Eigen::Index i = 0; i < weight.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const double most_N_m = of.arm.chain.joints[at].limits.effort_N_m;
    if (std::fabs(weight[i]) <= most_N_m) continue;
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = key,
                 .message = "joint '" + of.joints[at] + "' bears " + rounded_number(std::fabs(weight[i])) +
                            " N m of the arm's own weight where it starts, beyond its effort limit of " +
                            rounded_number(most_N_m) + " N m in " + of.urdf +
                            ": correct effort or the masses there, or start elsewhere (start_rad)",
                 .place = {}};
  }
  return std::nullopt;
}

}  // namespace

Result<ArmPairSetup> set_up_arm_pair(const ArmTappingParams& params, const std::filesystem::path& folder) {
  return set_up_arm_pair(params, urdf::urdfs_below(folder));
}

Result<ArmPairSetup> set_up_arm_pair(const ArmTappingParams& params, const urdf::Urdfs& urdfs) {
  auto described = urdf::describe_arms(params, urdfs);
  if (!described) return described.error();
  ArmPairSetup setup{*std::move(described), params};
  for (DescribedArm* arm : {&setup.leader, &setup.follower}) {
    arm->arm.step_s = 1.0 / (params.servo.rate_Hz * steps_in_a_tick(params.servo));
  }
  if (Check wrong = check_weight(setup.leader, "arm.urdf")) return *std::move(wrong);
  if (Check wrong = check_weight(setup.follower, "arm.follower.urdf")) return *std::move(wrong);
  if (Check wrong = take_pose(setup)) return *std::move(wrong);
  if (!leads_joints(params)) {
    setup.tool_scale = params.control.follower.tool_scale;
  } else if (station::differs(params.arm)) {
    const auto scale = tool_scale(setup);
    if (!scale) return scale.error();
    setup.tool_scale = *scale;
  }
  return setup;
}

ArmPair::ArmPair(const ArmPairSetup& setup, const arm::Chain& leader_chain, ArmDevice leader, ArmDevice follower,
                 const std::optional<arm::Chain>& other_follower, arm_plants::ToolOperator person,
                 station::JointBarePair sites, double wall_m, const mechanics::Environment& contact)
    : tick_s_(1.0 / setup.params.servo.rate_Hz),
      steps_(steps_in_a_tick(setup.params.servo)),
      step_s_(setup.leader.arm.step_s),
      leader_(std::move(leader)),
      follower_(std::move(follower)),
      person_(std::move(person)),
      sites_(std::move(sites)),
      leader_chain_(leader_chain),
      leader_tool_m_(setup.leader.arm.tool_m),
      outward_(setup.outward),
      tool_scale_(setup.tool_scale),
      leader_began_m_(leader_.plant().tool().position_m),
      follower_began_m_(follower_.plant().tool().position_m),
      other_follower_(other_follower),
      leads_joints_(leads_joints(setup.params)),
      follower_tool_m_(setup.follower.arm.tool_m),
      wall_{.point_m = follower_began_m_ + wall_m * outward_, .normal = outward_, .contact = contact} {
  // As long before: both sites at rest, and their commands on the buses.
  station::JointBarePair at_rest = sites_;
  latest_ = at_rest.step(leader_, follower_, {}, 1.0);
}

Result<station::JointBarePair> bare_arm_sites(const ArmPairSetup& setup, const ArmModelParams& model_params) {
  const ArmTappingParams& params = setup.params;
  const ArmPlant::Params &leads = setup.leader.arm, &follows = setup.follower.arm;
  const Seconds tick{1.0 / params.servo.rate_Hz};
  const std::size_t joints = leads.chain.joints.size();
  arm_control::ArmLeader::Params control = params.control;
  control.model.hand = model_params.hand;
  const Joints<control::SafetyGate::Params> gates(joints, arm_control::widest_gate());
  const Joints<control::SafetyGate::Params> follower_gates(follows.chain.joints.size(), arm_control::widest_gate());
  auto leader_site = arm_control::leader_site(control,
                                              {.carried = model_params.leader,
                                               .induced = model_params.induced,
                                               .gains = params.control.follower.gains.of(joints),
                                               .lacking_N_m = model_params.leader_lacking_N_m},
                                              gates, tick);
  if (!leader_site) return under("control", leader_site.error());
  arm_control::ArmFollower::Arm known{.chain = model_params.follower,
                                      .tool_m = follows.tool_m,
                                      .joint_stiffness_N_m_per_rad = model_params.follower_joint_stiffness_N_m_per_rad,
                                      .passivity = {params.control.passivity, params.control.force_gain},
                                      .lacking_N_m = model_params.follower_lacking_N_m};
  if (params.control.method == arm_control::ArmMethod::four_channel) {
    known.four_channel =
        arm_control::FourChannelCoupling{.params = params.control.four_channel, .gain = params.control.force_gain};
  }
  if (!leads_joints(params)) {
    const auto axes = arm_control::ToolCoupling::axes_of(leads.chain);
    if (!axes) return under("arm", axes.error());
    known.leader_axes = *axes;
  }
  auto follower_site = arm_control::follower_site(params.control.follower, known, follower_gates, tick);
  if (!follower_site) return under("control.follower", follower_site.error());
  Joints<double> start(joints);
  for (std::size_t i = 0; i < joints; ++i) start[i] = setup.leader.start[static_cast<Eigen::Index>(i)];
  return station::JointBarePair::around(*std::move(leader_site), *std::move(follower_site), {}, tick, start);
}

Result<ArmPair> ArmPair::make(const ArmPairSetup& setup, const ArmModelParams& model_params, double wall_m,
                              const ArmPlantErrors& errors) {
  const ArmTappingParams& params = setup.params;
  const auto [leads, follows] = plants_of(setup, errors);
  const Seconds tick{1.0 / params.servo.rate_Hz};
  ArmPlant::Params held = leads;
  held.carried_kg = params.person.hand.mass_kg;
  auto leader = ArmPlant::make(held, setup.leader.start);
  if (!leader) return under("arm", leader.error());
  auto follower = ArmPlant::make(follows, setup.follower.start);
  if (!follower) return under(station::differs(params.arm) ? "arm.follower" : "arm", follower.error());
  auto person = arm_plants::ToolOperator::make(params.person, tick, leader->tool());
  if (!person) return under("operator", person.error());
  auto sites = bare_arm_sites(setup, model_params);
  if (!sites) return sites.error();
  const Joints<station::DeviceLimits> no_limits(leads.chain.joints.size()),
      no_follower_limits(follows.chain.joints.size());
  const auto contact = mechanics::Environment::make(params.wall.environment(), tick);
  if (!contact) return under("wall", contact.error());
  const auto leader_chain = arm::Chain::make(leads.chain);
  if (!leader_chain) return under("arm", leader_chain.error());
  std::optional<arm::Chain> other_follower;
  if (station::differs(params.arm)) other_follower = *arm::Chain::make(follows.chain);
  const auto delay = static_cast<std::size_t>(params.servo.extra_delay_cycles);
  return ArmPair(setup, *leader_chain, {*std::move(leader), no_limits, delay},
                 {*std::move(follower), no_follower_limits, delay}, other_follower, *std::move(person),
                 *std::move(sites), wall_m, *contact);
}

Vector3 ArmPair::led_to_m(const JointVector& leader) const {
  if (leads_joints_) return tool_at(other_follower_ ? *other_follower_ : leader_chain_, leader, follower_tool_m_);
  return follower_began_m_ + tool_scale_ * (tool_at(leader_chain_, leader, leader_tool_m_) - leader_began_m_);
}

double ArmPair::apart_m(const ToolState& leader, const ToolState& follower) const {
  const Vector3 wanted_m = other_follower_ ? led_to_m(leader_.plant().link_position()) : leader.position_m;
  return (wanted_m - follower.position_m).norm();
}

ArmRecord ArmPair::step(const Vector3& path_m, const Vector3& path_at_next_tick_m, double share) {
  step_sites({.number = tick_++}, share);
  return step_arms(path_m, path_at_next_tick_m);
}

void ArmPair::step_sites(const station::Tick& tick, double share) noexcept {
  follower_.touches({.force_N = wall_.force_N(follower_.plant().tool())});
  latest_ = sites_.step(leader_, follower_, tick, share);
}

ArmRecord ArmPair::step_arms(const Vector3& path_m, const Vector3& path_at_next_tick_m) {
  const ToolState at_leader = leader_.plant().tool();
  const ToolState at_follower = follower_.plant().tool();
  person_.begin_tick(leader_began_m_ + path_m / tool_scale_, leader_began_m_ + path_at_next_tick_m / tool_scale_,
                     at_leader);

  ArmRecord record{.hand_N = -person_.force(at_leader, 0.0).force_N.dot(outward_),
                   .leader_m = (at_leader.position_m - leader_began_m_).dot(outward_),
                   .follower_m = (at_follower.position_m - follower_began_m_).dot(outward_),
                   .tools_apart_m = apart_m(at_leader, at_follower)};
  for (int i = 0; i < steps_; ++i) {
    leader_.step(person_.force(leader_.plant().tool(), i * step_s_));
    const ToolForce contact{.force_N = wall_.force_N(follower_.plant().tool())};
    record.contact_N += contact.force_N.dot(outward_) / steps_;
    follower_.step(contact);
  }
  return record;
}

ArmSnapshot ArmPair::snapshot() const {
  const auto joints = static_cast<std::size_t>(leader_chain_.joints());
  JointVector displayed(leader_chain_.joints());
  JointVector told = displayed;
  JointVector induced = displayed;
  JointVector commanded = displayed;
  for (std::size_t i = 0; i < joints; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    const station::DeviceReading& read = latest_.master.reading[i];
    const control::MasterOutput& site = latest_.master.output[i];
    displayed[at] =
        site.motor_force_N - site.support_N + site.law.force_N(read.position_m, read.motor_report.velocity_m_per_s);
    told[at] = -latest_.slave.output[i].message.force_N;
    induced[at] = site.induced_position_m;
    commanded[at] = site.message.position_m;
  }
  const arm::Chain& follower_chain = other_follower_ ? *other_follower_ : leader_chain_;
  const JointVector leader_rad = leader_.plant().link_position();
  const JointVector follower_rad = follower_.plant().link_position();
  const MovesTool at_leader = moves_tool(leader_chain_, leader_rad, leader_tool_m_);
  return {.leader_rad = leader_rad,
          .follower_rad = follower_rad,
          .leader_m = leader_.plant().tool().position_m,
          .follower_m = follower_.plant().tool().position_m,
          .displayed_N = force_nearest_to(at_leader, displayed),
          .sent_N = leads_joints_ ? force_nearest_to(moves_tool(follower_chain, follower_rad, follower_tool_m_), told)
                                  : Vector3(force_nearest_to(at_leader, told) / tool_scale_),
          .induced_m = at_leader * induced,
          .command_m = led_to_m(commanded)};
}

double ArmPair::farthest_m() const {
  return std::max((leader_.plant().tool().position_m - leader_began_m_).norm(),
                  (follower_.plant().tool().position_m - follower_began_m_).norm());
}

void ArmPair::exchange(ArmPair& made, const Parts& parts) noexcept {
  if (parts.hand) person_.exchange_hand(made.person_);
  if (parts.wall) std::swap(wall_, made.wall_);
  if (parts.controllers) sites_.exchange_controllers(made.sites_);
}

bool ArmPair::healthy() const { return leader_.plant().healthy() && follower_.plant().healthy(); }

bool is_of_arms(const configuration::Document& document) {
  const auto kind = document.text_at("task.kind");
  return kind && *kind == name_of(ArmTappingKind::arm_tapping);
}

}  // namespace tactus::experiments
