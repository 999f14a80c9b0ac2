// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/data.hpp>

#include <optional>

namespace tactus::arm_identification {

/// A mass on the last link that the URDF lacks.
struct Payload {
  double mass_kg = 0.0;
  arm::Vector3 centre_m = arm::Vector3::Zero();  ///< in the frame of the last moving link
  double left = 0.0;                             ///< share of the effort that is left at the worst joint, with it
  double left_without = 0.0;                     ///< the same without it
};
/// Where the URDF's bodies alone leave more than 15 % of some effort and with a point mass less than that. Efforts are
/// torques in N m.
std::optional<Payload> find_payload(const ArmData& data, const arm::Chain::Params& urdf);

}  // namespace tactus::arm_identification
