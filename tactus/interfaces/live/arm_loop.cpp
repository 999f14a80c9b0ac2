// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/interfaces/live/arm_loop.hpp>
#include <tactus/kernel/arm/chain.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <nlohmann/json.hpp>

namespace tactus::live {

namespace {

constexpr double join_s = 0.5;
/// From where it began, for a tool that has not run away, as in the experiment.
constexpr double tool_reach_m = 0.3;

template <Described T>
bool are_same(const T& one, const T& other) {
  return configuration::to_toml(one) == configuration::to_toml(other);
}

void put(std::array<float, most_joints>& to, const arm::JointVector& from) noexcept {
  for (Eigen::Index i = 0; i < from.size(); ++i) to[static_cast<std::size_t>(i)] = static_cast<float>(from[i]);
}

std::array<float, 3> floats(const arm::Vector3& from) noexcept {
  return {static_cast<float>(from[0]), static_cast<float>(from[1]), static_cast<float>(from[2])};
}

nlohmann::json json_of_vector(const arm::Vector3& from) { return {from[0], from[1], from[2]}; }

nlohmann::json json_of_arm(const experiments::DescribedArm& arm) {
  const arm::Chain::Params& chain = arm.arm.chain;
  nlohmann::json joints = nlohmann::json::array();
  for (std::size_t i = 0; i < chain.joints.size(); ++i) {
    const arm::JointParams& joint = chain.joints[i];
    const arm::Matrix3 turned = arm::rotation_of(joint.origin);
    nlohmann::json rotation = nlohmann::json::array();
    for (Eigen::Index row = 0; row < 3; ++row) {
      for (Eigen::Index column = 0; column < 3; ++column) rotation.push_back(turned(row, column));
    }
    joints.push_back({{"name", arm.joints[i]},
                      {"origin_m", {joint.origin.x_m, joint.origin.y_m, joint.origin.z_m}},
                      {"rotation", std::move(rotation)},
                      {"axis", {joint.axis.x, joint.axis.y, joint.axis.z}},
                      {"slides", joint.kind == arm::JointKind::prismatic}});
  }
  nlohmann::json start = nlohmann::json::array();
  for (const double joint : arm.start) start.push_back(joint);
  return {{"joints", std::move(joints)}, {"tool_m", json_of_vector(arm.arm.tool_m)}, {"start_rad", std::move(start)}};
}

}  // namespace

arm::Matrix3 hand_directions(const experiments::ArmPairSetup& setup) {
  const arm::Vector3 toward = -setup.outward;
  // Any that is not along it; the outward direction is along an axis of the base.
  const arm::Vector3 up = std::fabs(toward[2]) > 0.5 ? arm::Vector3::UnitX() : arm::Vector3::UnitZ();
  arm::Matrix3 directions;
  directions.col(0) = toward;
  directions.col(1) = up;
  directions.col(2) = toward.cross(up);
  return directions;
}

ArmLoop::ArmLoop(experiments::ArmPair pair, const arm::Matrix3& directions, const Parts& parts)
    : pair_(std::move(pair)), directions_(directions), parts_(parts) {}

Result<std::unique_ptr<Loop>> ArmLoop::make(const Setup& setup, const Parts& parts) {
  experiments::ArmModelParams model_params = setup.exact;
  model_params.hand = setup.params.control.model.hand;
  auto pair = experiments::ArmPair::make(setup, model_params, -loop_wall_m * setup.tool_scale);
  if (!pair) return pair.error();
  return std::unique_ptr<Loop>(new ArmLoop(*std::move(pair), hand_directions(setup), parts));
}

Result<LoopChange> ArmLoop::change(const Setup& before, const Setup& after) {
  const Parts parts{.hand = !are_same(before.params.person, after.params.person),
                    .wall = !are_same(before.params.wall, after.params.wall),
                    .controllers = !are_same(before.params.control, after.params.control)};
  if (parts == Parts{}) return LoopChange{};
  auto made = make(after, parts);
  if (!made) return made.error();
  return LoopChange{.made = *std::move(made), .goes_on = true};
}

arm::Vector3 ArmLoop::path_m(const HandPoint& hand, double time_s) const {
  const mechanics::MinimumJerk joins{.start_m = 1.0, .end_m = 0.0, .start_time_s = 0.0, .duration_s = join_s};
  const double apart = joins.position_m(time_s);
  arm::Vector3 at;
  for (std::size_t i = 0; i < hand.size(); ++i) at[static_cast<Eigen::Index>(i)] = hand[i] - apart * joined_at_[i];
  return directions_ * at;
}

void ArmLoop::step(const HandPoint& path, const HandPoint& path_at_next_tick, double share, LoopTick& tick) noexcept {
  if (ticks_ == 0) joined_at_ = path;
  const double time_s = static_cast<double>(ticks_++) * pair_.tick_s();
  const double scale = pair_.tool_scale();
  const arm::Vector3 wanted_m = path_m(path, time_s);
  const arm::Vector3 wanted_next_m = path_m(path_at_next_tick, time_s + pair_.tick_s());
  const experiments::ArmRecord did = pair_.step(scale * wanted_m, scale * wanted_next_m, share);
  const experiments::ArmSnapshot snapshot = pair_.snapshot();
  const arm::Vector3 toward = directions_.col(0);
  tick.record = {.time_s = time_s,
                 .master_position_m = -did.leader_m,
                 .induced_position_m = snapshot.induced_m.dot(toward),
                 .command_m = (snapshot.command_m - pair_.follower_began_m()).dot(toward) / scale,
                 .slave_position_m = -did.follower_m / scale,
                 .tip_position_m = -did.follower_m / scale,
                 .displayed_force_N = -snapshot.displayed_N.dot(toward),
                 .handle_force_N = 0.0,
                 .hand_force_N = did.hand_N,
                 .sent_force_N = -snapshot.sent_N.dot(toward),
                 .contact_force_N = did.contact_N,
                 .peak_contact_force_N = did.contact_N,
                 .touched = did.contact_N > 0.0,
                 .touched_at_s = did.contact_N > 0.0 ? time_s : 0.0};
  tick.arms.joints = static_cast<std::uint64_t>(snapshot.leader_rad.size());
  put(tick.arms.leader_rad, snapshot.leader_rad);
  put(tick.arms.follower_rad, snapshot.follower_rad);
  tick.arms.hand_m = floats(pair_.leader_began_m() + wanted_m);
  tick.arms.displayed_force_N = floats(snapshot.displayed_N);
  tick.arms.contact_force_N = floats(-did.contact_N * toward);
  tick.arms.induced_m = floats(snapshot.induced_m);
  // Written so that a NaN counts as outside.
  inside_ = (snapshot.leader_m - pair_.leader_began_m()).norm() < tool_reach_m &&
            (snapshot.follower_m - pair_.follower_began_m()).norm() < std::max(1.0, scale) * tool_reach_m;
}

void ArmLoop::exchange(Loop& made) noexcept {
  auto& other = static_cast<ArmLoop&>(made);
  pair_.exchange(other.pair_, other.parts_);
}

std::string arms_as_json(const experiments::ArmPairSetup& setup) {
  nlohmann::json directions = nlohmann::json::array();
  const arm::Matrix3 of_hand = hand_directions(setup);
  for (Eigen::Index i = 0; i < 3; ++i) directions.push_back(json_of_vector(of_hand.col(i)));
  return nlohmann::json{{"leader", json_of_arm(setup.leader)},
                        {"follower", json_of_arm(setup.follower)},
                        {"wall_m", loop_wall_m * setup.tool_scale},
                        {"directions", std::move(directions)}}
      .dump();
}

}  // namespace tactus::live
