// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>

#include <array>
#include <vector>

#include <Eigen/Core>

/// Parameters of an arm that bodies can have, from data and from what was assumed before.
namespace tactus::arm_identification {

/// Of a joint alongside its body: armature, Coulomb friction, viscous friction, offset, load-dependent friction,
/// Stribeck's excess, and by how much the logarithm of the velocity within which friction turns round is off.
inline constexpr int local_parameters = 7;
/// What is found for a joint: its body as a logarithm of a Cholesky factor (10), then those of the joint.
inline constexpr int joint_coordinates = arm::body_parameters + local_parameters;

/// What the data contain of one joint's effort, in the sums that least squares needs: effort ≈ scale · (columns ·
/// parameters), with the bodies of all joints as columns, then the joint's own `local_parameters`.
struct JointSums {
  Eigen::MatrixXd normal;  ///< columnsᵀ·columns
  Eigen::VectorXd right;   ///< columnsᵀ·effort
  double squares = 0.0;    ///< effortᵀ·effort
  double rows = 0.0;
};

/// What was assumed of one joint before, and how firmly.
struct JointPrior {
  arm::Body body = {};
  double armature = 0.0;  ///< [kg m²], greater than 0
  double coulomb = 0.0;   ///< [N m], greater than 0
  double viscous = 0.0;   ///< [N m s/rad], greater than 0
  double torque = 0.0;    ///< size of its torques [N m], greater than 0: offset and Stribeck's excess are a share of it
  double scale = 1.0;     ///< effort for one N m, greater than 0
  double scale_deviation = 0.0;  ///< of its logarithm; 0: known
  bool load = false;             ///< whether there is load-dependent friction
  bool stribeck = false;         ///< whether there is Stribeck's excess
  bool turning = false;          ///< whether the velocity within which friction turns round is sought
  double turning_log = 0.0;      ///< what its logarithm was assumed to be, less the one that the columns are made with
};

struct ConsistentFit {
  Eigen::VectorXd coordinates;  ///< `joint_coordinates` for each joint, then the logarithms of the scales
  Eigen::MatrixXd covariance;   ///< of the coordinates
  Eigen::VectorXd prior_deviations;
  Eigen::MatrixXd slope;   ///< of bodies and then local parameters, by the coordinates without scales
  Eigen::VectorXd bodies;  ///< `arm::body_parameters` for each joint
  std::vector<std::array<double, local_parameters>> local;
  std::vector<double> scales;
  std::vector<double> residual_rms;  ///< by joint, of the effort

  /// Standard deviation of a body's or a joint's number, to first order: `k` counts the ten of the body as
  /// `arm::linear_parameters` does, then the local ones.
  [[nodiscard]] double deviation(int joint, int k) const;
  /// Standard deviation of the logarithm of a joint's scale.
  [[nodiscard]] double scale_deviation(int joint) const;
  /// Standard deviation of each row of what the fit states of a joint's effort, as far as the parameters are uncertain.
  /// `columns`: those of the bodies, then the local ones.
  [[nodiscard]] Eigen::VectorXd prediction_deviation(int joint, const Eigen::MatrixXd& columns) const;
};

/// The most probable parameters: the data with Gaussian noise of `noise` (its deviation, by joint, in the unit of the
/// effort), the bodies near those of the prior. `correlation`: how many rows in a row have about the same noise, by
/// joint; the covariance grows with it. It does not weigh the joints: what stays of a joint's effort for long is rather
/// a fault of the model, for which the joint should not count less.
///
/// A body is a heap of masses of any density but negative, however far the data pull: its pseudo-inertia is U·Uᵀ with U
/// upper triangular and its diagonal exponentials, and everything that cannot be negative is an exponential. Prior
/// deviations: mass a factor of 4.5, lengths of gyration one of 3.3, centre 1.5 lengths of gyration; armature a factor
/// of 4.5, friction one of e², the velocity within which it turns round one of 4.5. Where data contain nothing the
/// prior stays, and `covariance` is that of the prior. Levenberg-Marquardt on the sums, in steps of at most one prior
/// deviation: a longer one can make an exponential so small that nothing pulls it back. Deterministic; not real-time
/// safe. Sources: Rucker and Wensing, Smooth parameterization of rigid-body inertia, IEEE RA-L 7(2), 2022; Traversaro
/// et al., Identification of fully physical consistent inertial parameters using optimization on manifolds, IROS 2016.
ConsistentFit fit_consistently(const std::vector<JointSums>& sums, const std::vector<JointPrior>& priors,
                               const std::vector<double>& noise, const std::vector<double>& correlation);

}  // namespace tactus::arm_identification
