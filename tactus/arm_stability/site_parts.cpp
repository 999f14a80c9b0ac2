#include <tactus/arm_stability/internal/site_parts.hpp>
#include <tactus/signal/decompositions.hpp>
#include <tactus/signal/matrix_functions.hpp>

#include <array>
#include <cmath>
#include <numbers>

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

LinearLowPass::LinearLowPass(double cutoff_Hz, double tick_s, Eigen::Index signals, Allotment& states)
    : there_(cutoff_Hz > 0.0), state_(states.take(cutoff_Hz > 0.0 ? signals : 0)) {
  if (!there_) return;
  const double k = std::tan(std::numbers::pi * cutoff_Hz * tick_s);
  b_ = k / (1.0 + k);
  a_ = (k - 1.0) / (k + 1.0);
}

Vector LinearLowPass::step(const Vector& input, const Vector& state, Vector& next) const {
  if (!there_) return input;
  const Vector output = b_ * input + state_.of(state);
  state_.of(next) = b_ * input - a_ * output;
  return output;
}

LinearRigidObserver::LinearRigidObserver(double cutoff_Hz, double tick_s, const Eigen::MatrixXd& inertia,
                                         Allotment& states)
    : kept_(std::exp(-2.0 * std::numbers::pi * cutoff_Hz * tick_s)),
      tick_s_(tick_s),
      inertia_(inertia),
      velocity_(states.take(inertia.rows())),
      unmoved_(states.take(inertia.rows())),
      estimate_(states.take(inertia.rows())) {}

Vector LinearRigidObserver::step(const Vector& velocity, const Vector& unmoved, const Vector& state,
                                 Vector& next) const {
  const Vector pushed = inertia_ * (velocity - velocity_.of(state)) / tick_s_ - 0.5 * (unmoved + unmoved_.of(state));
  const Vector estimate = kept_ * estimate_.of(state) + (1.0 - kept_) * pushed;
  velocity_.of(next) = velocity;
  unmoved_.of(next) = unmoved;
  estimate_.of(next) = estimate;
  return estimate;
}

LinearElasticObserver::LinearElasticObserver(double cutoff_Hz, double tick_s, const Eigen::MatrixXd& link_inertia,
                                             const Vector& armature, const Vector& joint_stiffness, Allotment& states)
    : corner_(2.0 * std::numbers::pi * cutoff_Hz),
      link_inertia_(link_inertia),
      armature_(armature),
      softness_(joint_stiffness.cwiseInverse()) {
  const Eigen::Index n = armature.size();
  for (Stretch& one : velocity_) one = states.take(n);
  for (Stretch& one : torque_) one = states.take(n);
  velocity_before_ = states.take(n);
  torque_before_ = states.take(n);
  const double w = corner_;
  Eigen::Matrix<double, 4, 4, Eigen::RowMajor> tick;
  tick << 0, 1, 0, 0, 0, 0, 1, 0, -w * w * w, -2.0 * w * w, -2.0 * w, w * w * w, 0, 0, 0, 0;
  tick *= tick_s;
  signal::exponentiate({tick.data(), 16}, 4);
  tick_ = tick;
}

LinearElasticObserver::Derivatives LinearElasticObserver::filtered(const std::array<Stretch, 3>& at,
                                                                   const Stretch& before, const Vector& input,
                                                                   const Vector& state, Vector& next) const {
  Derivatives found;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    found[i] = 0.5 * tick_(row, 3) * (before.of(state) + input);
    for (std::size_t j = 0; j < 3; ++j) found[i] += tick_(row, static_cast<Eigen::Index>(j)) * at[j].of(state);
    at[i].of(next) = found[i];
  }
  before.of(next) = input;
  return found;
}

Vector LinearElasticObserver::step(const Vector& velocity, const Vector& unmoved, const Vector& state,
                                   Vector& next) const {
  const Derivatives v = filtered(velocity_, velocity_before_, velocity, state, next);
  const Derivatives t = filtered(torque_, torque_before_, unmoved, state, next);
  const double w = corner_;
  const Vector third = w * w * w * (velocity - v[0]) - 2.0 * w * w * v[1] - 2.0 * w * v[2];
  const Vector of_joints = t[0] - armature_.cwiseProduct(v[1]);
  const Vector of_joints_twice = t[2] - armature_.cwiseProduct(third);
  return link_inertia_ * (v[1] - softness_.cwiseProduct(of_joints_twice)) - of_joints;
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
