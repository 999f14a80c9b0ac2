// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/rows_fit.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Core>

namespace tactus::arm_identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int choosing_rounds = 2;  ///< in which it is chosen where to look for v0
constexpr int terms_round = 3;      ///< after which it is chosen what friction has beside
constexpr int least_rounds = 6;
constexpr int most_rounds = 12;
constexpr double longest_turn = 0.7;    ///< of log(v0) in a round
constexpr double turned_enough = 0.02;  ///< of log(v0)
constexpr double usual_turning = 0.03;  ///< v0 as a share of the rms speed
constexpr double least_turning = 0.001;
constexpr double most_turning = 1.0;
constexpr int folds = 4;
constexpr double worthwhile = 0.98;  ///< of the error: what a further friction term must bring it to

JointSums sums_of(const MatrixXd& bodies, const MatrixXd& local, const VectorXd& effort) {
  const Index own = bodies.cols();
  JointSums sums;
  sums.normal.resize(own + local.cols(), own + local.cols());
  sums.normal.topLeftCorner(own, own) = bodies.transpose() * bodies;
  sums.normal.topRightCorner(own, local.cols()) = bodies.transpose() * local;
  sums.normal.bottomLeftCorner(local.cols(), own) = sums.normal.topRightCorner(own, local.cols()).transpose();
  sums.normal.bottomRightCorner(local.cols(), local.cols()) = local.transpose() * local;
  sums.right.resize(own + local.cols());
  sums.right << bodies.transpose() * effort, local.transpose() * effort;
  sums.squares = effort.squaredNorm();
  sums.rows = static_cast<double>(effort.size());
  return sums;
}

/// How many rows in a row say about the same: 1 + 2·(sum of the autocorrelation), as long as that is there.
double correlation_of(const VectorXd& residual) {
  const double squares = residual.squaredNorm();
  double sum = 1.0;
  for (Index lag = 1; lag < residual.size() / 20 && squares > 0.0; ++lag) {
    const double rho = residual.head(residual.size() - lag).dot(residual.tail(residual.size() - lag)) / squares;
    if (rho < 0.05) break;
    sum += 2.0 * rho;
  }
  return sum;
}

/// What is left of `right` where each of four blocks is judged by the fit of the other three.
double cross_validated(const MatrixXd& columns, const VectorXd& right) {
  double squares = 0.0;
  const Index rows = right.size();
  for (Index fold = 0; fold < folds; ++fold) {
    const Index first = rows * fold / folds;
    const Index count = rows * (fold + 1) / folds - first;
    MatrixXd others(rows - count, columns.cols());
    VectorXd others_right(rows - count);
    others << columns.topRows(first), columns.bottomRows(rows - first - count);
    others_right << right.head(first), right.tail(rows - first - count);
    const VectorXd found = signal::solve_least_squares(others, others_right);
    squares += (right.segment(first, count) - columns.middleRows(first, count) * found).squaredNorm();
  }
  return std::sqrt(squares / static_cast<double>(rows));
}

/// What a shape of friction leaves of what the bodies leave, cross-validated.
double shape_error(const ArmData& data, int joint, const ConsistentFit& fit, RowSpan span, const FrictionShape& shape) {
  const VectorXd rigid = data.rigid_torque(joint, fit);
  const VectorXd left =
      (data.effort.col(joint) / fit.scales[static_cast<std::size_t>(joint)] - rigid).segment(span.first, span.count);
  const MatrixXd all =
      data.local(joint, data.friction(joint, shape, false), rigid, {}).middleRows(span.first, span.count);
  std::vector<Index> used{1, 2, 3};
  if (shape.load) used.push_back(4);
  if (shape.stribeck >= 0) used.push_back(5);
  MatrixXd columns(span.count, static_cast<Index>(used.size()));
  for (std::size_t i = 0; i < used.size(); ++i) columns.col(static_cast<Index>(i)) = all.col(used[i]);
  return cross_validated(columns, left);
}

/// Where to begin to look for v0.
FrictionShape choose_direction(const ArmData& data, int joint, const ConsistentFit& fit, RowSpan span) {
  FrictionShape best;
  double least = shape_error(data, joint, fit, span, best);
  for (std::size_t d = 0; d < ArmData::directions.size(); ++d) {
    const double error = shape_error(data, joint, fit, span, {.direction = d});
    if (error >= least) continue;
    least = error;
    best.direction = d;
  }
  return best;
}

/// The shape with what is worth having beside, once v0 is about right: a wrong one looks like an excess.
FrictionShape choose_terms(const ArmData& data, int joint, const ConsistentFit& fit, RowSpan span, FrictionShape best) {
  double least = shape_error(data, joint, fit, span, best);
  const auto consider = [&](const FrictionShape& shape) {
    const double error = shape_error(data, joint, fit, span, shape);
    if (error >= worthwhile * least) return;
    least = error;
    best = shape;
  };
  FrictionShape with_load = best;
  with_load.load = true;
  consider(with_load);
  FrictionShape with_excess = best;
  for (int s = 0; s < static_cast<int>(ArmData::slownesses.size()); ++s) {
    with_excess.stribeck = s;
    consider(with_excess);
  }
  return best;
}

/// Moves v0 of every joint by what the fit says that it is off.
void turn(const ArmData& data, RowsFit& fit) {
  for (std::size_t j = 0; j < fit.friction.size(); ++j) {
    FrictionShape shape = fit.friction[j].shape;
    const double chosen = std::log(ArmData::directions[shape.direction]);
    const double step = std::clamp(fit.found.local[j][6], -longest_turn, longest_turn);
    shape.log_change =
        std::clamp(shape.log_change + step, std::log(least_turning) - chosen, std::log(most_turning) - chosen);
    fit.friction[j] = data.friction(static_cast<int>(j), shape, true);
  }
}

}  // namespace

double rms(const VectorXd& values) { return std::sqrt(values.squaredNorm() / static_cast<double>(values.size())); }

RowsFit fit_rows(const ArmData& data, RowSpan span, std::vector<JointPrior> priors, bool scales_known) {
  const int count = data.joints();
  RowsFit fit;
  std::vector<double> noise;
  std::vector<double> correlation(static_cast<std::size_t>(count), 1.0);
  for (int j = 0; j < count; ++j) {
    noise.push_back(0.1 * rms(data.effort.col(j).segment(span.first, span.count)) + 1e-12);
    fit.friction.push_back(data.friction(j, {}, false));
  }
  if (scales_known) {
    for (JointPrior& prior : priors) prior.scale_deviation = 0.0;
  }
  std::vector<VectorXd> rigid(static_cast<std::size_t>(count), VectorXd::Zero(data.rows()));
  fit.found.local.resize(static_cast<std::size_t>(count));
  for (int round = 0; round < most_rounds; ++round) {
    const bool choosing = round < choosing_rounds;
    std::vector<JointSums> sums;
    for (int j = 0; j < count; ++j) {
      const auto at = static_cast<std::size_t>(j);
      const FrictionShape& shape = fit.friction[at].shape;
      const MatrixXd local = data.local(j, fit.friction[at], rigid[at], fit.found.local[at]);
      priors[at].load = shape.load;
      priors[at].stribeck = shape.stribeck >= 0;
      priors[at].turning = !choosing;
      priors[at].turning_log = std::log(usual_turning / ArmData::directions[shape.direction]) - shape.log_change;
      sums.push_back(sums_of(data.bodies[at].middleRows(span.first, span.count),
                             local.middleRows(span.first, span.count),
                             data.effort.col(j).segment(span.first, span.count)));
    }
    fit.found = fit_consistently(sums, priors, noise, correlation);
    for (int j = 0; j < count; ++j) {
      const auto at = static_cast<std::size_t>(j);
      rigid[at] = data.rigid_torque(j, fit.found);
      const VectorXd left = residual_of(data, fit, j, span);
      noise[at] = std::max(rms(left), 1e-6 * rms(data.effort.col(j)) + 1e-12);
      correlation[at] = correlation_of(left);
      if (choosing) {
        const FrictionShape shape = choose_direction(data, j, fit.found, span);
        fit.friction[at] = data.friction(j, shape, round + 1 == choosing_rounds);
      }
    }
    if (choosing) continue;
    // The last round's own step stays a number beside the columns, small enough to be linear.
    double most = 0.0;
    for (const auto& own : fit.found.local) most = std::max(most, std::fabs(own[6]));
    if ((round + 1 >= least_rounds && most < turned_enough) || round + 1 == most_rounds) {
      // Of one that does not settle no more is believed than a round may move it.
      for (auto& own : fit.found.local) own[6] = std::clamp(own[6], -longest_turn, longest_turn);
      break;
    }
    turn(data, fit);
    if (round != terms_round) continue;
    for (int j = 0; j < count; ++j) {
      FrictionColumns& friction = fit.friction[static_cast<std::size_t>(j)];
      friction = data.friction(j, choose_terms(data, j, fit.found, span, friction.shape), true);
    }
  }
  return fit;
}

VectorXd residual_of(const ArmData& data, const RowsFit& fit, int joint, RowSpan span) {
  return (data.effort.col(joint) - data.predicted(joint, fit.found, fit.friction[static_cast<std::size_t>(joint)]))
      .segment(span.first, span.count);
}

std::vector<double> ordinary_least_squares(const ArmData& data, RowSpan seen, RowSpan judged) {
  const Index count = data.joints();
  const Index body = data.bodies.front().cols();
  const Index own = 4;
  const FrictionShape shape{.direction = 0};
  MatrixXd normal = MatrixXd::Zero(body + own * count, body + own * count);
  VectorXd right = VectorXd::Zero(normal.rows());
  std::vector<MatrixXd> locals;
  for (Index j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    locals.push_back(data.local(static_cast<int>(j), data.friction(static_cast<int>(j), shape, false),
                                VectorXd::Zero(data.rows()), {})
                         .leftCols(own));
    const JointSums sums =
        sums_of(data.bodies[at].middleRows(seen.first, seen.count), locals.back().middleRows(seen.first, seen.count),
                data.effort.col(j).segment(seen.first, seen.count));
    const Index place = body + own * j;
    normal.topLeftCorner(body, body) += sums.normal.topLeftCorner(body, body);
    normal.block(0, place, body, own) = sums.normal.topRightCorner(body, own);
    normal.block(place, 0, own, body) = sums.normal.bottomLeftCorner(own, body);
    normal.block(place, place, own, own) = sums.normal.bottomRightCorner(own, own);
    right.head(body) += sums.right.head(body);
    right.segment(place, own) = sums.right.tail(own);
  }
  VectorXd lengths = normal.diagonal().cwiseSqrt();
  for (double& length : lengths) length = length > 0.0 ? 1.0 / length : 0.0;
  const MatrixXd scaled = lengths.asDiagonal() * normal * lengths.asDiagonal();
  const signal::SymmetricEigen eigen = signal::symmetric_eigen(scaled);
  const double least = 1e-9 * eigen.values.maxCoeff();
  const VectorXd inverse = eigen.values.unaryExpr([=](double v) { return v > least ? 1.0 / v : 0.0; });
  const VectorXd found =
      lengths.asDiagonal() *
      (eigen.vectors * (inverse.asDiagonal() * (eigen.vectors.transpose() * (lengths.asDiagonal() * right))));
  std::vector<double> relative;
  for (Index j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const VectorXd effort = data.effort.col(j).segment(judged.first, judged.count);
    const VectorXd left = effort - data.bodies[at].middleRows(judged.first, judged.count) * found.head(body) -
                          locals[at].middleRows(judged.first, judged.count) * found.segment(body + own * j, own);
    relative.push_back(rms(left) / rms(effort));
  }
  return relative;
}

}  // namespace tactus::arm_identification
