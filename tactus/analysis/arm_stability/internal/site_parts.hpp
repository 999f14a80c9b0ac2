// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>

#include <array>
#include <vector>

#include <Eigen/Core>

/// Recursions of what stands in the sites of two arms, for small signals. Each keeps its state in a stretch of the
/// loop's.
namespace tactus::arm_stability {

/// A stretch of a state.
struct Stretch {
  Eigen::Index at = 0, size = 0;
  [[nodiscard]] auto of(const Eigen::VectorXd& all) const { return all.segment(at, size); }
  [[nodiscard]] auto of(Eigen::VectorXd& all) const { return all.segment(at, size); }
};

/// Hands out the stretches of a state, one behind the other.
class Allotment {
 public:
  Stretch take(Eigen::Index size) {
    const Stretch taken{.at = used_, .size = size};
    used_ += size;
    return taken;
  }
  [[nodiscard]] Eigen::Index used() const { return used_; }

 private:
  Eigen::Index used_ = 0;
};

/// Dampers that stand for the friction laws of each joint at an amplitude of velocity, or for their viscous part alone.
class Rubbing {
 public:
  Rubbing(const arm::Chain::Params& chain, double amplitude_rad_per_s);
  /// Of a motor that sticks and slides.
  [[nodiscard]] const Eigen::VectorXd& of_motors() const { return of_motors_; }
  /// Of the law with tanh(v/v0), as observers have it.
  [[nodiscard]] const Eigen::VectorXd& observed() const { return observed_; }
  /// Of what feed-forward takes for it, with a share of 1.
  [[nodiscard]] Eigen::VectorXd fed_forward(double velocity_rad_per_s) const;
  /// What is left of the observers' law beside feed-forward, as the model of induced motion has it.
  [[nodiscard]] Eigen::VectorXd left(double share, double velocity_rad_per_s) const;

 private:
  double amplitude_;
  Eigen::VectorXd coulomb_, viscous_, of_motors_, observed_;
};

/// First-order low-pass by the bilinear transform, prewarped, on each signal, or none at 0 Hz.
class LinearLowPass {
 public:
  LinearLowPass(const Eigen::VectorXd& cutoff_Hz, double tick_s, Allotment& states);
  [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& input, const Eigen::VectorXd& state,
                                     Eigen::VectorXd& next) const;

 private:
  Eigen::VectorXd there_;  ///< 1 of a signal that has one, else 0
  Eigen::VectorXd b_, a_;
  Stretch state_;
};

/// The observer of external torque of rigid joints: `of_motion` is what the motors' torque has to be for a velocity and
/// position at rest (weight, friction).
class LinearRigidObserver {
 public:
  LinearRigidObserver(const Eigen::VectorXd& cutoff_Hz, double tick_s, const Eigen::MatrixXd& inertia,
                      Allotment& states);
  /// `unmoved` is the motors' torque less weight and friction.
  [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& velocity, const Eigen::VectorXd& unmoved,
                                     const Eigen::VectorXd& state, Eigen::VectorXd& next) const;

 private:
  Eigen::VectorXd kept_;
  double tick_s_;
  Eigen::MatrixXd inertia_;
  Stretch velocity_, unmoved_, estimate_;
};

/// The same of elastic joints: a third-order Butterworth low-pass, whose states are the derivatives that it takes. Each
/// joint's torque is made of the signals of all, behind the low-pass of its own corner.
class LinearElasticObserver {
 public:
  LinearElasticObserver(const Eigen::VectorXd& cutoff_Hz, double tick_s, const Eigen::MatrixXd& link_inertia,
                        const Eigen::VectorXd& armature, const Eigen::VectorXd& joint_stiffness, Allotment& states);
  [[nodiscard]] Eigen::VectorXd step(const Eigen::VectorXd& velocity, const Eigen::VectorXd& unmoved,
                                     const Eigen::VectorXd& state, Eigen::VectorXd& next) const;

 private:
  using Derivatives = std::array<Eigen::VectorXd, 3>;
  /// Of one corner.
  struct LowPass {
    double corner_rad_per_s = 0.0;
    Eigen::Matrix4d tick;  ///< of signal, two derivatives and a held input
    std::array<Stretch, 3> velocity, torque;
    std::vector<Eigen::Index> joints;  ///< that have it

    [[nodiscard]] Derivatives filtered(const std::array<Stretch, 3>& at, const Eigen::VectorXd& mean,
                                       const Eigen::VectorXd& state, Eigen::VectorXd& next) const;
  };

  std::vector<LowPass> low_passes_;
  Eigen::MatrixXd link_inertia_;
  Eigen::VectorXd armature_, softness_;
  Stretch velocity_before_, torque_before_;
};

/// The model of induced motion: trapezoidal rule, friction implicit, slow motion washed out.
class LinearInducedMotion {
 public:
  /// Matrices of all its coordinates, those that are told first; `rubbing` damps these.
  struct Matrices {
    Eigen::MatrixXd inertia, damping, stiffness;
    Eigen::VectorXd rubbing;
  };
  LinearInducedMotion(const Matrices& matrices, double washout_Hz, double tick_s, Eigen::Index told, Allotment& states);
  [[nodiscard]] Eigen::VectorXd position(const Eigen::VectorXd& state) const;
  [[nodiscard]] Eigen::VectorXd velocity(const Eigen::VectorXd& state) const;
  /// To the next tick under `torque` on what is told.
  void step(const Eigen::VectorXd& torque, const Eigen::VectorXd& state, Eigen::VectorXd& next) const;

 private:
  Eigen::MatrixXd keeps_, pulls_, takes_;  ///< of velocity: from velocity, position and torque
  double tick_s_, washed_;
  Stretch position_, velocity_, slow_position_, slow_velocity_;
};

}  // namespace tactus::arm_stability
