// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/motion_information.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

namespace tactus::arm_identification {
namespace {

using arm::joint_parameters;
using arm::JointVector;
using arm::Regressor;
using arm::Vector3;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of a joint among those that the regressor counts: armature, Coulomb friction, viscous friction, offset.
constexpr int regressed_local = joint_parameters - arm::body_parameters;
constexpr double small_turn = 1e-6;  ///< of a position or velocity, for slopes

/// Adds the square of what is beyond ±1, and returns half of its slope.
double beyond(double use, double& squares) {
  const double over = use > 1.0 ? use - 1.0 : use < -1.0 ? use + 1.0 : 0.0;
  squares += over * over;
  return over;
}

/// How far outside of a box, by axis; negative below it.
Vector3 outside(const Vector3& point, const Vector3& lower, const Vector3& upper) {
  return (point - upper).cwiseMax(0.0) + (point - lower).cwiseMin(0.0);
}

}  // namespace

MotionInformation::MotionInformation(const arm::Chain& chain, const ConsistentFit& prior, JointVector noise,
                                     double rows_per_s, MotionLimits limits)
    : chain_(chain), weight_(noise.array().square().inverse()), rows_per_s_(rows_per_s), limits_(std::move(limits)) {
  const Index joints = chain.joints();
  believed_.resize(joint_parameters * joints);
  spread_.resize(believed_.size(), prior.slope.cols());
  for (Index j = 0; j < joints; ++j) {
    const Index to = joint_parameters * j;
    const Index body = arm::body_parameters * j;
    const Index local = prior.bodies.size() + local_parameters * j;
    believed_.segment<arm::body_parameters>(to) = prior.bodies.segment<arm::body_parameters>(body);
    spread_.middleRows<arm::body_parameters>(to) = prior.slope.middleRows<arm::body_parameters>(body);
    for (int k = 0; k < regressed_local; ++k) {
      believed_[to + arm::body_parameters + k] = prior.local[static_cast<std::size_t>(j)][static_cast<std::size_t>(k)];
    }
    spread_.middleRows<regressed_local>(to + arm::body_parameters) = prior.slope.middleRows<regressed_local>(local);
  }
  spread_ *= prior.prior_deviations.head(spread_.cols()).asDiagonal();
}

MatrixXd MotionInformation::whitened(const MatrixXd& normal) const { return spread_.transpose() * normal * spread_; }

double MotionInformation::cost(const VectorXd& coordinates, double period_s, int harmonics, int instants,
                               double firmness, VectorXd* slope) const {
  const Index joints = chain_.joints();
  const Index free = FourierMotion::coordinates(harmonics);
  const Eigen::Map<const MatrixXd> by_joint(coordinates.data(), joints, free);
  struct Instant {
    MatrixXd rows;
    FourierMotion::State state;
    MatrixXd regressor;
    JointVector position_pull, velocity_pull, effort_pull;
  };
  std::vector<Instant> all;
  all.reserve(static_cast<std::size_t>(instants));
  MatrixXd normal = MatrixXd::Zero(believed_.size(), believed_.size());
  const double share = rows_per_s_ * period_s / instants;
  double squares = 0.0;
  const JointVector middle = 0.5 * (limits_.lower + limits_.upper);
  const JointVector half = 0.5 * (limits_.upper - limits_.lower);
  for (int i = 0; i < instants; ++i) {
    Instant at;
    at.rows = FourierMotion::rows(period_s, harmonics, period_s * i / instants);
    at.state = {by_joint * at.rows.row(0).transpose(), by_joint * at.rows.row(1).transpose(),
                by_joint * at.rows.row(2).transpose()};
    const JointVector& q = at.state.position;
    at.regressor = chain_.regressor(q, at.state.velocity, at.state.acceleration);
    const JointVector effort = at.regressor * believed_;
    at.position_pull = at.velocity_pull = at.effort_pull = JointVector::Zero(joints);
    for (Index j = 0; j < joints; ++j) {
      at.position_pull[j] = beyond((q[j] - middle[j]) / half[j], squares) / half[j];
      at.velocity_pull[j] = beyond(at.state.velocity[j] / limits_.velocity[j], squares) / limits_.velocity[j];
      at.effort_pull[j] = beyond(effort[j] / limits_.effort[j], squares) / limits_.effort[j];
    }
    const Joints<arm::LinkPose> poses = chain_.poses(q);
    for (std::size_t j = 0; j < limits_.points.size(); ++j) {
      for (const Vector3& point : limits_.points[j]) {
        const Vector3 out = metre_beyond * outside(poses[j].rotation * point + poses[j].position_m, limits_.box_lower_m,
                                                   limits_.box_upper_m);
        if (out.isZero()) continue;
        squares += out.squaredNorm();
        at.position_pull +=
            metre_beyond * chain_.jacobian(q, static_cast<int>(j), point).topRows<3>().transpose() * out;
      }
    }
    normal.selfadjointView<Eigen::Lower>().rankUpdate(
        (at.regressor.transpose() * weight_.cwiseSqrt().asDiagonal()).eval(), share);
    all.push_back(std::move(at));
  }
  normal.triangularView<Eigen::StrictlyUpper>() = normal.transpose();
  MatrixXd information = whitened(normal);
  information.diagonal().array() += 1.0;
  const Eigen::LLT<MatrixXd> factor(information);
  const double told = 2.0 * factor.matrixLLT().diagonal().array().log().sum();
  const double push = firmness / instants;
  if (slope == nullptr) return push * squares - told;

  // d log|1 + DᵀΛD| = tr(K dΛ) with K = D (1 + DᵀΛD)⁻¹ Dᵀ; Λ is the sum of YᵀWY.
  const MatrixXd uncertain = spread_ * factor.solve(spread_.transpose());
  MatrixXd pull = MatrixXd::Zero(joints, free);
  for (const Instant& at : all) {
    MatrixXd by_regressor = -2.0 * share * (weight_.asDiagonal() * (at.regressor * uncertain));
    by_regressor += 2.0 * push * at.effort_pull * believed_.transpose();
    JointVector by_position = 2.0 * push * at.position_pull;
    JointVector by_velocity = 2.0 * push * at.velocity_pull;
    JointVector by_acceleration(joints);
    for (Index j = 0; j < joints; ++j) {
      FourierMotion::State moved = at.state;
      const auto change = [&](double step) {
        const Regressor there = chain_.regressor(moved.position, moved.velocity, moved.acceleration);
        return (there - at.regressor).cwiseProduct(by_regressor).sum() / step;
      };
      moved.position[j] += small_turn;
      by_position[j] += change(small_turn);
      moved.position[j] = at.state.position[j];
      moved.velocity[j] += small_turn;
      by_velocity[j] += change(small_turn);
      moved.velocity[j] = at.state.velocity[j];
      moved.acceleration[j] += 1.0;  // the regressor is linear in it
      by_acceleration[j] = change(1.0);
    }
    pull += by_position * at.rows.row(0) + by_velocity * at.rows.row(1) + by_acceleration * at.rows.row(2);
  }
  *slope = Eigen::Map<const VectorXd>(pull.data(), pull.size());
  return push * squares - told;
}

MotionUse MotionInformation::use(const FourierMotion& motion, int instants) const {
  const Index joints = chain_.joints();
  const JointVector none = JointVector::Zero(joints);
  MotionUse found{.least = JointVector::Constant(joints, std::numeric_limits<double>::infinity()),
                  .greatest = JointVector::Constant(joints, -std::numeric_limits<double>::infinity()),
                  .velocity = none,
                  .effort = none,
                  .clearance_m = std::numeric_limits<double>::infinity()};
  for (int i = 0; i < instants; ++i) {
    const FourierMotion::State state = motion.at(motion.period_s() * i / instants);
    const JointVector effort = chain_.regressor(state.position, state.velocity, state.acceleration) * believed_;
    found.least = found.least.cwiseMin(state.position);
    found.greatest = found.greatest.cwiseMax(state.position);
    found.velocity = found.velocity.cwiseMax(state.velocity.cwiseAbs());
    found.effort = found.effort.cwiseMax(effort.cwiseAbs());
    const Joints<arm::LinkPose> poses = chain_.poses(state.position);
    for (std::size_t j = 0; j < limits_.points.size(); ++j) {
      for (const Vector3& point : limits_.points[j]) {
        const Vector3 there = poses[j].rotation * point + poses[j].position_m;
        const double room =
            std::min((there - limits_.box_lower_m).minCoeff(), (limits_.box_upper_m - there).minCoeff());
        if (room >= found.clearance_m) continue;
        found.clearance_m = room;
        found.nearest = j;
      }
    }
  }
  found.within = found.clearance_m >= 0.0 && (found.least.array() >= limits_.lower.array()).all() &&
                 (found.greatest.array() <= limits_.upper.array()).all() &&
                 (found.velocity.array() <= limits_.velocity.array()).all() &&
                 (found.effort.array() <= limits_.effort.array()).all();
  return found;
}

std::vector<JointSums> MotionInformation::sums(const FourierMotion& motion, int instants) const {
  const Index joints = chain_.joints();
  const Index bodies = arm::body_parameters * joints;
  std::vector<JointSums> found(static_cast<std::size_t>(joints));
  for (JointSums& own : found) own.normal = MatrixXd::Zero(bodies + local_parameters, bodies + local_parameters);
  const double share = rows_per_s_ * motion.period_s() / instants;
  for (int i = 0; i < instants; ++i) {
    const FourierMotion::State state = motion.at(motion.period_s() * i / instants);
    const Regressor regressor = chain_.regressor(state.position, state.velocity, state.acceleration);
    for (Index j = 0; j < joints; ++j) {
      VectorXd row = VectorXd::Zero(bodies + local_parameters);
      for (Index k = 0; k < joints; ++k) {
        row.segment<arm::body_parameters>(arm::body_parameters * k) =
            regressor.row(j).segment<arm::body_parameters>(joint_parameters * k);
      }
      row.segment<regressed_local>(bodies) =
          regressor.row(j).segment<regressed_local>(joint_parameters * j + arm::body_parameters);
      found[static_cast<std::size_t>(j)].normal += share * row * row.transpose();
    }
  }
  for (Index j = 0; j < joints; ++j) {
    VectorXd own = VectorXd::Zero(bodies + local_parameters);
    for (Index k = 0; k < joints; ++k) {
      own.segment<arm::body_parameters>(arm::body_parameters * k) =
          believed_.segment<arm::body_parameters>(joint_parameters * k);
    }
    own.segment<regressed_local>(bodies) =
        believed_.segment<regressed_local>(joint_parameters * j + arm::body_parameters);
    JointSums& sums = found[static_cast<std::size_t>(j)];
    sums.right = sums.normal * own;
    sums.squares = own.dot(sums.right);
    sums.rows = rows_per_s_ * motion.period_s();
  }
  return found;
}

VectorXd MotionInformation::gains(const FourierMotion& motion, int instants) const {
  MatrixXd normal = MatrixXd::Zero(believed_.size(), believed_.size());
  for (int i = 0; i < instants; ++i) {
    const FourierMotion::State state = motion.at(motion.period_s() * i / instants);
    const MatrixXd regressor = chain_.regressor(state.position, state.velocity, state.acceleration);
    normal += rows_per_s_ * motion.period_s() / instants * regressor.transpose() * weight_.asDiagonal() * regressor;
  }
  return signal::symmetric_eigenvalues(whitened(normal));
}

}  // namespace tactus::arm_identification
