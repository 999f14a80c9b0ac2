#include <tactus/arm_identification/data.hpp>

#include <cmath>

namespace tactus::arm_identification {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

ArmData::ArmData(const arm::Chain& chain, std::span<const ArmMotion> motions) {
  const int count = chain.joints();
  Index rows = 0;
  for (const ArmMotion& motion : motions) rows += motion.rows();
  for (MatrixXd* matrix : {&velocity, &acceleration, &effort}) matrix->resize(rows, count);
  for (int j = 0; j < count; ++j) {
    double squares = 0.0;
    for (const ArmMotion& motion : motions) {
      squares += motion.speed(j) * motion.speed(j) * static_cast<double>(motion.rows());
    }
    speed.push_back(std::sqrt(squares / static_cast<double>(rows)));
    bodies.emplace_back(rows, arm::body_parameters * count);
    direction.emplace_back(rows, static_cast<Index>(directions.size()));
    for (MatrixXd& matrix : slow.emplace_back()) matrix.resize(rows, static_cast<Index>(directions.size()));
  }
  Index first = 0;
  for (const ArmMotion& motion : motions) {
    const Index own = motion.rows();
    velocity.middleRows(first, own) = motion.velocity;
    acceleration.middleRows(first, own) = motion.acceleration;
    effort.middleRows(first, own) = motion.effort;
    for (Index i = 0; i < own; ++i) {
      const arm::Regressor regressor =
          chain.regressor(motion.position.row(i), motion.velocity.row(i), motion.acceleration.row(i));
      for (int j = 0; j < count; ++j) {
        for (int k = 0; k < count; ++k) {
          bodies[static_cast<std::size_t>(j)].row(first + i).segment<arm::body_parameters>(arm::body_parameters * k) =
              regressor.row(j).segment<arm::body_parameters>(arm::joint_parameters * k);
        }
      }
    }
    for (int j = 0; j < count; ++j) {
      const auto at = static_cast<std::size_t>(j);
      for (std::size_t d = 0; d < directions.size(); ++d) {
        const arm::JointFriction friction{.velocity_scale_rad_per_s = directions[d] * speed[at]};
        direction[at].col(static_cast<Index>(d)).segment(first, own) =
            motion.of_velocity(j, [&](double v) { return friction.direction(v); });
        for (std::size_t s = 0; s < slownesses.size(); ++s) {
          const double scale = slownesses[s] * speed[at];
          slow[at][s].col(static_cast<Index>(d)).segment(first, own) = motion.of_velocity(
              j, [&](double v) { return friction.direction(v) * std::exp(-(v / scale) * (v / scale)); });
        }
      }
    }
    first += own;
  }
}

MatrixXd ArmData::local(int joint, const FrictionShape& shape, const VectorXd& rigid) const {
  const auto at = static_cast<std::size_t>(joint);
  const auto turned = direction[at].col(static_cast<Index>(shape.direction));
  MatrixXd columns(rows(), local_parameters);
  columns.col(0) = acceleration.col(joint);
  columns.col(1) = turned;
  columns.col(2) = velocity.col(joint);
  columns.col(3).setOnes();
  columns.col(4).setZero();
  if (shape.load) columns.col(4) = turned.cwiseProduct(rigid.cwiseAbs());
  columns.col(5).setZero();
  if (shape.stribeck >= 0) {
    columns.col(5) = slow[at][static_cast<std::size_t>(shape.stribeck)].col(static_cast<Index>(shape.direction));
  }
  return columns;
}

VectorXd ArmData::rigid_torque(int joint, const ConsistentFit& fit) const {
  const auto at = static_cast<std::size_t>(joint);
  return bodies[at] * fit.bodies + fit.local[at][0] * acceleration.col(joint);
}

VectorXd ArmData::predicted(int joint, const ConsistentFit& fit, const FrictionShape& shape) const {
  const auto at = static_cast<std::size_t>(joint);
  const VectorXd rigid = rigid_torque(joint, fit);
  const Eigen::Map<const VectorXd> own(fit.local[at].data(), local_parameters);
  const MatrixXd columns = local(joint, shape, rigid);
  return fit.scales[at] * (rigid + columns.rightCols(local_parameters - 1) * own.tail(local_parameters - 1));
}

}  // namespace tactus::arm_identification
