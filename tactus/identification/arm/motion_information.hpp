// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/consistent_fit.hpp>
#include <tactus/identification/arm/fourier_motion.hpp>

#include <vector>

#include <Eigen/Core>

namespace tactus::arm_identification {

/// A metre outside of the box weighs as a limit that is exceeded by so many times itself.
inline constexpr double metre_beyond = 20.0;

/// What a motion may not leave.
struct MotionLimits {
  arm::JointVector lower, upper;      ///< of the positions
  arm::JointVector velocity, effort;  ///< greatest magnitudes
  arm::Vector3 box_lower_m, box_upper_m;
  /// Points that stay in the box: by joint, fixed to the link behind it, in its frame.
  std::vector<std::vector<arm::Vector3>> points;
};

/// How far a motion goes toward its limits: 1 is at the limit.
struct MotionUse {
  arm::JointVector least, greatest;   ///< positions, in their unit
  arm::JointVector velocity, effort;  ///< greatest magnitudes, in their unit
  double clearance_m = 0.0;           ///< least distance of a point to the faces of the box, negative outside
  std::size_t nearest = 0;            ///< the joint behind which that point is
  bool within = true;                 ///< whether no limit is left
};

/// What the torques of a motion determine of an arm, judged as `fit_consistently` would: whitened by the noise of each
/// joint's effort and by what was assumed before.
class MotionInformation {
 public:
  /// `chain`: what the arm is assumed to be, with friction; `prior`: a fit without data to the same model_params;
  /// `noise`: of each joint's effort [N m]; `rows_per_s`: how often its noise is new.
  MotionInformation(const arm::Chain& chain, const ConsistentFit& prior, arm::JointVector noise, double rows_per_s,
                    MotionLimits limits);

  /// What `minimise` lowers over `coordinates` (column-major): minus the log-determinant of the information, with
  /// `firmness` times the mean square of what is beyond a limit, over `instants` of the period. `slope` may be null.
  double cost(const Eigen::VectorXd& coordinates, double period_s, int harmonics, int instants, double firmness,
              Eigen::VectorXd* slope) const;

  /// The use of the limits over `instants` of the period.
  [[nodiscard]] MotionUse use(const FourierMotion& motion, int instants) const;
  /// Sums of a motion that lasts its period once, for `fit_consistently`; efforts are as the prior has them.
  [[nodiscard]] std::vector<JointSums> sums(const FourierMotion& motion, int instants) const;
  /// Eigenvalues, least first, of the information over that of the prior: 1 where a motion determines as much as was
  /// known.
  [[nodiscard]] Eigen::VectorXd gains(const FourierMotion& motion, int instants) const;

 private:
  [[nodiscard]] Eigen::MatrixXd whitened(const Eigen::MatrixXd& normal) const;

  arm::Chain chain_;
  arm::JointVector weight_;  ///< 1/noise²
  double rows_per_s_;
  Eigen::VectorXd believed_;  ///< `joint_parameters` for each joint, as the regressor counts
  Eigen::MatrixXd spread_;    ///< of those by the coordinates of the fit, each in its prior deviation
  MotionLimits limits_;
};

}  // namespace tactus::arm_identification
