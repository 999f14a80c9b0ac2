// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/arm_control/effort_limits.hpp>
#include <tactus/kernel/arm_control/motor_watch.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

namespace tactus::arm_control {

MotorWatch::MotorWatch(const Params& params, const arm::Chain::Params& model, const arm::Chain& chain,
                       const arm::Vector3& tool_m, Seconds dt)
    : params_(params),
      chain_(chain),
      tool_m_(tool_m),
      dt_s_(dt.value),
      kept_(std::exp(-2.0 * std::numbers::pi * params.cutoff_Hz * dt.value)),
      coulomb_(JointVector::Zero(chain.joints())),
      limit_(effort_limits(model)),
      velocity_(coulomb_),
      unmoved_(coulomb_),
      residual_(coulomb_),
      inertial_(coulomb_),
      estimate_(coulomb_),
      report_sum_s_(coulomb_),
      motion_sum_s_(coulomb_) {
  for (Eigen::Index i = 0; i < coulomb_.size(); ++i) {
    coulomb_[i] = model.joints[static_cast<std::size_t>(i)].friction.coulomb_N_m;
  }
}

Result<MotorWatch> MotorWatch::make(const Params& params, const arm::Chain::Params& model, const arm::Vector3& tool_m,
                                    Seconds dt) {
  if (Check wrong = signal::check(params, dt)) return *std::move(wrong);
  const double highest_Hz = 0.5 / dt.value;
  if (params.cutoff_Hz > highest_Hz) {
    return out_of_bounds("cutoff_Hz", params.cutoff_Hz, positive_up_to(highest_Hz), units::hertz);
  }
  const auto chain = arm::Chain::make(model);
  if (!chain) return chain.error();
  return MotorWatch(params, model, *chain, tool_m, dt);
}

void MotorWatch::begin() noexcept {
  started_ = false;
  settled_s_ = largest_ = 0.0;
  residual_.setZero();
  inertial_.setZero();
  report_sum_s_.setZero();
  motion_sum_s_.setZero();
  found_ = {};
}

void MotorWatch::observe(const Input& input) noexcept {
  const ArmReading& reading = input.reading;
  const JointVector bias = chain_.bias(reading.position, reading.velocity);
  const JointVector unmoved = reading.torque - bias - chain_.friction(reading.velocity, bias);
  // What happened in a gap is not known; the residual stays what it was.
  if (started_ && input.elapsed_ticks == 1) {
    const JointVector change = chain_.mass_matrix(reading.position) * (reading.velocity - velocity_) / dt_s_;
    residual_ = kept_ * residual_ + (1.0 - kept_) * (change - 0.5 * (unmoved + unmoved_));
    inertial_ = kept_ * inertial_ + (1.0 - kept_) * change;
  }
  started_ = true;
  velocity_ = reading.velocity;
  unmoved_ = unmoved;
}

JointVector MotorWatch::deviations(const ArmReading& reading) noexcept {
  const Eigen::Index joints = chain_.joints();
  const arm::Jacobian tool = chain_.jacobian(reading.position, chain_.joints() - 1, tool_m_);
  const JointVector weight = chain_.gravity_torque(reading.position);
  const auto force = tool.topRows<3>(), moment = tool.bottomRows<3>();
  arm::JointMatrix covariance = params_.contact_force_N * params_.contact_force_N * (force.transpose() * force) +
                                params_.contact_moment_N_m * params_.contact_moment_N_m * (moment.transpose() * moment);
  for (Eigen::Index i = 0; i < joints; ++i) {
    const double of_model = params_.model_share * (std::fabs(weight[i]) + std::fabs(inertial_[i]));
    const double deviation = params_.least_N_m + coulomb_[i] + of_model;
    covariance(i, i) += deviation * deviation;
  }
  const arm::JointMatrix inverse = covariance.llt().solve(arm::JointMatrix(arm::JointMatrix::Identity(joints, joints)));
  const JointVector weighted = inverse * residual_;
  estimate_ = weighted.cwiseQuotient(inverse.diagonal());
  return weighted.cwiseQuotient(inverse.diagonal().cwiseSqrt());
}

void MotorWatch::judge(double& sum_s, double over, MotorFinding what, Eigen::Index joint, double wrong_N_m) noexcept {
  constexpr double fastest = 4.0;
  sum_s = std::max(0.0, sum_s + (std::min(over, fastest) - 1.0) * dt_s_);
  if (sum_s <= params_.lasting_s || found_.what != MotorFinding::none) return;
  found_ = {.what = what,
            .joint = static_cast<std::size_t>(joint),
            .wrong_N_m = wrong_N_m,
            .deviations = what == MotorFinding::acts_otherwise ? over * params_.deviations : 0.0};
}

const MotorWatch::Found& MotorWatch::step(const Input& input) noexcept {
  if (!judges()) return found_;
  if (!input.powered) {
    begin();
    return found_;
  }
  const ArmReading& reading = input.reading;
  if (!reading.position.allFinite() || !reading.velocity.allFinite() || !reading.torque.allFinite()) return found_;
  observe(input);
  const JointVector apart = deviations(reading);
  largest_ = apart.cwiseAbs().maxCoeff();
  const JointVector otherwise_N_m = reading.torque - input.commanded;
  if (!settled()) {
    const double reported = otherwise_N_m.cwiseAbs().cwiseQuotient(params_.report_share * limit_).maxCoeff();
    const bool near = largest_ < 0.5 * params_.deviations && reported < 0.5;
    settled_s_ = near ? settled_s_ + dt_s_ : 0.0;
    return found_;
  }
  Eigen::Index likeliest = 0;
  apart.cwiseAbs().maxCoeff(&likeliest);
  for (Eigen::Index i = 0; i < apart.size(); ++i) {
    judge(report_sum_s_[i], std::fabs(otherwise_N_m[i]) / (params_.report_share * limit_[i]),
          MotorFinding::reports_otherwise, i, otherwise_N_m[i]);
  }
  // One sum for each joint, the likeliest first, so that it is named.
  judge(motion_sum_s_[likeliest], std::fabs(apart[likeliest]) / params_.deviations, MotorFinding::acts_otherwise,
        likeliest, estimate_[likeliest]);
  for (Eigen::Index i = 0; i < apart.size(); ++i) {
    if (i == likeliest) continue;
    judge(motion_sum_s_[i], std::fabs(apart[i]) / params_.deviations, MotorFinding::acts_otherwise, i, estimate_[i]);
  }
  return found_;
}

}  // namespace tactus::arm_control
