// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/fourier_motion.hpp>
#include <tactus/identification/arm/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace tactus::arm_identification {

/// What a motion that is to be recorded must keep to.
struct ExcitationRequest {
  double duration_s = 20.0;  ///< the period of the series
  double highest_Hz = 0.5;   ///< no harmonic lies above
  /// Share of each joint's range of positions, about its middle, and of its velocity and effort that may be used, above
  /// 0 and at most 1.
  double share = 0.7;
  /// Of each joint: what a model leaves of its effort below `default_arm_cutoff_Hz`, rms [N m], greater than 0.
  std::vector<double> noise_N_m = {};
  /// By joint: points fixed to the link behind it, in its frame, that stay in the box, given in that of the base. One
  /// that no joint moves counts as within.
  std::vector<std::vector<arm::Vector3>> points = {};
  arm::Vector3 box_lower_m = arm::Vector3::Constant(-std::numeric_limits<double>::infinity());
  arm::Vector3 box_upper_m = arm::Vector3::Constant(std::numeric_limits<double>::infinity());
  std::uint64_t seed = 1;
};

/// What a motion takes of a joint, and promises of it.
struct ExcitedJoint {
  std::string name = {};
  double least = 0.0, greatest = 0.0;  ///< positions [rad]
  double velocity_rad_per_s = 0.0;     ///< greatest speed
  double effort_N_m = 0.0;             ///< greatest torque, by the URDF's masses and the friction that is assumed
  arm::JointLimits limits = {};        ///< those of the URDF
  double noise_N_m = 0.0;
  /// As assumed, with the 95 % intervals that `identify_arm` will give if its residual is the noise.
  std::vector<ArmParameter> parameters = {};
};

/// How well a motion determines an arm.
struct MotionWorth {
  /// Of the information in base parameters and friction, each direction against what the URDF leaves in doubt: square
  /// root of the greatest over the least eigenvalue.
  double condition = 0.0;
  double information_nats = 0.0;    ///< by which the doubt of all parameters together shrinks: ½ log|1 + information|
  int determined_combinations = 0;  ///< as in `ArmIdentification`
};

struct ArmExcitation {
  FourierMotion motion;
  std::vector<ExcitedJoint> joints = {};
  MotionWorth worth = {};
  bool searched = true;  ///< false where no search ended within the limits: the best random motion then
  /// Alongside it: random motions of the same series, each as large as the same limits let it. Medians of
  /// `compared_motions`.
  MotionWorth random = {};
  /// The median random motion, for a recording to compare with.
  FourierMotion random_motion;
  int base_parameters = 0;
  double clearance_m = 0.0;  ///< least distance of the points to the faces of the box; infinite without one
};

inline constexpr int compared_motions = 9;

/// Finds the motion within limits whose torques determine most of an arm.
///
/// The criterion is D-optimality as the fit will see it: the log-determinant of 1 + Dᵀ(Σ YᵀWY)D, with Y the regressor
/// of bodies, armature, Coulomb and viscous friction and offset, W one over the variance of each joint's noise, and D
/// what the URDF leaves in doubt (the prior of `fit_consistently`). It counts base parameters only, since nothing else
/// shows in Y, and each in the unit of its doubt. Starting from several random series it is raised by `minimise` with
/// analytic slopes but for those of Y, limits as growing penalties, until no limit is left at a hundred instants of the
/// highest harmonic's period; the best is taken. The same for the same seed. Torques are those of
/// the URDF with a friction of a tenth of the torques' size if the URDF has no friction. Bodies that touch one another
/// or themselves are not looked at, only `points`.
///
/// `progress` receives the share that is done, from 0 to 1. Takes seconds. Not real-time safe.
///
/// Errors: `missing` for a joint without limits of position (unless it turns without end: then ±π), velocity or effort;
/// `out_of_bounds` for a number of the request, `inconsistent` for fewer than two harmonics or more than 20, and for
/// limits within which no motion was found. Sources: Swevers et al. 1997 (the series, the criterion); Chaloner and
/// Verdinelli, Bayesian experimental design, Statistical Science 10(3), 1995 (with a prior).
Result<ArmExcitation> design_excitation(const std::vector<std::string>& joints, const arm::Chain::Params& urdf,
                                        const ExcitationRequest& request,
                                        const std::function<void(double)>& progress = {});

}  // namespace tactus::arm_identification
