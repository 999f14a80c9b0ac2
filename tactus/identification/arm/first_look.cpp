// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/first_look.hpp>
#include <tactus/identification/arm/rows_fit.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include <Eigen/Core>

namespace tactus::arm_identification {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using identification::inconsistent;

constexpr double usual_torque = 0.4;     ///< scales from here to its inverse are those of torques
constexpr double scale_deviation = 0.1;  ///< of the logarithm of a torque's scale, where it is not known
constexpr double current_deviation = 0.7;
constexpr double clear_share = 0.3;  ///< of an effort that the URDF's bodies make: from here on its scale is clear

/// What one joint's effort says of the URDF's bodies before anything is fitted.
struct FirstLook {
  double scale = 0.0;  ///< effort for a N m
  double share = 0.0;  ///< of the effort that the URDF's bodies make, by their rms and this scale
};

FirstLook look(const ArmData& data, const VectorXd& bodies, int joint) {
  const VectorXd torque = data.bodies[static_cast<std::size_t>(joint)] * bodies;
  const VectorXd effort = data.effort.col(joint);
  MatrixXd columns(data.rows(), 5);
  columns << torque, data.local(joint, data.friction(joint, {}, false), torque, {}).leftCols(4);
  const VectorXd found = signal::solve_least_squares(columns, effort);
  return {.scale = found[0], .share = found[0] * rms(torque) / rms(effort)};
}

}  // namespace

EffortUnit unit_of(std::span<const ArmRecording> recordings) {
  const auto all_are = [&](std::initializer_list<std::string_view> units) {
    return std::all_of(recordings.begin(), recordings.end(), [&](const ArmRecording& recording) {
      return std::find(units.begin(), units.end(), recording.effort_unit) != units.end();
    });
  };
  if (all_are({"N m", "N"})) return EffortUnit::torque;
  return all_are({"A", "mA", "uA", "kA"}) ? EffortUnit::current : EffortUnit::unknown;
}

Check check_efforts(const ArmData& data, const std::vector<std::string>& joints, const ArmRecording& recording) {
  for (int j = 0; j < data.joints(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    if (rms(data.effort.col(j)) > 0.0) continue;
    return inconsistent("effort", "the effort of joint '" + joints[at] + "' (column '" + recording.effort_names[at] +
                                      "') is 0 throughout; name another column");
  }
  return {};
}

std::vector<JointPrior> priors_of(const ArmData& data, const arm::Chain& chain, const arm::Chain::Params& urdf,
                                  const VectorXd& bodies, EffortUnit unit, bool& scaled) {
  const int count = data.joints();
  std::vector<FirstLook> looks;
  scaled = unit == EffortUnit::current;
  std::vector<double> clear_scales;
  for (int j = 0; j < count; ++j) {
    looks.push_back(look(data, bodies, j));
    if (looks.back().share <= clear_share) continue;
    const double scale = looks.back().scale;
    clear_scales.push_back(scale);
    scaled = scaled || (unit == EffortUnit::unknown && (scale < usual_torque || scale > 1.0 / usual_torque));
  }
  std::sort(clear_scales.begin(), clear_scales.end());
  const arm::JointMatrix mass = chain.mass_matrix(arm::JointVector::Zero(count));
  std::vector<JointPrior> priors;
  for (int j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const arm::JointParams& joint = urdf.joints[at];
    const FirstLook& seen = looks[at];
    JointPrior prior;
    prior.body = joint.body;
    if (scaled) {
      const double by_size = rms(data.effort.col(j)) / std::max(rms(data.bodies[at] * bodies), 1e-9);
      const double others = clear_scales.empty() ? by_size : clear_scales[clear_scales.size() / 2];
      prior.scale = seen.share > clear_share ? seen.scale : others;
      prior.scale_deviation = current_deviation;
    } else {
      prior.scale_deviation = unit == EffortUnit::torque ? 0.0 : scale_deviation;
    }
    prior.torque = rms(data.effort.col(j)) / prior.scale;
    const double armature = joint.drive.reflected_kg_m2();
    prior.armature = armature > 0.0 ? armature : std::max(0.1 * mass(j, j), 1e-6);
    prior.coulomb = joint.friction.coulomb_N_m > 0.0 ? joint.friction.coulomb_N_m : 0.1 * prior.torque;
    prior.viscous = joint.friction.viscous_N_m_s_per_rad > 0.0 ? joint.friction.viscous_N_m_s_per_rad
                                                               : 0.1 * prior.torque / data.speed[at];
    priors.push_back(prior);
  }
  return priors;
}

}  // namespace tactus::arm_identification
