// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm_control/arm_leader.hpp>
#include <tactus/kernel/arm_control/arm_message.hpp>
#include <tactus/kernel/arm_control/elastic_torque_observer.hpp>
#include <tactus/kernel/arm_control/external_torque_observer.hpp>
#include <tactus/kernel/arm_control/feed_forward.hpp>
#include <tactus/kernel/arm_control/passivity.hpp>
#include <tactus/kernel/arm_control/site_tare.hpp>
#include <tactus/kernel/arm_control/tool_coupling.hpp>
#include <tactus/kernel/arm_control/tool_limit.hpp>
#include <tactus/kernel/arm_control/torque_bias.hpp>
#include <tactus/kernel/arm_control/wanted_motion.hpp>

#include <array>
#include <optional>
#include <variant>

namespace tactus::arm_control {

/// Where the follower's external torque comes from.
enum class TorqueSource { observer, sensor };
constexpr auto enumerators(TorqueSource) {
  return std::array{Enumerator{TorqueSource::observer, "observer"}, Enumerator{TorqueSource::sensor, "sensor"}};
}

/// An observer of external torque, of rigid joints or of elastic ones, and what of it is assumed.
///
/// A joint that rests bears any torque within its Coulomb friction, and an observer cannot determine that from one from
/// outside. A dead band passes only what exceeds it: |r| − share·Coulomb, with the sign of r, or nothing. Without it, a
/// false torque pushes against the hand, times the gain; along a direction in which the tool hardly moves it is a
/// large force. With it, forces within friction are not felt.
///
/// A model whose masses are wrong makes a torque that changes slowly with the pose. `bias_distance_m` holds that down
/// without taking a slow contact for it: the bias follows the estimate by the distance that the tool travels without
/// contact and faster than 30 mm/s, and not by time (`TorqueBias`).
struct TorqueObserverParams : ExternalTorqueObserver::Params {
  JointModel joints = JointModel::rigid;
  double dead_band_share = 0.0;
  double bias_distance_m = 0.0;
  static constexpr auto fields() {
    return joined(
        ExternalTorqueObserver::Params::fields(),
        List{field("joints", &TorqueObserverParams::joints,
                   "The observer's model of the joints; with elastic joints its filter is of third order."),
             field("dead_band_share", &TorqueObserverParams::dead_band_share, tactus::units::none, between(0.0, 4.0),
                   "Dead band of the estimate, as a share of each joint's Coulomb friction. A torque within it is "
                   "reported as zero, and a larger one is reduced by it."),
             field("bias_distance_m", &TorqueObserverParams::bias_distance_m, tactus::units::metre, between(0.0, 10.0),
                   "Distance that the tool moves freely until 63 % of a lasting estimate counts as bias, which is "
                   "subtracted; 0: no bias is estimated.")});
  }
};

/// The site of the arm that touches things: its drives pull it to where the leader wants it, by their own law, and it
/// sends the external torque. What their gains come to at the tool beyond its limits is taken away over the bus
/// (`ToolLimit`), with passive ports it may stay behind (`PassiveFollower`), and in free motion the torque of the
/// wanted motion is added there (`WantedMotion`). What the bus carries saturates at each joint's effort limit, at 100 N
/// m at most. Gates are behind it (`follower_site`). With the coupling `tool` it receives and sends three numbers,
/// those of the leader's handle.
class ArmFollower {
 public:
  struct Params {
    Coupling coupling = Coupling::joints;
    double tool_scale = 1.0;
    EachJoint<DriveGains> gains = {};
    double stiffness_share = 1.0;
    double tool_stiffness_limit_N_per_m = 0.0;
    double tool_damping_limit_N_s_per_m = 0.0;
    FeedForward::Params feed_forward = {};
    WantedMotion::Params wanted_motion = {};
    TorqueSource torque = TorqueSource::observer;
    TorqueObserverParams observer = {};
    static constexpr auto fields() {
      using P = Params;
      return List{
          field("coupling", &P::coupling,
                "How the leader commands the follower. joints: each joint of the leader commands the follower's joint "
                "of the same number. tool: a leader with three sliding joints commands the position of the follower's "
                "tool."),
          field("tool_scale", &P::tool_scale, tactus::units::none, between(0.01, 100.0),
                "Only with the coupling tool: displacement of the follower's tool divided by the displacement of the "
                "leader's handle. The displayed force is multiplied by the same factor, in addition to force_gain."),
          field("gains", &P::gains, "Gains of the drives."),
          field("stiffness_share", &P::stiffness_share, tactus::units::none, between(0.0, 2.0),
                "Factor on every stiffness of [control.follower.gains]; the damping is not scaled."),
          field("tool_stiffness_limit_N_per_m", &P::tool_stiffness_limit_N_per_m, tactus::units::newton_per_metre,
                between(0.0, 1e5),
                "Largest stiffness at the tool, in any direction, that the drives may cause; 0: no limit."),
          field("tool_damping_limit_N_s_per_m", &P::tool_damping_limit_N_s_per_m,
                tactus::units::newton_second_per_metre, between(0.0, 1e4),
                "Largest damping at the tool, in any direction, that the drives may cause; 0: no limit."),
          field("feed_forward", &P::feed_forward, "Feed-forward torques of the follower, for gravity and friction."),
          field("wanted_motion", &P::wanted_motion,
                "Feed-forward torque for the motion that the leader sends. It acts only in free motion, in addition to "
                "the drives' own control law."),
          field("torque", &P::torque, "Source of the external torque that is displayed."),
          field("observer", &P::observer, "The observer of external torque.")};
    }
  };
  /// What the site assumes of its arm.
  struct Arm {
    arm::Chain::Params chain;
    arm::Vector3 tool_m = arm::Vector3::Zero();  ///< on its last link
    /// Of the transmissions, for an observer that takes them for elastic.
    JointVector joint_stiffness_N_m_per_rad = {};
    /// Of a leader that leads the tool (`ToolCoupling::axes_of`); not looked at where it leads joints.
    std::optional<arm::Matrix3> leader_axes = std::nullopt;
    /// Where the leader couples so: in place of the drives' gains and of `torque`.
    std::optional<FourChannelCoupling> four_channel = std::nullopt;
    PassivityCoupling passivity = {};
    /// What the arm's motors must give beyond `chain`'s gravity, as a tare found it (`Tare`); no rows: nothing.
    JointVector lacking_N_m = {};
    Tare::Params tare = {};  ///< of one on request
  };
  struct Output {
    ArmCommand command;
    JointVector support;  ///< of the command's torque, gravity compensation and helps it against friction, N m
    ArmMessage message;
  };

  /// Errors: a number out of bounds; those of the parts; `missing` for the coupling `tool` without `leader_axes`, and
  /// `inconsistent` for it with four-channel, which couples joints.
  static Result<ArmFollower> make(const Params& params, const Arm& arm, Seconds dt);

  /// One tick. `heard` is what the leader sent; `sensed` is external torque as sensors in the joints measure it; not
  /// looked at where an observer is. Real-time safe.
  Output step(const ArmReading& reading, const JointVector& sensed, const ArmMessage& heard) noexcept;

  /// Its tare on request: the drives move each joint about where the leader wants it, and what is found corrects
  /// gravity compensation and the observed torque. Real-time safe.
  [[nodiscard]] SiteTare& tare() noexcept { return tare_; }
  [[nodiscard]] const SiteTare& tare() const noexcept { return tare_; }
  /// As made, but for the result of the tare. Real-time safe.
  void continue_as(const ArmFollower& made) noexcept {
    const SiteTare tare = tare_;
    *this = made;
    tare_ = tare;
  }

 private:
  using Observer = std::variant<ExternalTorqueObserver, ElasticTorqueObserver>;
  static Result<Observer> make_observer(const TorqueObserverParams& params, const Arm& arm, const arm::Chain& chain,
                                        Seconds dt);
  static Result<std::optional<ToolCoupling>> make_coupling(const Params& params, const Arm& arm,
                                                           const arm::Chain& chain, Seconds dt);
  ArmFollower(const Params& params, const Arm& arm, const arm::Chain& chain, const Observer& observer,
              const WantedMotion& wanted_motion, const std::optional<ToolCoupling>& coupling, const SiteTare& tare,
              Seconds dt);
  [[nodiscard]] JointVector excess_torque(const ArmReading& reading, const ArmMessage& leader) const noexcept;
  void leave_out_dead_band(JointVector& torque) const noexcept;

  arm::Chain chain_;
  arm::Vector3 tool_m_;
  FeedForward feed_forward_;
  WantedMotion wanted_motion_;
  Observer observer_;
  std::optional<ToolCoupling> tool_coupling_;
  std::optional<FourChannel> four_channel_;
  PassiveFollower passivity_;
  JointVector told_;  ///< the external torque that it sent last
  JointVector most_;  ///< torque of the bus
  bool observes_;
  SiteTare tare_;
  TorqueBias bias_;
  JointVector dead_band_;
  JointVector stiffness_;
  JointVector damping_;
  ToolLimit stiffness_limit_;
  ToolLimit damping_limit_;
};

}  // namespace tactus::arm_control
