// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/arm_stability/linear_arm.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <optional>

namespace tactus::arm_stability {

/// What of two arms that are not linear a loop stands for.
struct ArmLinearisation {
  /// Amplitude V of every joint's velocity at which a friction law is replaced by its describing function, Coulomb's f
  /// by 4 f / (π V), in rad/s; 0 leaves it out.
  double friction_speed_rad_per_s = 0.0;
  /// Contact force about which a surface of a curved law is taken as straight, in N. Without it such a one is refused.
  std::optional<double> preload_N = std::nullopt;
};

/// Two arms with their sites as `experiments::ArmPair` has them, for small motions about the start of `setup`, the
/// follower's tool in touch with the wall all the time: drives, buses that are a tick late, the message of the follower
/// that is a tick late, limits at the tool, damping, observer or sensor, low-passes, feed-forward of weight and
/// friction, and with cancellation the model of induced motion with its washout. Arms are continuous and held exactly
/// from tick to tick (matrix exponential), sites work at the ticks.
///
/// Left out: contact that breaks, steps of the drives, saturation, the observer's dead band, the operator's slow
/// correction, the curvature that a steady force adds. Coulomb friction is left out, or replaced by a damper in the
/// arms, in what observers and feed-forward take for it, and in the model (`ArmLinearisation`).
class ArmLoop {
 public:
  /// Errors: `inconsistent`, under `control.method`, for a method whose loop has not been made linear, and under
  /// `wall.law` for a curved law without a preload; those of the parts. Not real-time safe.
  static Result<ArmLoop> make(const experiments::ArmPairSetup& setup, const experiments::ArmModelParams& model_params,
                              const ArmLinearisation& linearisation = {});

  /// The loop opened where the torque is displayed, at the ticks: displayed torque of each joint in, torque that the
  /// leader receives, behind its low-pass, out. The gain closes it.
  [[nodiscard]] const stability::StateSpace& open() const { return open_; }
  /// What a tick makes of the state, at this force gain.
  [[nodiscard]] Eigen::MatrixXd closed(double force_gain) const { return open_.a + force_gain * open_.b * open_.c; }

  /// Velocities of the links of an arm in a state, real or complex: what moves in a mode.
  template <class State>
  [[nodiscard]] State leader_velocity(const State& state) const {
    return leader_velocity_ * state.segment(leader_at_, leader_velocity_.cols());
  }
  template <class State>
  [[nodiscard]] State follower_velocity(const State& state) const {
    return follower_velocity_ * state.segment(follower_at_, follower_velocity_.cols());
  }
  /// Mass matrices at the pose, without what the tool carries.
  [[nodiscard]] const Eigen::MatrixXd& leader_inertia() const { return leader_inertia_; }
  [[nodiscard]] const Eigen::MatrixXd& follower_inertia() const { return follower_inertia_; }
  [[nodiscard]] double tick_s() const { return tick_s_; }
  /// Of the surface, for small motions.
  [[nodiscard]] double wall_stiffness_N_per_m() const { return wall_stiffness_N_per_m_; }

 private:
  stability::StateSpace open_;
  Eigen::MatrixXd leader_velocity_, follower_velocity_;  ///< of links, out of the states of an arm
  Eigen::Index leader_at_ = 0, follower_at_ = 0;         ///< where those begin
  Eigen::MatrixXd leader_inertia_, follower_inertia_;
  double tick_s_ = 0.0;
  double wall_stiffness_N_per_m_ = 0.0;
};

}  // namespace tactus::arm_stability
