// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/data.hpp>

#include <vector>

/// A fit on some of the rows that were recorded, and what it leaves on others.
namespace tactus::arm_identification {

/// Root mean square; of at least one value.
double rms(const Eigen::VectorXd& values);

/// Which rows: from, and how many.
struct RowSpan {
  Eigen::Index first;
  Eigen::Index count;
};

/// Parameters, and the form of friction of each joint.
struct RowsFit {
  ConsistentFit found;
  std::vector<FrictionColumns> friction;
};

/// The whole fit, with the forms of friction, on some of the rows; no part of it sees the others.
RowsFit fit_rows(const ArmData& data, RowSpan span, std::vector<JointPrior> priors, bool scales_known);
/// Effort less what the fit states, over `span`.
Eigen::VectorXd residual_of(const ArmData& data, const RowsFit& fit, int joint, RowSpan span);
/// Of each joint, what ordinary least squares leaves over `judged` when it has seen `seen`: all joints together, base
/// parameters by leaving out what the data do not determine, friction with the sign of the velocity.
std::vector<double> ordinary_least_squares(const ArmData& data, RowSpan seen, RowSpan judged);

}  // namespace tactus::arm_identification
