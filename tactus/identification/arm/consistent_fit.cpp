// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/consistent_fit.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Dense>

namespace tactus::arm_identification {
namespace {

using arm::body_parameters;
using arm::Matrix3;
using Eigen::Index;
using Eigen::Matrix4d;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double log_mass_deviation = 0.75;  // of half its logarithm
constexpr double gyration_deviation = 1.2;
constexpr double centre_deviation = 1.5;
constexpr double least_gyration_m = 0.01;
constexpr double log_armature_deviation = 1.5;
constexpr double log_friction_deviation = 2.0;
constexpr double log_turning_deviation = 1.5;
constexpr double usual_load_share = 0.02;
constexpr double known = 1e-9;
constexpr int most_fit_steps = 1000;
constexpr double longest_step = 1.0;  ///< of any coordinate, in deviations of the prior
constexpr double settled = 1e-3;      ///< gain of the sum of squares over the noise's that tells nothing any more

// Places among the coordinates of a body: half the logarithm of the mass, three of the gyration, three shears, and the
// centre.
constexpr int at_mass = 0;
constexpr int at_gyration = 1;
constexpr int at_shear = 4;
constexpr int at_centre = 7;

using BodyCoordinates = Eigen::Matrix<double, body_parameters, 1>;

Matrix4d factor_of(const BodyCoordinates& x) {
  Matrix4d u = Matrix4d::Zero();
  for (int i = 0; i < 3; ++i) {
    u(i, i) = std::exp(x[at_gyration + i]);
    u(i, 3) = x[at_centre + i];
  }
  u(0, 1) = x[at_shear];
  u(1, 2) = x[at_shear + 1];
  u(0, 2) = x[at_shear + 2];
  u(3, 3) = 1.0;
  return std::exp(x[at_mass]) * u;
}

/// The ten numbers of a body from its pseudo-inertia [∫rrᵀ dm, ∫r dm; ·, m].
arm::BodyVector body_from(const Matrix4d& p) {
  const Matrix3 moments = p.topLeftCorner<3, 3>();
  const Matrix3 inertia = moments.trace() * Matrix3::Identity() - moments;
  arm::BodyVector body;
  body << p(3, 3), p(0, 3), p(1, 3), p(2, 3), inertia(0, 0), inertia(0, 1), inertia(0, 2), inertia(1, 1), inertia(1, 2),
      inertia(2, 2);
  return body;
}

/// Slope of the ten numbers by the ten coordinates.
Eigen::Matrix<double, body_parameters, body_parameters> body_slope(const BodyCoordinates& x) {
  const Matrix4d u = factor_of(x);
  const double size = std::exp(x[at_mass]);
  Eigen::Matrix<double, body_parameters, body_parameters> slope;
  for (int k = 0; k < body_parameters; ++k) {
    Matrix4d du = Matrix4d::Zero();
    if (k == at_mass) du = u;
    if (k >= at_gyration && k < at_shear) du(k - at_gyration, k - at_gyration) = u(k - at_gyration, k - at_gyration);
    if (k == at_shear) du(0, 1) = size;
    if (k == at_shear + 1) du(1, 2) = size;
    if (k == at_shear + 2) du(0, 2) = size;
    if (k >= at_centre) du(k - at_centre, 3) = size;
    const Matrix4d half = du * u.transpose();
    slope.col(k) = body_from(half + half.transpose());
  }
  return slope;
}

/// Coordinates of a body, thickened to `least_gyration_m` where it is thinner: a point has no logarithm.
BodyCoordinates coordinates_of(const arm::Body& body) {
  const arm::BodyVector b = arm::linear_parameters(body);
  const double mass = std::max(b[0], 1e-6);
  Matrix3 inertia;
  inertia << b[4], b[5], b[6], b[5], b[7], b[8], b[6], b[8], b[9];
  Matrix3 moments = (0.5 * inertia.trace() * Matrix3::Identity() - inertia) / mass;
  const arm::Vector3 centre = b.segment<3>(1) / mass;
  moments -= centre * centre.transpose();
  Eigen::SelfAdjointEigenSolver<Matrix3> solver(moments);
  const arm::Vector3 thick = solver.eigenvalues().cwiseMax(least_gyration_m * least_gyration_m);
  moments = solver.eigenvectors() * thick.asDiagonal() * solver.eigenvectors().transpose();
  // Upper triangular: the lower factor of the matrix with its order turned round.
  const Matrix3 lower = Eigen::LLT<Matrix3>(moments.reverse()).matrixL();
  const Matrix3 upper = lower.reverse();
  BodyCoordinates x;
  x << 0.5 * std::log(mass), std::log(upper(0, 0)), std::log(upper(1, 1)), std::log(upper(2, 2)), upper(0, 1),
      upper(1, 2), upper(0, 2), centre;
  return x;
}

struct Problem {
  const std::vector<JointSums>& sums;
  std::vector<double> noise;
  const std::vector<JointPrior>& priors;
  VectorXd centre;      ///< of the prior
  VectorXd deviations;  ///< of the prior
  Index joints;

  [[nodiscard]] Index bodies() const { return body_parameters * joints; }
  [[nodiscard]] Index size() const { return (joint_coordinates + 1) * joints; }
};

/// Physical parameters: bodies first, then the local ones of each joint.
VectorXd parameters_of(const Problem& problem, const VectorXd& x) {
  VectorXd found((joint_coordinates)*problem.joints);
  for (Index j = 0; j < problem.joints; ++j) {
    const Index at = joint_coordinates * j;
    const Matrix4d u = factor_of(x.segment<body_parameters>(at));
    found.segment<body_parameters>(body_parameters * j) = body_from(u * u.transpose());
    const JointPrior& prior = problem.priors[static_cast<std::size_t>(j)];
    const auto local = x.segment<local_parameters>(at + body_parameters);
    found.segment<local_parameters>(problem.bodies() + local_parameters * j) << std::exp(local[0]), std::exp(local[1]),
        std::exp(local[2]), local[3], prior.load ? std::exp(local[4]) : 0.0, prior.stribeck ? local[5] : 0.0,
        prior.turning ? local[6] : 0.0;
  }
  return found;
}

/// Slope of the parameters by the coordinates, scales left out.
MatrixXd slope_of(const Problem& problem, const VectorXd& x, const VectorXd& parameters) {
  MatrixXd slope = MatrixXd::Zero(parameters.size(), parameters.size());
  for (Index j = 0; j < problem.joints; ++j) {
    const Index at = joint_coordinates * j;
    slope.block<body_parameters, body_parameters>(body_parameters * j, at) = body_slope(x.segment<body_parameters>(at));
    const Index row = problem.bodies() + local_parameters * j;
    for (const int k : {0, 1, 2, 4}) slope(row + k, at + body_parameters + k) = parameters[row + k];
    slope(row + 3, at + body_parameters + 3) = 1.0;
    slope(row + 5, at + body_parameters + 5) = problem.priors[static_cast<std::size_t>(j)].stribeck ? 1.0 : 0.0;
    slope(row + 6, at + body_parameters + 6) = problem.priors[static_cast<std::size_t>(j)].turning ? 1.0 : 0.0;
  }
  return slope;
}

/// The parameters of the columns of one joint.
VectorXd own_parameters(const Problem& problem, const VectorXd& parameters, Index joint) {
  VectorXd own(problem.bodies() + local_parameters);
  own << parameters.head(problem.bodies()),
      parameters.segment(problem.bodies() + local_parameters * joint, local_parameters);
  return own;
}

double squares_left(const JointSums& sums, const VectorXd& own, double scale) {
  return std::max(0.0, sums.squares - 2.0 * scale * own.dot(sums.right) + scale * scale * own.dot(sums.normal * own));
}

double cost_of(const Problem& problem, const VectorXd& x) {
  const VectorXd parameters = parameters_of(problem, x);
  double cost = ((x - problem.centre).array() / problem.deviations.array()).square().sum();
  for (Index j = 0; j < problem.joints; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const double scale = std::exp(x[joint_coordinates * problem.joints + j]);
    cost += squares_left(problem.sums[at], own_parameters(problem, parameters, j), scale) /
            (problem.noise[at] * problem.noise[at]);
  }
  return cost;
}

/// Half of the cost's curvature without its second derivatives, and half of its negative slope.
std::pair<MatrixXd, VectorXd> normal_equations(const Problem& problem, const VectorXd& x) {
  const VectorXd parameters = parameters_of(problem, x);
  const Index all = parameters.size();
  const Index bodies = problem.bodies();
  MatrixXd curvature = MatrixXd::Zero(problem.size(), problem.size());
  VectorXd pull = VectorXd::Zero(problem.size());
  MatrixXd normal = MatrixXd::Zero(all, all);
  VectorXd right = VectorXd::Zero(all);
  MatrixXd with_scale = MatrixXd::Zero(all, problem.joints);
  for (Index j = 0; j < problem.joints; ++j) {
    const JointSums& sums = problem.sums[static_cast<std::size_t>(j)];
    const double weight =
        1.0 / (problem.noise[static_cast<std::size_t>(j)] * problem.noise[static_cast<std::size_t>(j)]);
    const Index place = joint_coordinates * problem.joints + j;
    const double scale = std::exp(x[place]);
    const VectorXd own = own_parameters(problem, parameters, j);
    const VectorXd seen = sums.normal * own;
    const VectorXd left = sums.right - scale * seen;
    const Index local = bodies + local_parameters * j;
    const auto add = [&](VectorXd& to, const VectorXd& from, double factor) {
      to.head(bodies) += factor * from.head(bodies);
      to.segment(local, local_parameters) += factor * from.tail(local_parameters);
    };
    add(right, left, weight * scale);
    VectorXd mixed = VectorXd::Zero(all);
    add(mixed, seen, weight * scale * scale);
    with_scale.col(j) = mixed;
    const double factor = weight * scale * scale;
    normal.topLeftCorner(bodies, bodies) += factor * sums.normal.topLeftCorner(bodies, bodies);
    normal.block(0, local, bodies, local_parameters) += factor * sums.normal.topRightCorner(bodies, local_parameters);
    normal.block(local, 0, local_parameters, bodies) += factor * sums.normal.bottomLeftCorner(local_parameters, bodies);
    normal.block(local, local, local_parameters, local_parameters) +=
        factor * sums.normal.bottomRightCorner(local_parameters, local_parameters);
    curvature(place, place) = factor * own.dot(seen);
    pull[place] = weight * scale * own.dot(left);
  }
  const MatrixXd slope = slope_of(problem, x, parameters);
  curvature.topLeftCorner(all, all) = slope.transpose() * normal * slope;
  curvature.topRightCorner(all, problem.joints) = slope.transpose() * with_scale;
  curvature.bottomLeftCorner(problem.joints, all) = curvature.topRightCorner(all, problem.joints).transpose();
  pull.head(all) = slope.transpose() * right;
  const VectorXd firmness = problem.deviations.array().square().inverse();
  curvature.diagonal() += firmness;
  pull += firmness.cwiseProduct(problem.centre - x);
  return {std::move(curvature), std::move(pull)};
}

Problem problem_of(const std::vector<JointSums>& sums, const std::vector<JointPrior>& priors,
                   const std::vector<double>& noise) {
  Problem problem{sums, noise, priors, {}, {}, static_cast<Index>(sums.size())};
  problem.centre.resize(problem.size());
  problem.deviations.resize(problem.size());
  for (Index j = 0; j < problem.joints; ++j) {
    const JointPrior& prior = priors[static_cast<std::size_t>(j)];
    const Index at = joint_coordinates * j;
    const BodyCoordinates body = coordinates_of(prior.body);
    const double gyration = std::exp(body.segment<3>(at_gyration).mean());
    problem.centre.segment<body_parameters>(at) = body;
    auto deviations = problem.deviations.segment<body_parameters>(at);
    deviations[at_mass] = log_mass_deviation;
    deviations.segment<3>(at_gyration).setConstant(gyration_deviation);
    deviations.segment<3>(at_shear).setConstant(gyration_deviation * gyration);
    deviations.segment<3>(at_centre).setConstant(centre_deviation * gyration);
    problem.centre.segment<local_parameters>(at + body_parameters) << std::log(prior.armature), std::log(prior.coulomb),
        std::log(prior.viscous), 0.0, std::log(usual_load_share), 0.0, prior.turning ? prior.turning_log : 0.0;
    problem.deviations.segment<local_parameters>(at + body_parameters) << log_armature_deviation,
        log_friction_deviation, log_friction_deviation, prior.torque, prior.load ? log_friction_deviation : known,
        prior.stribeck ? prior.torque : known, prior.turning ? log_turning_deviation : known;
    problem.centre[joint_coordinates * problem.joints + j] = std::log(prior.scale);
    problem.deviations[joint_coordinates * problem.joints + j] = std::max(known, prior.scale_deviation);
  }
  return problem;
}

}  // namespace

double ConsistentFit::deviation(int joint, int k) const {
  const Index at = joint_coordinates * joint;
  if (k >= body_parameters) {
    // Exponentials but for offset, excess and the turning round.
    const int own = k - body_parameters;
    const double steepness =
        own == 3 || own >= 5 ? 1.0 : local[static_cast<std::size_t>(joint)][static_cast<std::size_t>(own)];
    return std::fabs(steepness) * std::sqrt(covariance(at + k, at + k));
  }
  const VectorXd by_coordinate = body_slope(coordinates.segment<body_parameters>(at)).row(k);
  return std::sqrt(by_coordinate.dot(covariance.block<body_parameters, body_parameters>(at, at) * by_coordinate));
}

double ConsistentFit::scale_deviation(int joint) const {
  const Index at = joint_coordinates * static_cast<Index>(scales.size()) + joint;
  return std::sqrt(covariance(at, at));
}

VectorXd ConsistentFit::prediction_deviation(int joint, const MatrixXd& columns) const {
  const auto at = static_cast<std::size_t>(joint);
  const Index place = bodies.size() + local_parameters * joint;
  MatrixXd by_coordinate = MatrixXd::Zero(columns.rows(), coordinates.size());
  by_coordinate.leftCols(slope.cols()) =
      scales[at] * (columns.leftCols(bodies.size()) * slope.topRows(bodies.size()) +
                    columns.rightCols(local_parameters) * slope.middleRows(place, local_parameters));
  const Eigen::Map<const VectorXd> own(local[at].data(), local_parameters);
  by_coordinate.col(slope.cols() + joint) =
      scales[at] * (columns.leftCols(bodies.size()) * bodies + columns.rightCols(local_parameters) * own);
  return (by_coordinate * covariance).cwiseProduct(by_coordinate).rowwise().sum().cwiseMax(0.0).cwiseSqrt();
}

ConsistentFit fit_consistently(const std::vector<JointSums>& sums, const std::vector<JointPrior>& priors,
                               const std::vector<double>& noise, const std::vector<double>& correlation) {
  Problem problem = problem_of(sums, priors, noise);
  VectorXd x = problem.centre;
  double cost = cost_of(problem, x);
  double damping = 1e-3;
  for (int step = 0; step < most_fit_steps; ++step) {
    const auto [curvature, pull] = normal_equations(problem, x);
    bool better = false;
    double gained = 0.0;
    while (!better && damping < 1e12) {
      MatrixXd damped = curvature;
      damped.diagonal() *= 1.0 + damping;
      VectorXd onward = signal::solve_definite(damped, pull);
      const double longest = onward.cwiseQuotient(problem.deviations).cwiseAbs().maxCoeff();
      if (longest > longest_step) onward *= longest_step / longest;
      const VectorXd next = x + onward;
      const double tried = next.allFinite() ? cost_of(problem, next) : std::numeric_limits<double>::infinity();
      better = tried <= cost;
      if (!better) {
        damping *= 5.0;
        continue;
      }
      gained = cost - tried;
      x = next;
      cost = tried;
      damping = std::max(1e-9, damping / 5.0);
    }
    if (!better || gained <= settled) break;
  }

  ConsistentFit fit;
  fit.coordinates = x;
  fit.prior_deviations = problem.deviations;
  for (std::size_t j = 0; j < correlation.size(); ++j) problem.noise[j] *= std::sqrt(correlation[j]);
  const MatrixXd curvature = normal_equations(problem, x).first;
  fit.covariance = signal::inverse_of_definite(curvature);
  const VectorXd parameters = parameters_of(problem, x);
  fit.slope = slope_of(problem, x, parameters);
  fit.bodies = parameters.head(problem.bodies());
  for (Index j = 0; j < problem.joints; ++j) {
    auto& local = fit.local.emplace_back();
    for (int k = 0; k < local_parameters; ++k) {
      local[static_cast<std::size_t>(k)] = parameters[problem.bodies() + local_parameters * j + k];
    }
    fit.scales.push_back(std::exp(x[joint_coordinates * problem.joints + j]));
    const JointSums& own = sums[static_cast<std::size_t>(j)];
    fit.residual_rms.push_back(
        std::sqrt(squares_left(own, own_parameters(problem, parameters, j), fit.scales.back()) / own.rows));
  }
  return fit;
}

}  // namespace tactus::arm_identification
