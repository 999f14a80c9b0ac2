// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/data.hpp>

#include <functional>
#include <string>
#include <vector>

/// What is wrong with a URDF, its gravity or the order of columns, if recordings contradict them.
namespace tactus::arm_identification {

/// Share of a joint's effort beyond which what is left is never accepted without a word.
inline constexpr double much_left = 0.15;

/// What is assumed of an arm and of the columns of its recordings.
struct Assumption {
  arm::Chain::Params urdf = {};
  std::vector<int> position_of = {};       ///< by joint: which recorded position and velocity are its own
  std::vector<int> effort_of = {};         ///< by joint: which recorded effort is its own
  std::vector<double> effort_sign = {};    ///< by joint: 1, or -1 if the recorded effort counts the other way
  std::vector<std::string> changes = {};   ///< what was changed, as clauses: `joint 'j2' counts the other way …`
  std::vector<std::string> remedies = {};  ///< what applies each of them
  [[nodiscard]] bool changed() const { return !changes.empty(); }
};
Assumption as_stated(const arm::Chain::Params& urdf);

/// The recordings under an assumption: columns in its order, efforts with its signs.
std::vector<ArmRecording> rearranged(std::span<const ArmRecording> recordings, const Assumption& assumption);

/// By joint: what the URDF's bodies leave of the efforts, as a share, if armature, friction and an offset are fitted
/// and nothing else. `torques`: whether efforts are torques in N m; else each has the positive scale that fits best.
std::vector<double> left_by_urdf(const ArmData& data, const Assumption& assumption, bool torques);

/// The assumption with the fewest changes that explains the efforts clearly better: joints reversed, single or two,
/// efforts or positions of a joint reversed, two joints exchanged in all columns or in the efforts, another direction
/// of gravity. Bodies are those of the URDF. Each change must halve the squares that are left. Not real-time safe.
/// `progress`: the share of the search that is done.
Assumption explain(const ArmData& data, const Assumption& stated, const std::vector<std::string>& joints, bool torques,
                   const std::function<void(double)>& progress = {});

/// Gravity of the same size in the direction that explains the efforts best, the URDF's bodies taken as they are.
arm::Gravity best_gravity(const ArmData& data, const Assumption& assumption, bool torques);
/// How an option states it, to three digits: `9.81,0,0`.
std::string text_of(const arm::Gravity& gravity);

}  // namespace tactus::arm_identification
