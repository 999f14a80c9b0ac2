// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/consistent_fit.hpp>
#include <tactus/identification/arm/motion.hpp>

#include <array>
#include <functional>
#include <vector>

#include <Eigen/Core>

namespace tactus::arm_identification {

/// How friction turns round and what it has alongside.
struct FrictionShape {
  std::size_t direction = 2;  ///< of `ArmData::directions`
  double log_change = 0.0;    ///< of v0 from that
  bool load = false;
  int stribeck = -1;  ///< of `ArmData::slownesses`; none
};

/// Friction of that shape at every row: what turns round, Stribeck's share of it, and the slopes of both by log(v0).
struct FrictionColumns {
  FrictionShape shape = {};
  Eigen::VectorXd turned, slow, turned_by_log, slow_by_log;
};

/// Motions of one or more recordings as regressors, a row for each instant.
class ArmData {
 public:
  /// v0 of tanh(v/v0), and the velocity of Stribeck's excess, as shares of the joint's rms speed.
  static constexpr std::array directions{0.005, 0.02, 0.06, 0.15, 0.35};
  static constexpr std::array slownesses{0.1, 0.3};

  /// `chain` determines where the joints are and which way gravity points; its bodies do not matter.
  ArmData(const arm::Chain& chain, std::vector<ArmMotion> motions);

  [[nodiscard]] Eigen::Index rows() const { return effort.rows(); }
  [[nodiscard]] int joints() const { return static_cast<int>(effort.cols()); }
  [[nodiscard]] const std::vector<ArmMotion>& motions() const { return motions_; }

  /// v0 [rad/s]
  [[nodiscard]] double turning_velocity(int joint, const FrictionShape& shape) const;
  /// Without the slopes where they are not asked for.
  [[nodiscard]] FrictionColumns friction(int joint, const FrictionShape& shape, bool slopes) const;
  /// The `local_parameters` columns of a joint; `rigid`: its torque without friction, for that of the load; `own`: its
  /// local parameters as far as they are known, for that of log(v0).
  [[nodiscard]] Eigen::MatrixXd local(int joint, const FrictionColumns& law, const Eigen::VectorXd& rigid,
                                      const std::array<double, local_parameters>& own) const;
  /// Bodies and armature alone [N m].
  [[nodiscard]] Eigen::VectorXd rigid_torque(int joint, const ConsistentFit& fit) const;
  /// What a fit states the effort is, at every row.
  [[nodiscard]] Eigen::VectorXd predicted(int joint, const ConsistentFit& fit, const FrictionColumns& law) const;

  std::vector<double> speed;            ///< rms, by joint [rad/s]
  std::vector<Eigen::MatrixXd> bodies;  ///< by joint: columns of the bodies' parameters
  Eigen::MatrixXd velocity, acceleration, effort;
  /// By joint: columns of tanh(v/v0) for each of `directions`; for each of `slownesses` those times the excess.
  std::vector<Eigen::MatrixXd> direction;
  std::vector<std::array<Eigen::MatrixXd, slownesses.size()>> slow;

 private:
  /// A law of the velocity over all motions.
  [[nodiscard]] Eigen::VectorXd of_velocity(int joint, const std::function<double(double)>& law) const;

  std::vector<ArmMotion> motions_;
};

}  // namespace tactus::arm_identification
