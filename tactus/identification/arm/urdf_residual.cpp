// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/internal/urdf_residual.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace tactus::arm_identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Columns that every joint has of its own: acceleration, direction, velocity, 1. The first three cannot be negative.
constexpr Index own_columns = 4;

}  // namespace

MatrixXd products(const ArmData& data, const MatrixXd& torques, int motion_of, int effort_of) {
  MatrixXd all(data.rows(), torques.cols() + own_columns + 1);
  all << torques, data.acceleration.col(motion_of), data.friction(motion_of, {}, false).turned,
      data.velocity.col(motion_of), VectorXd::Ones(data.rows()), data.effort.col(effort_of);
  return all.transpose() * all;
}

double left_of(const MatrixXd& products_of_all, const VectorXd& mix, double sign, bool torques, bool offset) {
  const Index count = mix.size();
  MatrixXd into = MatrixXd::Zero(own_columns + 2, products_of_all.cols());
  into.row(0).head(count) = mix.transpose();
  into.block(1, count, own_columns, own_columns).setIdentity();
  into(own_columns + 1, count + own_columns) = sign;
  // Torques with their own scale go to the effort's side.
  if (torques) into.row(own_columns + 1).head(count) = -mix.transpose();
  const MatrixXd sums = into * products_of_all * into.transpose();
  const double squares = products_of_all(count + own_columns, count + own_columns);
  const Index target = own_columns + 1;
  std::vector<Index> used;
  for (Index k = torques ? 1 : 0; k < own_columns + 1; ++k) {
    if (sums(k, k) > 0.0 && (offset || k < own_columns)) used.push_back(k);
  }
  while (!used.empty()) {
    const auto size = static_cast<Index>(used.size());
    MatrixXd normal(size, size);
    VectorXd right(size), length(size);
    for (Index a = 0; a < size; ++a)
      length[a] = std::sqrt(sums(used[static_cast<std::size_t>(a)], used[static_cast<std::size_t>(a)]));
    for (Index a = 0; a < size; ++a) {
      const Index row = used[static_cast<std::size_t>(a)];
      right[a] = sums(row, target) / length[a];
      for (Index b = 0; b < size; ++b) {
        normal(a, b) = sums(row, used[static_cast<std::size_t>(b)]) / (length[a] * length[b]);
      }
      normal(a, a) += 1e-9;
    }
    const VectorXd found = signal::solve_definite(normal, right);
    Index worst = -1;
    for (Index a = 0; a < size; ++a) {
      const bool any_sign = used[static_cast<std::size_t>(a)] == own_columns;  // the offset
      if (!any_sign && found[a] < 0.0 && (worst < 0 || found[a] < found[worst])) worst = a;
    }
    if (worst < 0) return std::max(0.0, sums(target, target) - found.dot(right)) / std::max(squares, 1e-300);
    used.erase(used.begin() + worst);
  }
  return sums(target, target) / std::max(squares, 1e-300);
}

MatrixXd torques_of(const ArmData& data, const arm::Chain::Params& urdf, const std::vector<int>& position_of) {
  const arm::Chain chain = *arm::Chain::make(urdf);
  const auto count = static_cast<Index>(position_of.size());
  MatrixXd all(data.rows(), count);
  Index first = 0;
  for (const ArmMotion& motion : data.motions()) {
    all.middleRows(first, motion.rows()) = motion.of_motion(
        count, [&](const VectorXd& q, const VectorXd& v, const VectorXd& a, Eigen::Ref<VectorXd> values) {
          arm::JointVector position(count), velocity(count), acceleration(count);
          for (Index j = 0; j < count; ++j) {
            const auto from = static_cast<Index>(position_of[static_cast<std::size_t>(j)]);
            position[j] = q[from], velocity[j] = v[from], acceleration[j] = a[from];
          }
          // What armatures the URDF has is in the joint's own columns.
          values = chain.inverse_dynamics(position, velocity, acceleration);
        });
    first += motion.rows();
  }
  return all;
}

arm::Chain::Params without_armatures(arm::Chain::Params urdf) {
  for (arm::JointParams& joint : urdf.joints) joint.drive = {};
  return urdf;
}

double total(const std::vector<double>& shares) {
  return std::accumulate(shares.begin(), shares.end(), 0.0, [](double sum, double s) { return sum + s * s; });
}

std::vector<double> left_with(const ArmData& data, const MatrixXd& needed, const Assumption& assumption, bool torques,
                              bool offset) {
  std::vector<double> left;
  for (int j = 0; j < data.joints(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const MatrixXd sums = products(data, needed.col(j), assumption.position_of[at], assumption.effort_of[at]);
    left.push_back(std::sqrt(left_of(sums, VectorXd::Ones(1), assumption.effort_sign[at], torques, offset)));
  }
  return left;
}

}  // namespace tactus::arm_identification
