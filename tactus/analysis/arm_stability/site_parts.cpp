// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/arm_stability/internal/site_parts.hpp>
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/matrix_functions.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace tactus::arm_stability {
namespace {

using Vector = Eigen::VectorXd;

/// Describing function of tanh(v/v0) at amplitude V, in s/rad: mean over a swing.
double turning_round(double v0, double amplitude) {
  constexpr int points = 400;
  double sum = 0.0;
  for (int i = 0; i < points; ++i) {
    const double sine = std::sin(std::numbers::pi * (i + 0.5) / points);
    sum += std::tanh(amplitude * sine / v0) * sine;
  }
  return 2.0 * sum / points / amplitude;
}

}  // namespace

Rubbing::Rubbing(const arm::Chain::Params& chain, double amplitude_rad_per_s)
    : amplitude_(amplitude_rad_per_s),
      coulomb_(static_cast<Eigen::Index>(chain.joints.size())),
      viscous_(coulomb_.size()) {
  Vector observed(coulomb_.size());
  for (Eigen::Index i = 0; i < coulomb_.size(); ++i) {
    const arm::JointFriction& friction = chain.joints[static_cast<std::size_t>(i)].friction;
    coulomb_[i] = amplitude_ > 0.0 ? friction.coulomb_N_m : 0.0;
    viscous_[i] = friction.viscous_N_m_s_per_rad;
    observed[i] = amplitude_ > 0.0 ? turning_round(friction.velocity_scale_rad_per_s, amplitude_) : 0.0;
  }
  of_motors_ = viscous_;
  if (amplitude_ > 0.0) of_motors_ += 4.0 / (std::numbers::pi * amplitude_) * coulomb_;
  observed_ = viscous_ + coulomb_.cwiseProduct(observed);
}

Vector Rubbing::fed_forward(double velocity_rad_per_s) const {
  const double slope = amplitude_ > 0.0 ? turning_round(velocity_rad_per_s, amplitude_) : 0.0;
  return viscous_ + slope * coulomb_;
}

Vector Rubbing::left(double share, double velocity_rad_per_s) const {
  return (observed_ - share * fed_forward(velocity_rad_per_s)).cwiseMax(0.0);
}

LinearLowPass::LinearLowPass(const Vector& cutoff_Hz, double tick_s, Allotment& states)
    : there_((cutoff_Hz.array() > 0.0).cast<double>()),
      b_(Vector::Ones(cutoff_Hz.size())),
      a_(Vector::Zero(cutoff_Hz.size())) {
  if ((there_.array() > 0.0).any()) state_ = states.take(cutoff_Hz.size());
  for (Eigen::Index i = 0; i < cutoff_Hz.size(); ++i) {
    if (cutoff_Hz[i] == 0.0) continue;
    const double k = std::tan(std::numbers::pi * cutoff_Hz[i] * tick_s);
    b_[i] = k / (1.0 + k);
    a_[i] = (k - 1.0) / (k + 1.0);
  }
}

Vector LinearLowPass::step(const Vector& input, const Vector& state, Vector& next) const {
  if (state_.size == 0) return input;
  const Vector output = b_.cwiseProduct(input) + state_.of(state);
  state_.of(next) = there_.cwiseProduct(b_.cwiseProduct(input) - a_.cwiseProduct(output));
  return output;
}

LinearRigidObserver::LinearRigidObserver(const Vector& cutoff_Hz, double tick_s, const Eigen::MatrixXd& inertia,
                                         Allotment& states)
    : kept_((-2.0 * std::numbers::pi * tick_s * cutoff_Hz).array().exp()),
      tick_s_(tick_s),
      inertia_(inertia),
      velocity_(states.take(inertia.rows())),
      unmoved_(states.take(inertia.rows())),
      estimate_(states.take(inertia.rows())) {}

Vector LinearRigidObserver::step(const Vector& velocity, const Vector& unmoved, const Vector& state,
                                 Vector& next) const {
  const Vector pushed = inertia_ * (velocity - velocity_.of(state)) / tick_s_ - 0.5 * (unmoved + unmoved_.of(state));
  const Vector estimate = kept_.cwiseProduct(estimate_.of(state)) + (1.0 - kept_.array()).matrix().cwiseProduct(pushed);
  velocity_.of(next) = velocity;
  unmoved_.of(next) = unmoved;
  estimate_.of(next) = estimate;
  return estimate;
}

LinearElasticObserver::LinearElasticObserver(const Vector& cutoff_Hz, double tick_s,
                                             const Eigen::MatrixXd& link_inertia, const Vector& armature,
                                             const Vector& joint_stiffness, Allotment& states)
    : link_inertia_(link_inertia), armature_(armature), softness_(joint_stiffness.cwiseInverse()) {
  const Eigen::Index n = armature.size();
  for (Eigen::Index joint = 0; joint < n; ++joint) {
    const double w = 2.0 * std::numbers::pi * cutoff_Hz[joint];
    const auto same = std::find_if(low_passes_.begin(), low_passes_.end(),
                                   [w](const LowPass& one) { return one.corner_rad_per_s == w; });
    if (same != low_passes_.end()) {
      same->joints.push_back(joint);
      continue;
    }
    LowPass added{.corner_rad_per_s = w, .tick = {}, .velocity = {}, .torque = {}, .joints = {joint}};
    for (Stretch& one : added.velocity) one = states.take(n);
    for (Stretch& one : added.torque) one = states.take(n);
    Eigen::Matrix<double, 4, 4, Eigen::RowMajor> tick;
    tick << 0, 1, 0, 0, 0, 0, 1, 0, -w * w * w, -2.0 * w * w, -2.0 * w, w * w * w, 0, 0, 0, 0;
    tick *= tick_s;
    signal::exponentiate({tick.data(), 16}, 4);
    added.tick = tick;
    low_passes_.push_back(std::move(added));
  }
  velocity_before_ = states.take(n);
  torque_before_ = states.take(n);
}

LinearElasticObserver::Derivatives LinearElasticObserver::LowPass::filtered(const std::array<Stretch, 3>& at,
                                                                            const Vector& mean, const Vector& state,
                                                                            Vector& next) const {
  Derivatives found;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    found[i] = tick(row, 3) * mean;
    for (std::size_t j = 0; j < 3; ++j) found[i] += tick(row, static_cast<Eigen::Index>(j)) * at[j].of(state);
    at[i].of(next) = found[i];
  }
  return found;
}

Vector LinearElasticObserver::step(const Vector& velocity, const Vector& unmoved, const Vector& state,
                                   Vector& next) const {
  const Vector mean_velocity = 0.5 * (velocity_before_.of(state) + velocity);
  const Vector mean_torque = 0.5 * (torque_before_.of(state) + unmoved);
  velocity_before_.of(next) = velocity;
  torque_before_.of(next) = unmoved;
  Vector external(velocity.size());
  for (const LowPass& low_pass : low_passes_) {
    const Derivatives v = low_pass.filtered(low_pass.velocity, mean_velocity, state, next);
    const Derivatives t = low_pass.filtered(low_pass.torque, mean_torque, state, next);
    const double w = low_pass.corner_rad_per_s;
    const Vector third = w * w * w * (velocity - v[0]) - 2.0 * w * w * v[1] - 2.0 * w * v[2];
    const Vector of_joints = t[0] - armature_.cwiseProduct(v[1]);
    const Vector of_joints_twice = t[2] - armature_.cwiseProduct(third);
    const Vector all = link_inertia_ * (v[1] - softness_.cwiseProduct(of_joints_twice)) - of_joints;
    for (const Eigen::Index joint : low_pass.joints) external[joint] = all[joint];
  }
  return external;
}

LinearInducedMotion::LinearInducedMotion(const Matrices& m, double washout_Hz, double tick_s, Eigen::Index told,
                                         Allotment& states)
    : tick_s_(tick_s),
      washed_(1.0 - std::exp(-2.0 * std::numbers::pi * washout_Hz * tick_s)),
      position_(states.take(m.inertia.rows())),
      velocity_(states.take(m.inertia.rows())),
      slow_position_(states.take(told)),
      slow_velocity_(states.take(told)) {
  const Eigen::MatrixXd half = 0.5 * tick_s * m.damping + 0.25 * tick_s * tick_s * m.stiffness;
  Eigen::MatrixXd left = m.inertia + half;
  left.topLeftCorner(told, told) += Eigen::MatrixXd(tick_s * Vector(m.rubbing).asDiagonal());
  const Eigen::MatrixXd inverse = signal::inverse_of_definite(left);
  keeps_ = inverse * (m.inertia - half);
  pulls_ = -tick_s * inverse * m.stiffness;
  takes_ = tick_s * inverse.leftCols(told);
}

Vector LinearInducedMotion::position(const Vector& state) const {
  return position_.of(state).head(slow_position_.size) - slow_position_.of(state);
}

Vector LinearInducedMotion::velocity(const Vector& state) const {
  return velocity_.of(state).head(slow_velocity_.size) - slow_velocity_.of(state);
}

void LinearInducedMotion::step(const Vector& torque, const Vector& state, Vector& next) const {
  const Vector before = velocity_.of(state);
  const Vector velocity = keeps_ * before + pulls_ * position_.of(state) + takes_ * torque;
  const Vector position = position_.of(state) + 0.5 * tick_s_ * (before + velocity);
  const auto washed_out = [this, &state, &next](const Stretch& slow, const Vector& now) {
    slow.of(next) = slow.of(state) + washed_ * (now.head(slow.size) - slow.of(state));
  };
  velocity_.of(next) = velocity;
  position_.of(next) = position;
  washed_out(slow_position_, position);
  washed_out(slow_velocity_, velocity);
}

}  // namespace tactus::arm_stability
