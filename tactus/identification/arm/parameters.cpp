// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/parameters.hpp>
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <array>
#include <cmath>

#include <Eigen/Core>

namespace tactus::arm_identification {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double parameter_normal_95 = 1.96;

}  // namespace

int base_parameters_of(const arm::Chain& chain) {
  signal::Random random(1);
  const Index joints = chain.joints();
  constexpr Index states = 60;
  MatrixXd rows(states * joints, (arm::joint_parameters - 3) * joints);
  const auto draw = [&] {
    arm::JointVector v(joints);
    for (double& value : v) value = 6.0 * random.uniform() - 3.0;
    return v;
  };
  for (Index i = 0; i < states; ++i) {
    const arm::JointVector q = draw();
    const arm::JointVector v = draw();
    const arm::Regressor regressor = chain.regressor(q, v, draw());
    for (Index j = 0; j < joints; ++j) {
      // Bodies and armatures.
      rows.block(i * joints, (arm::joint_parameters - 3) * j, joints, arm::joint_parameters - 3) =
          regressor.middleCols(arm::joint_parameters * j, arm::joint_parameters - 3);
    }
  }
  return static_cast<int>(signal::rank(rows, 1e-9));
}

int told_of(const ConsistentFit& fit) {
  const VectorXd firmness = fit.prior_deviations.cwiseInverse();
  const MatrixXd whitened = firmness.asDiagonal() * fit.covariance * firmness.asDiagonal();
  const VectorXd left = signal::symmetric_eigenvalues(whitened);
  return static_cast<int>((left.array() < 0.5).count());
}

std::vector<ArmParameter> parameters_of(const ConsistentFit& fit, const ConsistentFit& nothing, int joint,
                                        const FrictionShape& shape) {
  std::vector<ArmParameter> found;
  struct Row {
    const char* name;
    const char* unit;
    int place;
  };
  static constexpr std::array<Row, 16> rows{{{"mass", "kg", 0},
                                             {"first_moment_x", "kg m", 1},
                                             {"first_moment_y", "kg m", 2},
                                             {"first_moment_z", "kg m", 3},
                                             {"inertia_xx", "kg m^2", 4},
                                             {"inertia_xy", "kg m^2", 5},
                                             {"inertia_xz", "kg m^2", 6},
                                             {"inertia_yy", "kg m^2", 7},
                                             {"inertia_yz", "kg m^2", 8},
                                             {"inertia_zz", "kg m^2", 9},
                                             {"armature", "kg m^2", 10},
                                             {"coulomb", "N m", 11},
                                             {"viscous", "N m s/rad", 12},
                                             {"offset", "N m", 13},
                                             {"load", "", 14},
                                             {"stribeck", "N m", 15}}};
  for (const Row& row : rows) {
    if ((row.place == 14 && !shape.load) || (row.place == 15 && shape.stribeck < 0)) continue;
    const bool own = row.place >= arm::body_parameters;
    const double value =
        own ? fit.local[static_cast<std::size_t>(joint)][static_cast<std::size_t>(row.place - arm::body_parameters)]
            : fit.bodies[arm::body_parameters * joint + row.place];
    const double deviation = fit.deviation(joint, row.place);
    const double before = nothing.deviation(joint, row.place);
    ArmParameter parameter{.name = row.name, .unit = row.unit, .value = value};
    const bool exponential = own && row.place != 13 && row.place != 15;
    const double factor = exponential && value > 0.0 ? std::exp(parameter_normal_95 * deviation / value) : 1.0;
    parameter.lower = exponential ? value / factor : value - parameter_normal_95 * deviation;
    parameter.upper = exponential ? value * factor : value + parameter_normal_95 * deviation;
    parameter.determined =
        exponential ? deviation / value <= 0.5 * before /
                                               nothing.local[static_cast<std::size_t>(joint)]
                                                            [static_cast<std::size_t>(row.place - arm::body_parameters)]
                    : deviation <= 0.5 * before;
    found.push_back(parameter);
  }
  return found;
}

ConsistentFit fit_of_nothing(const std::vector<JointPrior>& priors) {
  const auto columns = static_cast<Index>(arm::body_parameters * priors.size() + local_parameters);
  const JointSums none{MatrixXd::Zero(columns, columns), VectorXd::Zero(columns), 0.0, 1.0};
  return fit_consistently(std::vector<JointSums>(priors.size(), none), priors, std::vector<double>(priors.size(), 1.0),
                          {});
}

}  // namespace tactus::arm_identification
