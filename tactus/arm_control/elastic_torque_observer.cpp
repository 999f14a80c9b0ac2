#include <tactus/arm_control/elastic_torque_observer.hpp>
#include <tactus/signal/checks.hpp>
#include <tactus/signal/matrix_functions.hpp>

#include <array>
#include <cstddef>
#include <numbers>

namespace tactus::arm_control {

ElasticTorqueObserver::ElasticTorqueObserver(const arm::Chain& model, const JointVector& armature,
                                             const JointVector& joint_stiffness, double cutoff_rad_per_s, Seconds dt)
    : model_(model),
      armature_(armature),
      softness_(joint_stiffness.cwiseInverse()),
      cutoff_rad_per_s_(cutoff_rad_per_s),
      velocity_(Filtered::Zero(model.joints(), 3)),
      torque_(velocity_),
      velocity_before_(JointVector::Zero(model.joints())),
      torque_before_(velocity_before_) {
  // Signal, first and second derivative, and an input that is held.
  const double w = cutoff_rad_per_s;
  constexpr std::size_t states = 4;
  std::array<double, states * states> matrix{0, 1, 0, 0, 0, 0, 1, 0, -w * w * w, -2.0 * w * w, -2.0 * w, w * w * w};
  for (double& element : matrix) element *= dt.value;
  signal::exponentiate(matrix, states);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      // Transposed, for signals that stand in rows.
      kept_(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(i)) = matrix[states * i + j];
    }
    let_in_[static_cast<Eigen::Index>(i)] = matrix[states * i + 3];
  }
}

Result<ElasticTorqueObserver> ElasticTorqueObserver::make(const Params& params, const arm::Chain::Params& arm,
                                                          const JointVector& joint_stiffness, Seconds dt) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  if (Check wrong = signal::check_below_nyquist("cutoff_Hz", params.cutoff_Hz, dt)) return *std::move(wrong);
  const auto chain = arm::Chain::make(arm);
  if (!chain) return chain.error();
  if (Check wrong = check_stiffness(joint_stiffness, chain->joints())) return *std::move(wrong);
  JointVector armature(chain->joints());
  for (Eigen::Index i = 0; i < armature.size(); ++i) {
    armature[i] = arm.joints[static_cast<std::size_t>(i)].drive.reflected_kg_m2();
  }
  return ElasticTorqueObserver(*chain, armature, joint_stiffness, 2.0 * std::numbers::pi * params.cutoff_Hz, dt);
}

JointVector ElasticTorqueObserver::third_derivative(const Filtered& filtered, const JointVector& input) const noexcept {
  const double w = cutoff_rad_per_s_;
  return w * (w * (w * (input - filtered.col(0)) - 2.0 * filtered.col(1)) - 2.0 * filtered.col(2));
}

JointVector ElasticTorqueObserver::step(const ArmReading& reading) noexcept {
  const JointVector bias = model_.bias(reading.position, reading.velocity);
  const JointVector torque = reading.torque - bias - model_.friction(reading.velocity, bias);
  if (!started_) {
    velocity_ = Filtered::Zero(torque.size(), 3);
    torque_ = velocity_;
    velocity_.col(0) = reading.velocity;
    velocity_before_ = reading.velocity;
    torque_before_ = JointVector::Zero(torque.size());
    started_ = true;
    return torque_before_;
  }
  velocity_ = Filtered(velocity_ * kept_ + 0.5 * (velocity_before_ + reading.velocity) * let_in_);
  torque_ = Filtered(torque_ * kept_ + 0.5 * (torque_before_ + torque) * let_in_);
  velocity_before_ = reading.velocity;
  torque_before_ = torque;

  arm::JointMatrix links = model_.mass_matrix(reading.position);
  links.diagonal() -= armature_;
  // Less c and gravity, which the motors carry through the springs.
  const JointVector of_joints = torque_.col(0) - armature_.cwiseProduct(velocity_.col(1));
  const JointVector of_joints_twice =
      torque_.col(2) - armature_.cwiseProduct(third_derivative(velocity_, reading.velocity));
  return links * (velocity_.col(1) - softness_.cwiseProduct(of_joints_twice)) - of_joints;
}

}  // namespace tactus::arm_control
