// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/data.hpp>

#include <cmath>
#include <utility>

namespace tactus::arm_identification {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ArmData::ArmData(const arm::Chain& chain, std::vector<ArmMotion> motions) : motions_(std::move(motions)) {
  const int count = chain.joints();
  Index all = 0;
  for (const ArmMotion& motion : motions_) all += motion.rows();
  for (MatrixXd* matrix : {&velocity, &acceleration, &effort}) matrix->resize(all, count);
  bodies.assign(static_cast<std::size_t>(count), MatrixXd::Zero(all, arm::body_parameters * count));
  Index first = 0;
  for (const ArmMotion& motion : motions_) {
    const Index own = motion.rows();
    velocity.middleRows(first, own) = motion.velocity;
    acceleration.middleRows(first, own) = motion.acceleration;
    effort.middleRows(first, own) = motion.effort;
    // A joint bears its own body and those beyond it.
    constexpr Index width = arm::body_parameters;
    const MatrixXd found = motion.of_motion(
        width * count * (count + 1) / 2,
        [&](const VectorXd& q, const VectorXd& v, const VectorXd& a, Eigen::Ref<VectorXd> values) {
          const arm::Regressor regressor = chain.regressor(q, v, a);
          Index place = 0;
          for (Index j = 0; j < count; ++j) {
            for (Index k = j; k < count; ++k, place += width) {
              values.segment<width>(place) = regressor.row(j).segment<width>(arm::joint_parameters * k);
            }
          }
        });
    Index place = 0;
    for (Index j = 0; j < count; ++j) {
      for (Index k = j; k < count; ++k, place += width) {
        bodies[static_cast<std::size_t>(j)].block(first, width * k, own, width) = found.middleCols(place, width);
      }
    }
    first += own;
  }
  for (int j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    double squares = 0.0;
    for (const ArmMotion& motion : motions_) {
      squares += motion.speed(j) * motion.speed(j) * static_cast<double>(motion.rows());
    }
    speed.push_back(std::sqrt(squares / static_cast<double>(all)));
    direction.emplace_back(all, static_cast<Index>(directions.size()));
    for (MatrixXd& matrix : slow.emplace_back()) matrix.resize(all, static_cast<Index>(directions.size()));
    for (std::size_t d = 0; d < directions.size(); ++d) {
      const auto column = static_cast<Index>(d);
      const double turning = directions[d] * speed[at];
      direction[at].col(column) = of_velocity(j, [&](double v) { return std::tanh(v / turning); });
      for (std::size_t s = 0; s < slownesses.size(); ++s) {
        const double scale = slownesses[s] * speed[at];
        slow[at][s].col(column) =
            of_velocity(j, [&](double v) { return std::tanh(v / turning) * std::exp(-(v / scale) * (v / scale)); });
      }
    }
  }
}

VectorXd ArmData::of_velocity(int joint, const std::function<double(double)>& law) const {
  VectorXd values(rows());
  Index first = 0;
  for (const ArmMotion& motion : motions_) {
    values.segment(first, motion.rows()) = motion.of_velocity(joint, law);
    first += motion.rows();
  }
  return values;
}

double ArmData::turning_velocity(int joint, const FrictionShape& shape) const {
  return directions[shape.direction] * std::exp(shape.log_change) * speed[static_cast<std::size_t>(joint)];
}

FrictionColumns ArmData::friction(int joint, const FrictionShape& shape, bool slopes) const {
  const auto at = static_cast<std::size_t>(joint);
  const auto place = static_cast<Index>(shape.direction);
  const double turning = turning_velocity(joint, shape);
  FrictionColumns columns{.shape = shape, .turned = {}, .slow = {}, .turned_by_log = {}, .slow_by_log = {}};
  const auto law = [&](double v) { return std::tanh(v / turning); };
  const auto by_log = [&](double v) {
    const double way = std::tanh(v / turning);
    return -(v / turning) * (1.0 - way * way);
  };
  const bool moved = shape.log_change != 0.0;
  columns.turned = moved ? of_velocity(joint, law) : VectorXd(direction[at].col(place));
  if (slopes) columns.turned_by_log = of_velocity(joint, by_log);
  if (shape.stribeck < 0) return columns;
  const auto which = static_cast<std::size_t>(shape.stribeck);
  const double scale = slownesses[which] * speed[at];
  const auto slowly = [&](double v) { return std::exp(-(v / scale) * (v / scale)); };
  columns.slow =
      moved ? of_velocity(joint, [&](double v) { return law(v) * slowly(v); }) : VectorXd(slow[at][which].col(place));
  if (slopes) columns.slow_by_log = of_velocity(joint, [&](double v) { return by_log(v) * slowly(v); });
  return columns;
}

MatrixXd ArmData::local(int joint, const FrictionColumns& law, const VectorXd& rigid,
                        const std::array<double, local_parameters>& own) const {
  const FrictionShape& shape = law.shape;
  MatrixXd columns = MatrixXd::Zero(rows(), local_parameters);
  columns.col(0) = acceleration.col(joint);
  columns.col(1) = law.turned;
  columns.col(2) = velocity.col(joint);
  columns.col(3).setOnes();
  if (shape.load) columns.col(4) = law.turned.cwiseProduct(rigid.cwiseAbs());
  if (shape.stribeck >= 0) columns.col(5) = law.slow;
  if (law.turned_by_log.size() == 0) return columns;
  columns.col(6) = own[1] * law.turned_by_log;
  if (shape.load) columns.col(6) += own[4] * law.turned_by_log.cwiseProduct(rigid.cwiseAbs());
  if (shape.stribeck >= 0) columns.col(6) += own[5] * law.slow_by_log;
  return columns;
}

VectorXd ArmData::rigid_torque(int joint, const ConsistentFit& fit) const {
  const auto at = static_cast<std::size_t>(joint);
  return bodies[at] * fit.bodies + fit.local[at][0] * acceleration.col(joint);
}

VectorXd ArmData::predicted(int joint, const ConsistentFit& fit, const FrictionColumns& law) const {
  const auto at = static_cast<std::size_t>(joint);
  const VectorXd rigid = rigid_torque(joint, fit);
  const Eigen::Map<const VectorXd> own(fit.local[at].data(), local_parameters);
  const MatrixXd columns = local(joint, law, rigid, fit.local[at]);
  return fit.scales[at] * (rigid + columns.rightCols(local_parameters - 1) * own.tail(local_parameters - 1));
}

}  // namespace tactus::arm_identification
