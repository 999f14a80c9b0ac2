// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>

#include <cstddef>
#include <span>
#include <vector>

/// Whether an arm without power reads what its URDF expects, from poses into which an operator moves it by hand.
/// Nothing here is real-time safe.
namespace tactus::devices {

/// Three poses of an arm: its zero, or the nearest that each joint's limits allow; then the joints of odd number turned
/// from there, then those of even number. A joint turns by a right angle, or as far as its limits allow, either way.
std::vector<arm::JointVector> guide_poses(const arm::Chain::Params& arm);

/// What disagrees with the URDF at a joint.
enum class GuideFault {
  none,
  unmoved,    ///< it read no motion: its motor does not respond, or is elsewhere
  swapped,    ///< it read the motion of another joint
  direction,  ///< it turned the other way
  gear,       ///< it turned by another angle
  zero        ///< its zero is elsewhere
};
constexpr auto enumerators(GuideFault) {
  return std::array{Enumerator{GuideFault::none, "none"},       Enumerator{GuideFault::unmoved, "unmoved"},
                    Enumerator{GuideFault::swapped, "swapped"}, Enumerator{GuideFault::direction, "direction"},
                    Enumerator{GuideFault::gear, "gear"},       Enumerator{GuideFault::zero, "zero"}};
}

struct GuideFinding {
  GuideFault fault = GuideFault::none;
  double expected_rad = 0.0;  ///< of `zero` the first pose, of all others the angle between two poses
  double read_rad = 0.0;      ///< the same as it was read
  std::size_t other = 0;      ///< of `swapped`: the joint whose motion it read
};

/// One finding for each joint; `read` has a reading for each pose. A hand places a joint within some 0.1 rad, so a gear
/// within 30 % or 0.21 rad and a zero within 0.25 rad pass. Joints of equal parity that are swapped are not found: they
/// turn together.
std::vector<GuideFinding> judge_poses(std::span<const arm::JointVector> poses, std::span<const arm::JointVector> read);

}  // namespace tactus::devices
