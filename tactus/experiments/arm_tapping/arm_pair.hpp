#pragma once

#include <tactus/arm_plants/arm_device.hpp>
#include <tactus/experiments/arm_tapping/params.hpp>
#include <tactus/station/site_pair.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tactus::experiments {

/// All that a pair is made of, read and checked.
struct ArmPairSetup {
  ArmTappingParams params;
  std::vector<std::string> joints;  ///< their names, from the base on
  arm_plants::ArmPlant::Params arm;
  arm_control::InducedMotion::Arm induced;  ///< the same arm, without error
  arm::JointVector start;
  arm::Vector3 outward = arm::Vector3::UnitZ();  ///< of the surface, in base axes
};

/// Reads the URDF, from `folder` on. Errors: those of `urdf::read`; `missing` without a URDF; those of the parts.
Result<ArmPairSetup> set_up_arm_pair(const ArmTappingParams& params, const std::filesystem::path& folder);

/// What both tools did at a tick.
struct ArmRecord {
  double contact_N = 0.0;  ///< of the wall on the follower's tool, mean of the tick
  double hand_N = 0.0;     ///< that the hand feels of its spring and damper, outward, at the tick's beginning
  double leader_m = 0.0;   ///< of the tools, outward from where they began
  double follower_m = 0.0;
  double tools_apart_m = 0.0;  ///< between what the tools went from their starts
};

/// Two simulated arms with their sites, the leader in a person's hand, in virtual time. The sites are bare, as the
/// papers have theirs, behind the widest gates.
///
/// One tick: `station::step` of the leader's site with what the follower told at the tick before, then of the
/// follower's with what the leader tells now, where the commands of the tick before go to the drives, as on a bus; the
/// person aims; the arms step.
class ArmPair {
 public:
  /// `induced` is the arm that the model of induced motion believes in, in a hand as `hand`. The wall lies `wall_m`
  /// outward from where the tools begin.
  static Result<ArmPair> make(const ArmPairSetup& setup, const arm_control::InducedMotion::Arm& induced,
                              const arm::HandImpedance& hand, double wall_m);

  /// One tick, with where the person wants the tool now and a tick later, from where it began.
  ArmRecord step(const arm::Vector3& path_m, const arm::Vector3& path_at_next_tick_m);
  [[nodiscard]] bool healthy() const;
  [[nodiscard]] double tick_s() const { return tick_s_; }

 private:
  ArmPair(const ArmPairSetup& setup, arm_plants::ArmDevice leader, arm_plants::ArmDevice follower,
          arm_plants::Person person, station::JointBarePair sites, double wall_m);

  double tick_s_;
  int steps_;
  double step_s_;
  arm_plants::ArmDevice leader_;
  arm_plants::ArmDevice follower_;
  arm_plants::Person person_;
  station::JointBarePair sites_;
  std::int64_t tick_ = 0;
  arm::Vector3 outward_;
  arm::Vector3 began_m_;
  arm_plants::Wall wall_;
};

}  // namespace tactus::experiments
