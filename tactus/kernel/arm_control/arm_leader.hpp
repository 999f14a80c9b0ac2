// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/arm_message.hpp>
#include <tactus/kernel/arm_control/each_joint.hpp>
#include <tactus/kernel/arm_control/factr_law.hpp>
#include <tactus/kernel/arm_control/feed_forward.hpp>
#include <tactus/kernel/arm_control/feedback_avoidance.hpp>
#include <tactus/kernel/arm_control/four_channel.hpp>
#include <tactus/kernel/arm_control/induced_motion.hpp>
#include <tactus/kernel/arm_control/joint_low_pass.hpp>
#include <tactus/kernel/arm_control/passivity.hpp>
#include <tactus/kernel/arm_control/site_tare.hpp>
#include <tactus/kernel/arm_control/tool_limit.hpp>
#include <tactus/kernel/arm_control/washed_damping.hpp>

#include <array>
#include <optional>

namespace tactus::arm_control {

/// How two arms are coupled.
enum class ArmMethod {
  position_force,      ///< the follower's external torque comes back, times a gain
  cancellation,        ///< the same, and what it does to the leader is taken from the command (`InducedMotion`)
  position_position,   ///< each drive pulls its arm to the other's position; a gain on the leader's stiffness
  factr,               ///< position-force with what FACTR's leader does alongside (`FactrLaw`)
  feedback_avoidance,  ///< position-force whose torque fades where the leader moves along (`FeedbackAvoidance`)
  four_channel  ///< positions and torques both ways, disturbances observed (`FourChannel`); the follower takes part
};
constexpr auto enumerators(ArmMethod) {
  return std::array{Enumerator{ArmMethod::position_force, "position-force"},
                    Enumerator{ArmMethod::cancellation, "cancellation"},
                    Enumerator{ArmMethod::position_position, "position-position"},
                    Enumerator{ArmMethod::factr, "factr"},
                    Enumerator{ArmMethod::feedback_avoidance, "feedback-avoidance"},
                    Enumerator{ArmMethod::four_channel, "four-channel"}};
}

/// Of a drive's own law (`arm::ArmCommand`), about its joint.
struct DriveGains {
  double stiffness_N_m_per_rad = 100.0;
  double damping_N_m_s_per_rad = 1.0;
  static constexpr auto fields() {
    using D = DriveGains;
    return List{field("stiffness_N_m_per_rad", &D::stiffness_N_m_per_rad, Unit{"N m/rad", "_N_m_per_rad"},
                      between(0.0, 1000.0), "Proportional gain of the drive."),
                field("damping_N_m_s_per_rad", &D::damping_N_m_s_per_rad, arm::units::newton_metre_second_per_radian,
                      between(0.0, 50.0), "Derivative gain of the drive.")};
  }
};

/// Damping that a drive gives its joint by itself, without the bus's delay.
struct DriveDamping {
  double damping_N_m_s_per_rad = 0.0;
  static constexpr auto fields() {
    return List{field("damping_N_m_s_per_rad", &DriveDamping::damping_N_m_s_per_rad,
                      arm::units::newton_metre_second_per_radian, between(0.0, 50.0),
                      "Derivative gain of the leader's drive, toward zero velocity.")};
  }
};

/// The site of the arm that an operator holds. Its torque is
///
///     feed-forward + gain·external torque of the follower − Jᵀ·damping·J·q̇ − drive damping·q̇,
///
/// with what dampers do to slow free motion given back if `damping_washout_Hz` is above 0 (`WashedDamping`), of which
/// the second part is displayed and the last is the drives' own. What the last comes to at the tool beyond a limit is
/// given back over the bus (`ToolLimit`). With `factr` and `feedback_avoidance` it is what their classes describe in
/// addition, and with passive ports a damper acts alongside it (`PassiveLeader`). With position-position it is
/// feed-forward and the drives' law, towards the follower; with four-channel what `FourChannel` adds as well. What the
/// bus carries saturates at each joint's effort limit. Gates are behind it (`leader_site`); the model of induced motion
/// lives on what `applied` states that they let through. Sources: position-position as openarm_teleop ships it
/// (enactic, Apache-2.0, `bilateral_step`), the gain on the leader's stiffness as i2rt's YAM has it (`bilateral_kp`,
/// MIT); the rest as on one axis
/// (`control::PositionForceMaster`).
class ArmLeader {
 public:
  struct Params {
    ArmMethod method = ArmMethod::cancellation;
    double force_gain = 1.0;
    double damping_N_s_per_m = 0.0;
    EachJoint<DriveDamping> drive_damping = {};
    double drive_damping_limit_N_s_per_m = 0.0;
    double damping_washout_Hz = 0.0;
    double force_low_pass_Hz = 0.0;
    EachJoint<JointCutoff> force_low_pass_each = {};
    double command_low_pass_Hz = 0.0;
    EachJoint<JointCutoff> command_low_pass_each = {};
    FeedForward::Params feed_forward = {};
    InducedMotion::Params model = {};
    FactrLaw::Params factr = {};
    FeedbackAvoidance::Params avoidance = FeedbackAvoidance::released;
    FourChannel::Params four_channel = {};
    PassivityParams passivity = {};
    static constexpr auto fields() {
      using P = Params;
      return List{
          field("method", &P::method, "Method that couples the arms."),
          field("force_gain", &P::force_gain, tactus::units::none, between(0.0, 100.0),
                "Displayed torque divided by the follower's external torque; with position-position, the leader's "
                "drive gains divided by the follower's."),
          field("damping_N_s_per_m", &P::damping_N_s_per_m, tactus::units::newton_second_per_metre,
                between(0.0, 1000.0), "Damping at the leader's tool, computed by the site and commanded over the bus."),
          field("drive_damping", &P::drive_damping,
                "Damping by the leader's drives themselves; not with position-position."),
          field("drive_damping_limit_N_s_per_m", &P::drive_damping_limit_N_s_per_m,
                tactus::units::newton_second_per_metre, between(0.0, 1e4),
                "Largest damping at the tool, in any direction, that drive_damping may cause; 0: no limit."),
          field("damping_washout_Hz", &P::damping_washout_Hz, tactus::units::hertz, between(0.0, 50.0),
                "In free motion the leader's dampers resist only motion above this frequency. In contact they resist "
                "all motion along the contact's normal. 0: they always resist all motion."),
          field("force_low_pass_Hz", &P::force_low_pass_Hz, tactus::units::hertz, between(0.0, 400.0),
                "First-order low-pass on the displayed torque; 0: no filter."),
          field("force_low_pass_each", &P::force_low_pass_each, "Separate corner frequencies for single joints."),
          field("command_low_pass_Hz", &P::command_low_pass_Hz, tactus::units::hertz, between(0.0, 400.0),
                "First-order low-pass on the command to the follower; 0: no filter."),
          field("command_low_pass_each", &P::command_low_pass_each, "Separate corner frequencies for single joints."),
          field("feed_forward", &P::feed_forward, "Feed-forward torques of the leader, for gravity and friction."),
          field("model", &P::model, "The model of induced motion."),
          field("factr", &P::factr, "Only with factr: the torques of its law, in addition to the displayed torque."),
          field("avoidance", &P::avoidance, "Only with feedback-avoidance: the gain of each joint."),
          field("four_channel", &P::four_channel, "Only with four-channel: the law of both arms."),
          field("passivity", &P::passivity,
                "Dampers at both sites that absorb excess energy (time-domain passivity); only with a method that "
                "reflects torque.")};
    }
  };

  /// What the site assumes of its arm, once for what carries it and once for the motion that torques induce.
  struct Arm {
    arm::Chain::Params carried;
    InducedMotion::Arm induced;
    Joints<DriveGains> gains = {};  ///< of the follower's drives, for position-position
    /// What the arm's motors must give beyond `carried`'s gravity, as a tare found it (`Tare`); no rows: nothing.
    JointVector lacking_N_m = {};
    Tare::Params tare = {};  ///< of one on request
  };
  struct Output {
    ArmCommand command;
    ArmMessage message;
    JointVector support;    ///< of the command's torque, gravity compensation and helps it against friction, N m
    JointVector displayed;  ///< of the command's torque, what comes from the follower, N m
    JointVector induced;    ///< position that was taken from the command, rad
  };

  /// Torques saturate at the effort limits of `arm.carried`, at 100 N m at most. Errors: a number out of bounds; those
  /// of the parts; `inconsistent`, under `passivity.port`, for passive ports with a method that pulls both arms to one
  /// another.
  static Result<ArmLeader> make(const Params& params, const Arm& arm, Seconds dt);

  /// One tick. The command acts from the next tick on, as on a bus, and the model counts with that. Real-time safe.
  Output step(const ArmReading& reading, const ArmMessage& follower) noexcept;
  /// Displayed torque over the follower's external torque; none with a method whose drives pull, and with passive
  /// ports, which count energy in the scale of the gain that they are made with.
  [[nodiscard]] std::optional<double> force_gain() const noexcept;
  /// From the next tick on. Real-time safe.
  void set_force_gain(double gain) noexcept { params_.force_gain = gain; }

  /// Its tare on request: springs and dampers over the bus move each joint about where it was, as part of its support,
  /// and what is found corrects gravity compensation. Real-time safe.
  [[nodiscard]] SiteTare& tare() noexcept { return tare_; }
  [[nodiscard]] const SiteTare& tare() const noexcept { return tare_; }
  /// As made, but for the force gain and the result of the tare. Real-time safe.
  void continue_as(const ArmLeader& made) noexcept {
    const SiteTare tare = tare_;
    const double gain = params_.force_gain;
    *this = made;
    tare_ = tare;
    params_.force_gain = gain;
  }
  /// The torque in N m that really passed of the latest command; without that all of it did. Real-time safe.
  void applied(const JointVector& torque) noexcept;

 private:
  ArmLeader(const Params& params, const Arm& arm, const FeedForward& feed_forward, const arm::Chain& chain,
            const InducedMotion& model, const JointLowPass& force, const JointLowPass& command, const SiteTare& tare,
            Seconds dt);
  [[nodiscard]] Tare::Drives tare_drives(const JointVector& position) const noexcept;
  [[nodiscard]] ToolJacobian tool_at(const JointVector& position) const noexcept;
  [[nodiscard]] JointVector beside_display(const ArmReading& reading, const JointVector& support,
                                           const JointVector& external) noexcept;

  Params params_;
  FeedForward feed_forward_;
  arm::Chain chain_;
  arm::Vector3 tool_m_;
  JointVector stiffness_;
  JointVector damping_;
  ToolLimit damping_limit_;
  WashedDamping washed_damping_;
  SiteTare tare_;
  JointVector over_friction_;  ///< stiffness with which a tare overcomes it
  double dt_s_;
  InducedMotion model_;
  FactrLaw factr_;
  FeedbackAvoidance avoidance_;
  FourChannel four_channel_;
  PassiveLeader passivity_;
  JointLowPass force_;
  JointLowPass command_position_;
  JointLowPass command_velocity_;
  JointVector most_;  ///< torque of the bus
  bool started_ = false;
  JointVector undisplayed_;  ///< of the latest command, what does not come from the follower
  JointVector acting_;       ///< displayed torque that acts until the next tick: that of the command before
};

}  // namespace tactus::arm_control
