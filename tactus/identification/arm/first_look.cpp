#include <tactus/identification/arm/first_look.hpp>
#include <tactus/identification/arm/rows_fit.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <algorithm>

#include <Eigen/Core>

namespace tactus::arm_identification {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using identification::inconsistent;

constexpr double usual_torque = 0.4;     ///< scales from here to its inverse are those of torques
constexpr double scale_deviation = 0.1;  ///< of the logarithm of a torque's scale, where it is not known
constexpr double current_deviation = 0.7;

/// What one joint's effort says of the URDF's bodies before anything is fitted.
struct FirstLook {
  double scale = 0.0;         ///< effort for a N m
  double share = 0.0;         ///< of the effort that the URDF's bodies make, by their rms and this scale
  double friction_share = 0;  ///< the same of Coulomb friction, negative where it would give energy
  double explained = 0.0;     ///< share of the effort's squares about zero
};

FirstLook look(const ArmData& data, const VectorXd& bodies, int joint, int effort_of) {
  const auto at = static_cast<std::size_t>(joint);
  const VectorXd torque = data.bodies[at] * bodies;
  const VectorXd effort = data.effort.col(effort_of);
  MatrixXd columns(data.rows(), 5);
  columns << torque, data.local(joint, data.friction(joint, {}, false), torque, {}).leftCols(4);
  const VectorXd found = signal::solve_least_squares(columns, effort);
  FirstLook result;
  const double size = rms(effort);
  if (!(size > 0.0)) return result;
  result.scale = found[0];
  result.share = found[0] * rms(torque) / size;
  result.friction_share = found[2] * rms(columns.col(2)) / size;
  result.explained = 1.0 - (effort - columns * found).squaredNorm() / effort.squaredNorm();
  return result;
}

}  // namespace

Check check_efforts(const ArmData& data, const VectorXd& bodies, const std::vector<std::string>& joints,
                    const ArmRecording& recording) {
  const int count = data.joints();
  constexpr double clearly = 0.3;
  for (int i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (!(rms(data.effort.col(i)) > 0.0)) {
      return inconsistent("effort", "the effort of joint '" + joints[at] + "' (column '" + recording.effort_names[at] +
                                        "') is 0 throughout; name another column");
    }
    for (int k = i + 1; k < count; ++k) {
      const double left = 2.0 - look(data, bodies, i, i).explained - look(data, bodies, k, k).explained;
      const double exchanged = 2.0 - look(data, bodies, i, k).explained - look(data, bodies, k, i).explained;
      if (left < 0.1 || left < 3.0 * exchanged) continue;
      return inconsistent("effort", "the efforts of joints '" + joints[at] + "' and '" +
                                        joints[static_cast<std::size_t>(k)] + "' (columns '" +
                                        recording.effort_names[at] + "' and '" +
                                        recording.effort_names[static_cast<std::size_t>(k)] +
                                        "') look swapped: each fits the other joint; exchange them");
    }
    const FirstLook own = look(data, bodies, i, i);
    if (own.share < -clearly || own.friction_share < -clearly) {
      return inconsistent("effort", "the effort of joint '" + joints[at] + "' (column '" + recording.effort_names[at] +
                                        "') has the wrong sign: it must push toward +position as the URDF has it; turn "
                                        "the column round");
    }
  }
  return {};
}

std::vector<JointPrior> priors_of(const ArmData& data, const arm::Chain& chain, const arm::Chain::Params& urdf,
                                  const VectorXd& bodies, bool& scaled) {
  const int count = data.joints();
  std::vector<FirstLook> looks;
  scaled = false;
  for (int j = 0; j < count; ++j) {
    looks.push_back(look(data, bodies, j, j));
    const bool clear = looks.back().share > 0.3;
    scaled = scaled || (clear && (looks.back().scale < usual_torque || looks.back().scale > 1.0 / usual_torque));
  }
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
      prior.scale = seen.share > 0.3 ? seen.scale : by_size;
      prior.scale_deviation = current_deviation;
    } else {
      prior.scale_deviation = scale_deviation;
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
