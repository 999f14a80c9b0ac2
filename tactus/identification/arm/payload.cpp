// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/internal/urdf_residual.hpp>
#include <tactus/identification/arm/payload.hpp>
#include <tactus/identification/arm/rows_fit.hpp>
#include <tactus/kernel/signal/decompositions.hpp>

#include <algorithm>

namespace tactus::arm_identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double farthest_payload_m = 2.0;

}  // namespace

std::optional<Payload> find_payload(const ArmData& data, const arm::Chain::Params& urdf) {
  constexpr Index shared = 4;       // mass, and mass times centre
  constexpr Index own_columns = 3;  // no offset: it would take the place of the weight
  constexpr double clearly = 0.25;  // of the squares that are left, of those without the payload
  const Index count = data.joints();
  const Index size = shared + own_columns * count;
  const MatrixXd needed = torques_of(data, without_armatures(urdf), as_stated(urdf).position_of);
  MatrixXd normal = MatrixXd::Zero(size, size);
  VectorXd right = VectorXd::Zero(size);
  std::vector<MatrixXd> columns;
  for (Index j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    const VectorXd effort = data.effort.col(j);
    const double weight = 1.0 / effort.squaredNorm();
    MatrixXd all(data.rows(), shared + own_columns);
    all << data.bodies[at].middleCols(arm::body_parameters * (count - 1), shared), data.acceleration.col(j),
        data.friction(static_cast<int>(j), {}, false).turned, data.velocity.col(j);
    const MatrixXd sums = weight * all.transpose() * all;
    const VectorXd with = weight * all.transpose() * (effort - needed.col(j));
    const Index place = shared + own_columns * j;
    normal.topLeftCorner(shared, shared) += sums.topLeftCorner(shared, shared);
    normal.block(0, place, shared, own_columns) = sums.topRightCorner(shared, own_columns);
    normal.block(place, 0, own_columns, shared) = sums.bottomLeftCorner(own_columns, shared);
    normal.block(place, place, own_columns, own_columns) = sums.bottomRightCorner(own_columns, own_columns);
    right.head(shared) += with.head(shared);
    right.segment(place, own_columns) = with.tail(own_columns);
    columns.push_back(std::move(all));
  }
  VectorXd length = normal.diagonal().cwiseSqrt();
  for (double& one : length) one = one > 0.0 ? 1.0 / one : 0.0;
  MatrixXd scaled = length.asDiagonal() * normal * length.asDiagonal();
  scaled.diagonal().array() += 1e-9;
  const VectorXd found = length.asDiagonal() * signal::solve_definite(scaled, VectorXd(length.asDiagonal() * right));
  Payload payload{.mass_kg = found[0]};
  if (!(payload.mass_kg > 0.0)) return std::nullopt;
  payload.centre_m = found.segment<3>(1) / payload.mass_kg;
  if (payload.centre_m.norm() > farthest_payload_m) return std::nullopt;
  const std::vector<double> without = left_with(data, needed, as_stated(urdf), true, false);
  payload.left_without = *std::max_element(without.begin(), without.end());
  double squares = 0.0;
  for (Index j = 0; j < count; ++j) {
    VectorXd own(shared + own_columns);
    own << found.head(shared), found.segment(shared + own_columns * j, own_columns);
    const VectorXd left = data.effort.col(j) - needed.col(j) - columns[static_cast<std::size_t>(j)] * own;
    const double share = rms(left) / rms(data.effort.col(j));
    payload.left = std::max(payload.left, share);
    squares += share * share;
  }
  if (payload.left_without < much_left || payload.left > much_left) return std::nullopt;
  // Offsets of the efforts that explain nearly as much are the simpler reason.
  const double by_offsets = total(left_with(data, needed, as_stated(urdf), true));
  if (squares > clearly * std::min(total(without), by_offsets)) return std::nullopt;
  return payload;
}

}  // namespace tactus::arm_identification
