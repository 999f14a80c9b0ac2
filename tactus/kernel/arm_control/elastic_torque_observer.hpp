// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/external_torque_observer.hpp>
#include <tactus/kernel/arm_control/joint_model.hpp>

namespace tactus::arm_control {

/// External torque of an arm with elastic joints, from its motors alone. Motors (armature B) and links (the rest of the
/// mass matrix, M) are joined by springs K, so that
///
///     B·θ̈ = τ − friction − τ_J,     M·q̈ + c + gravity = τ_J + τ_ext,     q = θ − K⁻¹·τ_J,
///
/// and all but τ_ext follows from motor torque τ and motor velocity θ̇ by derivatives:
///
///     r = F(s)·( M·(θ̈ − K⁻¹·s²·τ_J) + c + gravity − τ_J ),     τ_J = τ − friction − B·θ̈.
///
/// F is a third-order Butterworth low-pass, whose states are the derivatives that r needs: nothing is differenced.
/// Without K⁻¹ this is the momentum observer of rigid joints, which is wrong by M·K⁻¹·s²·τ_J: as large as the contact
/// itself where a joint swings, and of the wrong sign beyond. F delays by 2/(2π·cutoff) what is slow, twice as long as
/// one of first order. A joint with a corner of its own has a row of that filter's, over the signals of all. Damping of
/// the springs is left out, and c and gravity are taken where the motors are. Positive in the direction in which the
/// position grows. Starts at rest with nothing from outside, whatever torque the first reading has: before its first
/// command a drive reports none, though the arm has weight. Sources: A. De Luca, A. Albu-Schäffer, S. Haddadin, G.
/// Hirzinger, Collision detection and safe reaction with the DLR-III lightweight robot arm, IROS 2006 (links behind
/// springs, with sensors of τ_J); M. W. Spong, Modeling and control of elastic joint robots, 1987 (the model).
class ElasticTorqueObserver {
 public:
  using Params = ExternalTorqueObserver::Params;

  /// `arm` and `joint_stiffness`, in N m/rad, are what it is assumed to be. Errors: those of `Chain::make`; a cutoff
  /// out of bounds or beyond half the sample rate; `inconsistent` unless each joint has a stiffness.
  static Result<ElasticTorqueObserver> make(const Params& params, const arm::Chain::Params& arm,
                                            const JointVector& joint_stiffness, Seconds dt);

  /// Torque on the links in N m that is not the motors', the model's gravity's, motion's or friction's. Once a tick,
  /// with the readings of one instant. Real-time safe.
  JointVector step(const ArmReading& reading) noexcept;
  void reset() noexcept { started_ = false; }

 private:
  /// A signal of each joint behind F, with its first and second derivative.
  using Filtered = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::ColMajor, arm::most, 3>;

  /// F of one corner, with what passes it.
  struct Filter {
    Filter();
    Filter(double cutoff_Hz, Seconds dt);
    void start(const JointVector& velocity) noexcept;
    void step(const JointVector& mean_velocity, const JointVector& mean_torque) noexcept;
    [[nodiscard]] JointVector third_derivative(const JointVector& velocity) const noexcept;

    double corner_rad_per_s = 0.0;
    Eigen::Matrix3d kept = Eigen::Matrix3d::Zero();          ///< of signal and derivatives, from tick to tick
    Eigen::RowVector3d let_in = Eigen::RowVector3d::Zero();  ///< of an input that is held for a tick
    Filtered velocity;
    Filtered torque;  ///< of the motors, less friction, c and gravity
  };

  ElasticTorqueObserver(const arm::Chain& model, const JointVector& armature, const JointVector& joint_stiffness,
                        const JointVector& cutoff_Hz, Seconds dt);

  arm::Chain model_;
  JointVector armature_;
  JointVector softness_;          ///< K⁻¹, rad/(N m)
  Joints<Filter> filters_;        ///< one of each corner that there is
  Joints<std::size_t> of_joint_;  ///< which of them
  bool started_ = false;
  JointVector velocity_before_;
  JointVector torque_before_;
};

}  // namespace tactus::arm_control
