// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>
#include <tactus/data/urdf/described_arms.hpp>
#include <tactus/kernel/core/signals.hpp>
#include <tactus/kernel/station/described_arms.hpp>
#include <tactus/kernel/station/site_pair.hpp>
#include <tactus/simulation/arm_plants/arm_device.hpp>
#include <tactus/simulation/experiments/arm_tapping/params.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>

namespace tactus::experiments {

using station::ArmModelParams;
using station::DescribedArm;

/// All that a simulated pair is made of, read and checked.
struct ArmPairSetup : station::DescribedArms {
  ArmTappingParams params;
  arm::Vector3 outward = arm::Vector3::UnitZ();  ///< of the surface, along the axes of both bases
  /// How far the follower's tool goes where the leader's goes outward, over that, at the start: 1 where they are alike,
  /// 2 for a leader of half the follower's size; of a handle that leads the tool it is control.follower.tool_scale. The
  /// task's speeds and depths are the follower's tool's.
  double tool_scale = 1.0;
};

/// Whether a document asks for two arms: its kind is arm-tapping.
bool is_of_arms(const configuration::Document& document);

/// Reads the URDFs, from `folder` on. Errors: those of `urdf::describe_arms`; `inconsistent` for a follower
/// whose tool does not go where the leader's goes, and for a method that couples joints where a handle leads the tool.
Result<ArmPairSetup> set_up_arm_pair(const ArmTappingParams& params, const std::filesystem::path& folder);
/// The same of URDFs that are elsewhere.
Result<ArmPairSetup> set_up_arm_pair(const ArmTappingParams& params, const urdf::Urdfs& urdfs);

/// The sites of a tap, without supervision, behind the widest gates. Errors: those of the controllers, under `control`.
Result<station::JointBarePair> bare_arm_sites(const ArmPairSetup& setup, const ArmModelParams& model_params);

/// In what the simulated arms differ from `ArmPairSetup`, for a tap.
struct ArmPlantErrors {
  arm::JointVector leader_torque_scale = {};  ///< `arm::MotorParams::torque_scale`; no rows: 1
  arm::JointVector follower_torque_scale = {};
  double leader_payload_kg = 0.0;  ///< at the tool, with its weight
  double follower_payload_kg = 0.0;
};
/// An arm with a mass more at its tool.
arm::Chain::Params with_payload(arm::Chain::Params chain, double payload_kg, const arm::Vector3& tool_m);
/// The simulated arms of a setup with these errors.
struct ArmPlants {
  arm::PhysicalArm leader;
  arm::PhysicalArm follower;
};
ArmPlants plants_of(const ArmPairSetup& setup, const ArmPlantErrors& errors);

/// Moves both arms by the tare of `control.tare`, held by nobody, and leaves in `model_params` what their models of
/// gravity lack; nothing without cycles. Errors: those of `Tare::make` and of the plants.
Check tare_arms(const ArmPairSetup& setup, const ArmPlantErrors& errors, ArmModelParams& model_params);

/// What both tools did at a tick.
struct ArmRecord {
  double contact_N = 0.0;  ///< of the wall on the follower's tool, mean of the tick
  double hand_N = 0.0;     ///< that the hand feels of its spring and damper, outward, at the tick's beginning
  double leader_m = 0.0;   ///< of the tools, outward from where they began
  double follower_m = 0.0;
  /// Between the follower's tool and where the leader leads it: where it would be with the leader's joints, or where a
  /// handle has it.
  double tools_apart_m = 0.0;
  static constexpr auto signals() {
    using R = ArmRecord;
    return List{observed("contact_N", &R::contact_N, units::newton, "slave", "tool", "out of the surface",
                         "Of the surface on the follower's tool, mean over the control cycle."),
                observed("hand_N", &R::hand_N, units::newton, "master", "tool", "into the surface",
                         "Of the hand's spring and damper on the leader's tool."),
                observed("leader_m", &R::leader_m, units::metre, "master", "tool", "out of the surface",
                         "From where it began."),
                observed("follower_m", &R::follower_m, units::metre, "slave", "tool", "out of the surface",
                         "From where it began."),
                observed("tools_apart_m", &R::tools_apart_m, units::metre, "", "tool", "",
                         "Between the follower's tool and where it would be with the leader's joints.")};
  }
};

/// What both arms are about, for who draws them: vectors along the axes of the bases, forces on the hand and the
/// follower's tool. Values of a site are those of the latest tick.
struct ArmSnapshot {
  arm::JointVector leader_rad;  ///< of the links
  arm::JointVector follower_rad;
  arm::Vector3 leader_m;  ///< of the tools
  arm::Vector3 follower_m;
  /// What the leader's motors and their law do in addition to gravity compensation, as the force at the tool whose
  /// torques come nearest to theirs.
  arm::Vector3 displayed_N;
  arm::Vector3 sent_N;     ///< of the resisting torques that the follower's site sends, the same
  arm::Vector3 induced_m;  ///< motion of the leader's tool that its site takes from the command
  arm::Vector3 command_m;  ///< where the leader's site sends the follower's tool
};

/// Two simulated arms with their sites, the leader in an operator's hand, in virtual time. The sites are bare, as the
/// papers have theirs, behind the widest gates.
///
/// One tick: `station::step` of the leader's site with what the follower sent at the tick before, then of the
/// follower's with what the leader sends now, where the commands of the tick before go to the drives, as on a bus; the
/// operator aims; the arms step.
class ArmPair {
 public:
  /// The wall lies `wall_m` outward from where the follower's tool begins.
  static Result<ArmPair> make(const ArmPairSetup& setup, const ArmModelParams& model_params, double wall_m,
                              const ArmPlantErrors& errors = {});

  /// One tick, with where the operator wants the follower's tool now and a tick later, from where it began; the hand
  /// goes that over `ArmPairSetup::tool_scale`. `share` is that of what the controllers want, the arms' support with
  /// it; 0 releases the tool.
  ArmRecord step(const arm::Vector3& path_m, const arm::Vector3& path_at_next_tick_m, double share = 1.0);
  /// The parts of a tick, for a clock that is not the pair's own: first what a servo thread owes the drives in time...
  void step_sites(const station::Tick& tick, double share = 1.0) noexcept;
  /// ...then operator and arms, for as long as a tick takes; at a tick that the sites missed, these alone, under the
  /// commands that the drives have. Real-time safe, as the other.
  ArmRecord step_arms(const arm::Vector3& path_m, const arm::Vector3& path_at_next_tick_m);
  /// What the sites did at the latest tick.
  [[nodiscard]] const station::JointBarePair::Output& latest() const noexcept { return latest_; }
  [[nodiscard]] const station::JointBarePair& sites() const noexcept { return sites_; }
  [[nodiscard]] ArmSnapshot snapshot() const;
  /// Of the hand's spring and damper on the leader's tool, along the axes of its base.
  [[nodiscard]] arm::Vector3 hand_force_N() const { return person_.force(leader_.plant().tool(), 0.0).force_N; }
  /// How far the leader's or the follower's tool is from where it began, whichever is farther.
  [[nodiscard]] double farthest_m() const;

  /// What `exchange` takes over.
  struct Parts {
    bool hand = false;         ///< spring and damper of the operator; the mass is the arm's
    bool wall = false;         ///< how hard it is; it stays where it is
    bool controllers = false;  ///< of both sites
    bool operator==(const Parts&) const = default;
  };
  /// Continues with these parts of `made`, a pair of the same arms and clock that has not been stepped; `made` gets the
  /// own ones. Arms stay where they are. Controllers are first brought to rest at this very instant
  /// (`Site::exchange_controller`): as long as 1000 ticks of the sites. Between ticks; does not allocate.
  void exchange(ArmPair& made, const Parts& parts) noexcept;
  [[nodiscard]] bool healthy() const;
  /// Neither site commanded a torque at the latest tick.
  [[nodiscard]] bool at_rest() const noexcept { return sites_.at_rest(); }
  /// Where the tools began, along the axes of their bases.
  [[nodiscard]] const arm::Vector3& leader_began_m() const noexcept { return leader_began_m_; }
  [[nodiscard]] const arm::Vector3& follower_began_m() const noexcept { return follower_began_m_; }
  /// `ArmPairSetup::tool_scale`.
  [[nodiscard]] double tool_scale() const noexcept { return tool_scale_; }
  [[nodiscard]] double tick_s() const { return tick_s_; }

 private:
  ArmPair(const ArmPairSetup& setup, const arm::Chain& leader_chain, arm_plants::ArmDevice leader,
          arm_plants::ArmDevice follower, const std::optional<arm::Chain>& other_follower,
          arm_plants::ToolOperator person, station::JointBarePair sites, double wall_m,
          const mechanics::Environment& contact);
  /// Where the leader leads the follower's tool, along the axes of its base, by its joints.
  [[nodiscard]] arm::Vector3 led_to_m(const arm::JointVector& leader) const;
  [[nodiscard]] double apart_m(const arm_plants::ToolState& leader, const arm_plants::ToolState& follower) const;

  double tick_s_;
  int steps_;
  double step_s_;
  arm_plants::ArmDevice leader_;
  arm_plants::ArmDevice follower_;
  arm_plants::ToolOperator person_;
  station::JointBarePair sites_;
  station::JointBarePair::Output latest_;
  arm::Chain leader_chain_;  ///< maps joints to the tool
  arm::Vector3 leader_tool_m_;
  std::int64_t tick_ = 0;
  arm::Vector3 outward_;
  double tool_scale_;
  arm::Vector3 leader_began_m_;
  arm::Vector3 follower_began_m_;
  std::optional<arm::Chain> other_follower_;  ///< where it is another arm than the leader
  bool leads_joints_;                         ///< and not the tool
  arm::Vector3 follower_tool_m_;
  arm_plants::Wall wall_;
};

}  // namespace tactus::experiments
