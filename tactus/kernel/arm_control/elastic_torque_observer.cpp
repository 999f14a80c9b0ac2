// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/elastic_torque_observer.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/matrix_functions.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <vector>

namespace tactus::arm_control {

ElasticTorqueObserver::Filter::Filter() = default;

ElasticTorqueObserver::Filter::Filter(double cutoff_Hz, Seconds dt)
    : corner_rad_per_s(2.0 * std::numbers::pi * cutoff_Hz) {
  // Signal, first and second derivative, and an input that is held.
  const double w = corner_rad_per_s;
  constexpr std::size_t states = 4;
  std::array<double, states * states> matrix{0, 1, 0, 0, 0, 0, 1, 0, -w * w * w, -2.0 * w * w, -2.0 * w, w * w * w};
  for (double& element : matrix) element *= dt.value;
  signal::exponentiate(matrix, states);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      // Transposed, for signals that stand in rows.
      kept(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) = matrix[states * i + j];
    }
    let_in[static_cast<Eigen::Index>(i)] = matrix[states * i + 3];
  }
}

void ElasticTorqueObserver::Filter::start(const JointVector& at_velocity) noexcept {
  velocity = Filtered::Zero(at_velocity.size(), 3);
  torque = velocity;
  velocity.col(0) = at_velocity;
}

void ElasticTorqueObserver::Filter::step(const JointVector& mean_velocity, const JointVector& mean_torque) noexcept {
  velocity = Filtered(velocity * kept + mean_velocity * let_in);
  torque = Filtered(torque * kept + mean_torque * let_in);
}

JointVector ElasticTorqueObserver::Filter::third_derivative(const JointVector& of_velocity) const noexcept {
  const double w = corner_rad_per_s;
  return w * (w * (w * (of_velocity - velocity.col(0)) - 2.0 * velocity.col(1)) - 2.0 * velocity.col(2));
}

ElasticTorqueObserver::ElasticTorqueObserver(const arm::Chain& model, const JointVector& armature,
                                             const JointVector& joint_stiffness, const JointVector& cutoff_Hz,
                                             Seconds dt)
    : model_(model),
      armature_(armature),
      softness_(joint_stiffness.cwiseInverse()),
      of_joint_(static_cast<std::size_t>(model.joints())),
      velocity_before_(JointVector::Zero(model.joints())),
      torque_before_(velocity_before_) {
  std::vector<double> corners_Hz;
  for (std::size_t i = 0; i < of_joint_.size(); ++i) {
    const auto same = std::find(corners_Hz.begin(), corners_Hz.end(), cutoff_Hz[static_cast<Eigen::Index>(i)]);
    of_joint_[i] = static_cast<std::size_t>(same - corners_Hz.begin());
    if (same == corners_Hz.end()) corners_Hz.push_back(cutoff_Hz[static_cast<Eigen::Index>(i)]);
  }
  filters_ = Joints<Filter>(corners_Hz.size());
  for (std::size_t i = 0; i < corners_Hz.size(); ++i) filters_[i] = Filter(corners_Hz[i], dt);
}

Result<ElasticTorqueObserver> ElasticTorqueObserver::make(const Params& params, const arm::Chain::Params& arm,
                                                          const JointVector& joint_stiffness, Seconds dt) {
  const auto chain = arm::Chain::make(arm);
  if (!chain) return chain.error();
  const auto each_Hz = corners(params, chain->joints(), dt);
  if (!each_Hz) return each_Hz.error();
  if (Check wrong = check_stiffness(joint_stiffness, chain->joints())) return *std::move(wrong);
  JointVector armature(chain->joints());
  for (Eigen::Index i = 0; i < armature.size(); ++i) {
    armature[i] = arm.joints[static_cast<std::size_t>(i)].drive.reflected_kg_m2();
  }
  return ElasticTorqueObserver(*chain, armature, joint_stiffness, *each_Hz, dt);
}

JointVector ElasticTorqueObserver::step(const ArmReading& reading) noexcept {
  const JointVector bias = model_.bias(reading.position, reading.velocity);
  const JointVector torque = reading.torque - bias - model_.friction(reading.velocity, bias);
  if (!started_) {
    for (Filter& filter : filters_) filter.start(reading.velocity);
    velocity_before_ = reading.velocity;
    torque_before_ = JointVector::Zero(torque.size());
    started_ = true;
    return torque_before_;
  }
  const JointVector mean_velocity = 0.5 * (velocity_before_ + reading.velocity);
  const JointVector mean_torque = 0.5 * (torque_before_ + torque);
  velocity_before_ = reading.velocity;
  torque_before_ = torque;

  arm::JointMatrix links = model_.mass_matrix(reading.position);
  links.diagonal() -= armature_;
  JointVector external(torque.size());
  for (std::size_t which = 0; which < filters_.size(); ++which) {
    Filter& filter = filters_[which];
    filter.step(mean_velocity, mean_torque);
    // Less c and gravity, which the motors carry through the springs.
    const JointVector of_joints = filter.torque.col(0) - armature_.cwiseProduct(filter.velocity.col(1));
    const JointVector of_joints_twice =
        filter.torque.col(2) - armature_.cwiseProduct(filter.third_derivative(reading.velocity));
    const JointVector all = links * (filter.velocity.col(1) - softness_.cwiseProduct(of_joints_twice)) - of_joints;
    for (std::size_t i = 0; i < of_joint_.size(); ++i) {
      if (of_joint_[i] == which) external[static_cast<Eigen::Index>(i)] = all[static_cast<Eigen::Index>(i)];
    }
  }
  return external;
}

}  // namespace tactus::arm_control
