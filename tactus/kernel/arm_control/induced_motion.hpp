// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/arm/hand.hpp>
#include <tactus/kernel/arm_control/joint_model.hpp>
#include <tactus/kernel/arm_control/tool_limit.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>

namespace tactus::arm_control {

using arm::JointMatrix;
using arm::JointVector;

/// Which part of the arm's inertia a model has.
enum class InertiaModel { full, diagonal };
constexpr auto enumerators(InertiaModel) {
  return std::array{Enumerator{InertiaModel::full, "full"}, Enumerator{InertiaModel::diagonal, "diagonal"}};
}

/// What displayed torques do to a held arm: the motion that they induce, to be taken from the command
/// to the follower (`ArmLeader`). The counterpart of `control::InducedMotionModel` for joints that are coupled:
///
///     (M(q) + Jᵀ m J)·ẅ + Jᵀ B J·ẇ + Jᵀ K J·w + friction(q̇) − friction(q̇ − ẇ) = τ,
///
/// where w is the induced motion, q̇ the measured velocity, J the tool's Jacobian, and K, B, m the hand's impedance in
/// base axes, K and B of its attitude too (`arm::HandImpedance`). τ is the displayed torque alone: feed-forward belongs
/// to the arm.
///
/// Friction acts on total velocity, as a difference: while the hand moves, Coulomb's hardly changes with the induced
/// motion. What the site's own friction feed-forward takes away is not there. It enters as a damper of the size of its
/// secant, so that the implicit step below holds it whatever it is.
///
/// Slow motion is washed out of the estimate (first-order high-pass, `washout_Hz`): the operator corrects it, and a
/// model without that correction would let the follower press ever harder. At 0 it is left in.
///
/// Elastic joints have a motor and a link each: the armature turns with w, the rest of M and the hand with the links,
/// and springs and dampers lie between. Position and velocity are the motors', which drives measure.
///
/// One step of the trapezoidal rule a tick, friction by implicit Euler: stable at any stiffness, without damping of its
/// own. M and J are those of the measured position. Position and velocity at a tick are the effect of torques up to
/// that tick: read them before `step`. Source: K. J. Kuchenbecker, G. Niemeyer, Induced master motion in
/// force-reflecting teleoperation, 2006, eq. 7, of whose one axis this is the case of several.
class InducedMotion {
 public:
  struct Params {
    arm::HandImpedance hand = {};
    double washout_Hz = 1.0;
    InertiaModel inertia = InertiaModel::full;
    JointModel joints = JointModel::rigid;
    static constexpr auto fields() {
      return List{
          field("hand", &Params::hand, "The hand on the tool, as the model assumes it."),
          field("washout_Hz", &Params::washout_Hz, tactus::units::hertz, between(0.0, 50.0),
                "Corner frequency below which induced motion is not cancelled; 0: slow motion is cancelled too."),
          field("inertia", &Params::inertia, "Mass matrix of the model: full, or only its diagonal."),
          field("joints", &Params::joints, "Model of the joints.")};
    }
  };
  /// What the leader's site does by itself on every velocity.
  struct Site {
    double damping_N_s_per_m = 0.0;                ///< of a damper at the tool
    JointVector drive_damping_N_m_s_per_rad = {};  ///< of the leader's drives; none where it has no rows
    double drive_damping_limit_N_s_per_m = 0.0;    ///< of what that is at the tool; 0: none
    double friction_share = 0.0;                   ///< of the friction that feed-forward takes away
    double friction_velocity_rad_per_s = 0.3;
    double damping_washout_Hz = 0.0;  ///< below which the dampers do not act (`WashedDamping`); 0: everywhere
  };

  /// What the leader is assumed to be.
  struct Arm {
    arm::Chain::Params chain;
    arm::Vector3 tool_m = arm::Vector3::Zero();  ///< on its last link
    /// Of the transmissions between motors and links; not looked at where joints are taken for rigid.
    JointVector joint_stiffness_N_m_per_rad = {};
    JointVector joint_damping_N_m_s_per_rad = {};
  };

  /// Errors: a number out of bounds; `inconsistent` for elastic joints of which not each has a stiffness.
  static Result<InducedMotion> make(const Params& params, const Site& site, const Arm& arm, Seconds dt);

  /// In rad and rad/s, at this tick, without what is washed out.
  [[nodiscard]] JointVector position() const noexcept { return position_.head(joints()) - slow_position_; }
  [[nodiscard]] JointVector velocity() const noexcept { return velocity_.head(joints()) - slow_velocity_; }
  /// To the next tick, under the displayed torque in N m that acts until then. Real-time safe.
  /// `left_out` is L of `WashedDamping::left`: which part of what the dampers do to slow motion the site takes away.
  void step(const JointVector& displayed, const JointVector& measured_position, const JointVector& measured_velocity,
            const JointMatrix& left_out = {}) noexcept;
  void reset() noexcept;

 private:
  /// Of the motors and, where joints are elastic, of the links behind them.
  using State = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 2 * arm::most, 1>;
  using StateMatrix =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 2 * arm::most, 2 * arm::most>;
  struct Matrices {
    StateMatrix inertia, damping, stiffness;
    JointMatrix of_site;  ///< of damping, what the site does to the motors
  };

  InducedMotion(const Params& params, const Site& site, const Arm& arm, const arm::Chain& chain, Seconds dt);
  [[nodiscard]] Eigen::Index joints() const noexcept { return chain_.joints(); }
  [[nodiscard]] Matrices matrices(const JointVector& measured_position) const noexcept;
  [[nodiscard]] double net_friction(std::size_t joint, double velocity) const noexcept;
  [[nodiscard]] double friction_secant(std::size_t joint, double velocity, double induced) const noexcept;

  arm::Chain chain_;
  Joints<arm::JointFriction> friction_;
  JointVector armature_;
  arm::Vector3 tool_m_;
  arm::HandImpedance hand_;
  Site site_;
  JointVector drive_damping_;
  ToolLimit drive_damping_limit_;
  bool diagonal_;
  bool elastic_;
  JointVector joint_stiffness_;
  JointVector joint_damping_;
  double dt_s_;
  double washed_;  ///< of slow motion, from tick to tick
  State position_;
  State velocity_;
  JointVector slow_position_;
  JointVector slow_velocity_;
  double damper_washed_;          ///< of the velocity that dampers do not see, from tick to tick
  JointVector slow_for_dampers_;  ///< that velocity
};

}  // namespace tactus::arm_control
