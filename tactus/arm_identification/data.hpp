#pragma once

#include <tactus/arm_identification/consistent_fit.hpp>
#include <tactus/arm_identification/motion.hpp>

#include <array>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace tactus::arm_identification {

/// How friction turns round and what it has beside: an index of what `ArmData` holds.
struct FrictionShape {
  std::size_t direction = 2;
  bool load = false;
  int stribeck = -1;  ///< none
};

/// Motions of one or more recordings as regressors, a row for each instant.
class ArmData {
 public:
  /// v0 of tanh(v/v0), and the velocity of Stribeck's excess, as shares of the joint's rms speed.
  static constexpr std::array directions{0.005, 0.02, 0.06, 0.15, 0.35};
  static constexpr std::array slownesses{0.1, 0.3};

  /// `chain` tells where the joints are and which way gravity points; its bodies do not matter.
  ArmData(const arm::Chain& chain, std::span<const ArmMotion> motions);

  [[nodiscard]] Eigen::Index rows() const { return effort.rows(); }
  [[nodiscard]] int joints() const { return static_cast<int>(effort.cols()); }

  /// The `local_parameters` columns of a joint; `rigid`: its torque without friction, for that of the load.
  [[nodiscard]] Eigen::MatrixXd local(int joint, const FrictionShape& shape, const Eigen::VectorXd& rigid) const;
  /// Bodies and armature alone [N m].
  [[nodiscard]] Eigen::VectorXd rigid_torque(int joint, const ConsistentFit& fit) const;
  /// What a fit says the effort is, at every row.
  [[nodiscard]] Eigen::VectorXd predicted(int joint, const ConsistentFit& fit, const FrictionShape& shape) const;

  std::vector<double> speed;            ///< rms, by joint [rad/s]
  std::vector<Eigen::MatrixXd> bodies;  ///< by joint: columns of the bodies' parameters
  Eigen::MatrixXd velocity, acceleration, effort;
  /// By joint: columns of tanh(v/v0) for each of `directions`; for each of `slownesses` those times the excess.
  std::vector<Eigen::MatrixXd> direction;
  std::vector<std::array<Eigen::MatrixXd, slownesses.size()>> slow;
};

}  // namespace tactus::arm_identification
