// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/model.hpp>
#include <tactus/identification/arm/parameters.hpp>
#include <tactus/identification/arm/payload.hpp>
#include <tactus/identification/arm/recording.hpp>
#include <tactus/identification/arm/urdf_check.hpp>

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace tactus::arm_identification {

/// How well the model explains one joint. Efforts are those below the cutoff, in the unit of the recording.
struct ArmJointFit {
  std::string name = {};
  double effort_rms = 0.0;
  double residual_rms = 0.0;  ///< of the model, over all that was recorded
  double relative = 0.0;      ///< residual_rms / effort_rms
  /// The same for a model found from the first half of all rows alone, over the second half.
  double held_out_relative = 0.0;
  /// Alongside it, halves and filters alike: ordinary least squares of base parameters, Coulomb friction of the sign,
  /// viscous friction and offset.
  double least_squares_relative = 0.0;
  /// Share of the samples of the second half that lie within the 95 % interval of the first half's prediction.
  double held_out_coverage = 0.0;
  double effort_per_N_m = 1.0;
  /// Whether the recordings determine that scale: else it is near those of the other joints, or 1 for torques.
  bool scale_determined = false;
  std::vector<ArmParameter> parameters = {};
};

/// What a user may ask of a fit.
struct ArmFitOptions {
  std::optional<double> cutoff_Hz = {};  ///< of the zero-phase filter; none: 10 Hz, or a tenth of the sample rate
  bool free_scales = false;              ///< finds a scale for each joint's effort, although the file states torques
  bool free_gravity = false;  ///< finds the direction of gravity; that of the URDF's parameters counts for its size
  std::function<void(double)> progress = {};  ///< is given the share of the work that is done, from 0 to 1
};

struct ArmIdentification {
  std::vector<ArmJointFit> joints = {};
  ArmModel model = {};
  double duration_s = 0.0;
  double cutoff_Hz = 0.0;
  /// Efforts are of a unit of their own at each joint, such as motor currents: the URDF determines how much of it is a
  /// N m.
  bool scaled_efforts = false;
  /// What the URDF lacks, where its own bodies explain the efforts only with it.
  std::optional<Payload> payload = {};
  /// What a user should know of the model: a joint of which it leaves more than 15 %, a change that explains more.
  std::vector<std::string> warnings = {};
  int base_parameters = 0;  ///< combinations that any motion could determine at all
  int determined_combinations =
      0;  ///< those that these recordings determine better than the URDF does, friction included
};

/// Finds the dynamics of an arm from free motion of all its joints.
///
/// Effort = scale · (rigid bodies + armature + friction). Bodies, armatures and friction are the most probable ones
/// given the recordings and, where these determine nothing, `urdf`; they are such that bodies can have them
/// (`fit_consistently`). Each joint counts by what is left of it, and by how long that stays correlated. The velocity
/// within which friction turns round is an unknown like the others, so its doubt is in every interval. Whether friction
/// grows with load or in slow motion is chosen for each joint by cross-validation over four blocks. The scales are 1
/// where the file states torques, unless `free_scales` asks for them, and are found for currents. Efforts without a
/// unit count as torques; if a joint's cannot be one, or if it fits 3 % better, scales are found too.
///
/// Errors, in place of a model that nobody should trust: those of `ArmMotion::make`; `inconsistent` for too little
/// data, an effort that is 0 throughout, a joint of which the model leaves more than three quarters of the effort, and
/// a joint of which it leaves more than 15 % where a change explains the data (`explain`): a joint reversed, an effort
/// of the wrong sign, swapped columns, another direction of gravity. The message names the change, with what is left
/// before and after it. Not real-time safe. Source of the regression: Gautier and Khalil, Direct calculation of
/// minimum set of inertial parameters of serial robots, IEEE Trans. Robotics and Automation 6(3), 1990.
Result<ArmIdentification> identify_arm(std::span<const ArmRecording> recordings, const std::vector<std::string>& joints,
                                       const arm::Chain::Params& urdf, const ArmFitOptions& options = {});

}  // namespace tactus::arm_identification
