// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/urdf/described_arms.hpp>
#include <tactus/kernel/arm_control/position_coupling.hpp>
#include <tactus/simulation/arm_plants/polled_arm.hpp>
#include <tactus/simulation/experiments/arm_vibration/params.hpp>
#include <tactus/simulation/experiments/arm_vibration/shaking.hpp>

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace tactus::experiments {

/// All that a pair is made of, read and checked.
struct CoupledArmsSetup {
  ArmVibrationParams params;
  arm::Chain::Params believed;       ///< the host's model of both arms: without causes
  arm_plants::ArmPlant::Params arm;  ///< with the causes that both arms have
  arm::JointVector start;
  std::size_t joint = 0;                           ///< that is looked at, from 0
  arm::Vector3 direction = arm::Vector3::UnitZ();  ///< in which that joint moves the tool
};

/// Errors: those of `urdf::describe_arm` and of the parts; `out_of_bounds` for a joint that the arm does not have.
Result<CoupledArmsSetup> set_up_coupled_arms(const ArmVibrationParams& params, const std::filesystem::path& folder);

/// What a host that reads both arms each millisecond has of the joint that is looked at, in rad, rad/s and N m.
struct CoupledArmsRecord {
  double leader_rad = 0.0;
  double follower_rad = 0.0;
  double leader_rad_per_s = 0.0;  ///< as the host reads it
  double follower_rad_per_s = 0.0;
  double leader_N_m = 0.0;  ///< of the motors, less gravity compensation
  double follower_N_m = 0.0;
};

/// How the arms shook over a second.
struct ShakingArms {
  Shaking joint;                ///< the joint that is looked at, of the arm that shakes more
  std::size_t worst_joint = 0;  ///< the joint that shakes most, by its velocity, from 0
  Shaking worst;

  /// Any joint shakes by more than 0.2 rad/s, root mean square. A sound pair's wrists, which stick and slip while the
  /// arm moves, come to a third of that; openarm_teleop's own detector, which nothing calls, asks for 0.7.
  [[nodiscard]] bool vibrates() const { return worst.rms_rad_per_s > 0.2; }
};

/// What came of a run.
struct CoupledArmsResult {
  ShakingArms moving;       ///< in the middle of the reach; where nobody holds it, from half a second after the push on
  ShakingArms resting;      ///< in the last second
  bool diverged = false;    ///< left its place by more than 2 rad, or is not finite
  double delay_s = 0.0;     ///< age of what a drive receives of the other's joint, the mean of both directions
  double weight_N_m = 0.0;  ///< of the links on that joint, in the end
  std::vector<CoupledArmsRecord> records;

  [[nodiscard]] bool vibrates() const { return diverged || moving.vibrates() || resting.vibrates(); }
};

/// Two simulated arms in one program of three loops, as openarm_teleop has it, in virtual time. The same parameters
/// give the same result, bit for bit. Errors: what a part refuses.
Result<CoupledArmsResult> run_coupled_arms(const CoupledArmsSetup& setup);

/// What linear theory predicts for the pair: without play, and for the joint's motor alone within its play.
struct CoupledArmsTheory {
  std::optional<arm_control::DelayLimit> arms;
  std::optional<arm_control::DelayLimit> motor;
  double growth_per_s = 0.0;  ///< of the arms without delay, by the wrong velocity scale (`arm_control::growth_per_s`)
};
/// Errors: those of `Chain::make`.
Result<CoupledArmsTheory> theory_of(const CoupledArmsSetup& setup);

}  // namespace tactus::experiments
