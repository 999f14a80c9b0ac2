#pragma once

#include <tactus/identification/arm/model.hpp>
#include <tactus/identification/arm/parameters.hpp>
#include <tactus/identification/arm/recording.hpp>

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
  std::vector<ArmParameter> parameters = {};
};

struct ArmIdentification {
  std::vector<ArmJointFit> joints = {};
  ArmModel model = {};
  double duration_s = 0.0;
  double cutoff_Hz = 0.0;
  /// Efforts are of a unit of their own at each joint, such as motor currents: the URDF determines how much of it is a
  /// N m.
  bool scaled_efforts = false;
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
/// where efforts are torques; if a joint's cannot be, or if it fits 3 % better, they are found too.
///
/// Errors, in place of a model that nobody should trust: those of `ArmMotion::make`; `inconsistent` for too little
/// data, efforts that look swapped, an effort of the wrong sign, and a joint of which the model leaves more than three
/// quarters of the effort. Not real-time safe. Source of the regression: Gautier and Khalil, Direct calculation of
/// minimum set of inertial parameters of serial robots, IEEE Trans. Robotics and Automation 6(3), 1990.
Result<ArmIdentification> identify_arm(std::span<const ArmRecording> recordings, const std::vector<std::string>& joints,
                                       const arm::Chain::Params& urdf, std::optional<double> cutoff_Hz = {});

}  // namespace tactus::arm_identification
