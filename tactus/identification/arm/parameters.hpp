// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/data.hpp>

#include <string>
#include <vector>

namespace tactus::arm_identification {

/// One number of an arm.
struct ArmParameter {
  std::string name = {};  ///< as in `model.toml`: `body.mass_kg`
  std::string unit = {};
  double value = 0.0;
  double lower = 0.0;  ///< of the 95 % interval
  double upper = 0.0;
  /// Whether the recordings determine it: they leave at most half of the deviation that the URDF was given. Else the
  /// value is near that of the URDF, and another with the same torques would do as well.
  bool determined = false;
};

/// The numbers of a joint and its body as a fit has them. `nothing`: a fit with the same priors and no data.
std::vector<ArmParameter> parameters_of(const ConsistentFit& fit, const ConsistentFit& nothing, int joint,
                                        const FrictionShape& shape);
/// A fit without data: what was assumed before.
ConsistentFit fit_of_nothing(const std::vector<JointPrior>& priors);
/// Directions of the coordinates in which the data leave at most half of the prior's variance.
int told_of(const ConsistentFit& fit);
/// How many combinations of bodies and armatures torques depend on: the rank of the regressor over random states.
int base_parameters_of(const arm::Chain& chain);

}  // namespace tactus::arm_identification
