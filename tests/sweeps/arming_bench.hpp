// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/station/supervised_arms.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <tests/arm_control/arming_run.hpp>

/// Two simulated arms that are armed by sites whose model of them may be wrong, in virtual time. The arms are MuJoCo's
/// and stay as they are; what is wrong is the model alone, or how joints and motors are connected.
namespace tactus::sweeps {

using arming::Arming, arming::Before, arming::Wiring;

/// A pair of arms that is shipped, as it truly is, with the limits of its devices.
struct ShippedPair {
  std::string name;
  experiments::ArmPairSetup setup;
  Joints<station::DeviceLimits> leader_limits, follower_limits;
  arm::JointVector leader_hangs, follower_hangs;  ///< where its arms come to rest without power

  /// Whether no joint leans on an end stop there, or is nearer to one than 0.1 rad: only such an arm hangs freely.
  [[nodiscard]] bool hangs_freely() const;
  [[nodiscard]] std::size_t joints() const { return leader_limits.size(); }
  /// Ticks at the rate of its sites.
  [[nodiscard]] double tick_s() const { return 1.0 / setup.params.servo.rate_Hz; }
};

/// Every pair of arms with a URDF that can be supervised, at the pose of its file, or at another one (`task.pose`).
/// The gripper of the rig file is left out: it has no weight in the model. The torques that try the motors are those
/// of limits.toml, an OpenArm's, but for two: the geared pair's are enough for its larger arm, and joint 5 of the YAM
/// pair needs more. Its joint 4 keeps 1.5 N m, which is far too much for it.
std::vector<ShippedPair> shipped_pairs(std::int64_t pose = 0);

/// What the sites take a pair for, and how it is connected.
struct Beliefs {
  arm::Chain::Params leader, follower;
  Wiring leader_wiring, follower_wiring;
};
/// What is true.
Beliefs truth_of(const ShippedPair& pair);

/// Arms both, as a program does: align, arm, dead-man switch. A hand that holds an arm releases it once the support has
/// come in. It ends a second after both are active, or after either has released its arm or refused it.
Arming arm_both(const ShippedPair& pair, Before before, const Beliefs& beliefs);
/// The pair whose gravity compensation comes in within `blend_s` and is not judged, for the control of a sweep.
ShippedPair unjudged(ShippedPair pair);

/// A pair whose URDF or wiring is wrong, and how it is kept up.
struct WrongPair {
  std::string words;
  std::size_t pair = 0;
  Before before = Before::hangs;
  Beliefs beliefs;
};
/// Number `index` of a seed. Kinds, pairs and joints are taken in turn; sizes, arms and what keeps them up are drawn:
/// masses by 0.3 to 10, lengths by 0.5 to 1,000 (with centimetres and millimetres in a third of the cases), a joint
/// swapped with its neighbour, a joint that counts the other way. A hand holds an arm that cannot hang freely.
WrongPair wrong_pair(const std::vector<ShippedPair>& pairs, std::int64_t seed, std::size_t index);
/// The same of a model in which every mass and every number of a centre of mass is wrong by up to `share`.
WrongPair nearly_right_pair(const std::vector<ShippedPair>& pairs, std::int64_t seed, std::size_t index, double share);

}  // namespace tactus::sweeps
