// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/arm/motors.hpp>
#include <tactus/kernel/arm/units.hpp>
#include <tactus/kernel/arm_control/each_joint.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstddef>

/// Whether the motors of an arm give the torque that they are commanded.
namespace tactus::arm_control {

using arm::ArmReading;
using arm::JointVector;

/// What a motor does wrong: its drive reports another torque than it was commanded, or the arm moves as if the motor
/// gave another torque than its drive reports.
enum class MotorFinding { none, reports_otherwise, acts_otherwise };
constexpr auto enumerators(MotorFinding) {
  return std::array{Enumerator{MotorFinding::none, "none"},
                    Enumerator{MotorFinding::reports_otherwise, "reports-otherwise"},
                    Enumerator{MotorFinding::acts_otherwise, "acts-otherwise"}};
}

/// Compares, for each joint of a rigid arm, three torques: commanded, reported by the drive, and seen in the motion.
///
/// **Commanded and reported** may differ by `report_share` of the joint's torque limit.
///
/// **Reported and seen.** The generalised-momentum residual r is the torque that is not the motors', gravity's,
/// motion's or friction's (De Luca and Mattone, ICRA 2003; see `ExternalTorqueObserver`). A contact at the tool gives
/// r = Jᵀ·w with a wrench w of six numbers; a motor that gives δ more than its drive reports gives r = δ at its joint
/// alone. If the errors of the model have the standard deviations s, the covariance of r is
///
///     S = diag(s²) + σ_F²·J_vᵀ·J_v + σ_M²·J_wᵀ·J_w
///
/// and the likelihood ratio for a wrong motor at joint i is d_i = |S⁻¹·r|_i / sqrt((S⁻¹)_ii), in standard deviations
/// (a generalised likelihood ratio: A. S. Willsky, Automatica 12, 1976). s_i adds the joint's Coulomb friction,
/// `model_share` of its gravity torque and of the torque that accelerates it, and `least_N_m`.
///
/// For either difference the excess over its bound, as a share of the bound and 3 at most, is integrated over time and
/// never below 0. A joint is at fault once the integral exceeds `lasting_s`. No motor is judged before gravity
/// compensation is complete: until both differences have stayed below half of their bounds for `settles_s` under power,
/// a table or a hand may support the arm.
///
/// Range: rigid joints, or elastic ones whose swing stays within `model_share`. A contact elsewhere than at the tool is
/// not explained by w, and may look like a wrong motor.
class MotorWatch {
 public:
  struct Params {
    double deviations = 0.0;
    double contact_force_N = 15.0;
    double contact_moment_N_m = 1.0;
    double model_share = 0.1;
    double least_N_m = 0.05;
    double report_share = 0.1;
    double lasting_s = 0.004;
    double cutoff_Hz = 60.0;
    static constexpr auto fields() {
      using P = Params;
      return List{
          field("deviations", &P::deviations, tactus::units::none, between(0.0, 100.0),
                "Bound of the difference between the torque that the drive reports and the torque that is estimated "
                "from the motion, in standard deviations. 0 switches motor_watch off."),
          field("contact_force_N", &P::contact_force_N, tactus::units::newton, positive_up_to(1000.0),
                "Standard deviation of the contact force at the tool, in each direction."),
          field("contact_moment_N_m", &P::contact_moment_N_m, arm::units::newton_metre, positive_up_to(100.0),
                "Standard deviation of the contact moment at the tool, about each axis."),
          field("model_share", &P::model_share, tactus::units::none, positive_up_to(1.0),
                "Standard deviation of the model's gravity and inertial torque, as a share of that torque."),
          field("least_N_m", &P::least_N_m, arm::units::newton_metre, positive_up_to(100.0),
                "Constant part of the standard deviation of each joint's torque; its Coulomb friction and model_share "
                "add to it."),
          field("report_share", &P::report_share, tactus::units::none, positive_up_to(1.0),
                "Share of a joint's torque limit by which commanded and reported torque may differ."),
          field("lasting_s", &P::lasting_s, tactus::units::second, positive_up_to(1.0),
                "Time after which a difference of twice its bound is a fault. One of 1.5 times its bound takes twice "
                "as long, one of three times its bound half as long."),
          field("cutoff_Hz", &P::cutoff_Hz, tactus::units::hertz, positive_up_to(1000.0),
                "-3 dB frequency of the low-pass on the torque that is estimated from the motion.")};
    }
  };
  struct Input {
    ArmReading reading;
    JointVector commanded;           ///< torque and law of each drive, at the reading, N m
    bool powered = false;            ///< every drive was commanded with power
    std::int64_t elapsed_ticks = 1;  ///< since the reading before
  };
  struct Found {
    MotorFinding what = MotorFinding::none;
    std::size_t joint = 0;
    double wrong_N_m = 0.0;   ///< reported less commanded, or given less reported
    double deviations = 0.0;  ///< of the second kind
  };

  static constexpr double settles_s = 0.05;

  /// `model` describes the arm, `tool_m` is on its last link. Errors: a number out of bounds; those of
  /// `Chain::make`; a cutoff beyond half the sample rate.
  static Result<MotorWatch> make(const Params& params, const arm::Chain::Params& model, const arm::Vector3& tool_m,
                                 Seconds dt);

  /// One tick: what is wrong, which stays until the arm has no power. Real-time safe.
  const Found& step(const Input& input) noexcept;
  [[nodiscard]] const Found& found() const noexcept { return found_; }
  /// Whether the check is on.
  [[nodiscard]] bool judges() const noexcept { return params_.deviations > 0.0; }
  /// Largest likelihood ratio at the latest tick, in standard deviations; to look at.
  [[nodiscard]] double largest_deviations() const noexcept { return largest_; }
  [[nodiscard]] Eigen::Index joints() const noexcept { return coulomb_.size(); }
  [[nodiscard]] bool settled() const noexcept { return settled_s_ >= settles_s; }

 private:
  MotorWatch(const Params& params, const arm::Chain::Params& model, const arm::Chain& chain, const arm::Vector3& tool_m,
             Seconds dt);
  void observe(const Input& input) noexcept;
  [[nodiscard]] JointVector deviations(const ArmReading& reading) noexcept;
  void judge(double& sum_s, double over, MotorFinding what, Eigen::Index joint, double wrong_N_m) noexcept;
  void begin() noexcept;

  Params params_;
  arm::Chain chain_;
  arm::Vector3 tool_m_;
  double dt_s_;
  double kept_;          ///< of residual and inertial torque from tick to tick
  JointVector coulomb_;  ///< N m
  JointVector limit_;    ///< torque of each joint, N m
  JointVector velocity_, unmoved_;
  JointVector residual_, inertial_;
  JointVector estimate_;  ///< of what each motor gives too much, N m
  JointVector report_sum_s_, motion_sum_s_;
  bool started_ = false;
  double settled_s_ = 0.0;
  double largest_ = 0.0;
  Found found_;
};

}  // namespace tactus::arm_control
