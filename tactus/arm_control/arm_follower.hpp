#pragma once

#include <tactus/arm_control/arm_leader.hpp>
#include <tactus/arm_control/arm_message.hpp>
#include <tactus/arm_control/elastic_torque_observer.hpp>
#include <tactus/arm_control/external_torque_observer.hpp>
#include <tactus/arm_control/feed_forward.hpp>

#include <array>
#include <variant>

namespace tactus::arm_control {

/// Where the follower's external torque comes from.
enum class TorqueSource { observer, sensor };
constexpr auto enumerators(TorqueSource) {
  return std::array{Enumerator{TorqueSource::observer, "observer"}, Enumerator{TorqueSource::sensor, "sensor"}};
}

/// An observer of external torque, of rigid joints or of elastic ones.
struct TorqueObserverParams : ExternalTorqueObserver::Params {
  JointModel joints = JointModel::rigid;
  static constexpr auto fields() {
    return joined(ExternalTorqueObserver::Params::fields(),
                  List{field("joints", &TorqueObserverParams::joints,
                             "What it takes the joints for: elastic ones filter in third order.")});
  }
};

/// The site of the arm that touches things: its drives pull it to where the leader wants it, by their own law, and it
/// tells the torque from outside. Feed-forward is bounded by each joint's effort limit, 100 N m at most; the drive
/// bounds the rest.
class ArmFollower {
 public:
  struct Params {
    EachJoint<DriveGains> gains = {};
    double stiffness_share = 1.0;
    FeedForward::Params feed_forward = {};
    TorqueSource torque = TorqueSource::observer;
    TorqueObserverParams observer = {};
    static constexpr auto fields() {
      using P = Params;
      return List{field("gains", &P::gains, "Of the drives."),
                  field("stiffness_share", &P::stiffness_share, tactus::units::none, between(0.0, 2.0),
                        "Share of the stiffness in gains that the drives are given; their damping stays."),
                  field("feed_forward", &P::feed_forward, "What carries the follower and helps it against friction."),
                  field("torque", &P::torque, "Where the external torque that comes back is from."),
                  field("observer", &P::observer, "The observer of external torque.")};
    }
  };
  struct Output {
    ArmCommand command;
    ArmMessage message;
  };

  /// `arm` is what it is believed to be, `joint_stiffness` in N m/rad that of its transmissions, for an observer that
  /// takes them for elastic. Errors: a number out of bounds; those of the parts.
  static Result<ArmFollower> make(const Params& params, const arm::Chain::Params& arm, Seconds dt,
                                  const JointVector& joint_stiffness = {});

  /// One tick. `sensed` is external torque as sensors in the joints tell it; not looked at where an observer is.
  /// Real-time safe.
  Output step(const ArmReading& reading, const JointVector& sensed, const ArmMessage& leader) noexcept;

 private:
  using Observer = std::variant<ExternalTorqueObserver, ElasticTorqueObserver>;
  static Result<Observer> make_observer(const TorqueObserverParams& params, const arm::Chain::Params& arm,
                                        const arm::Chain& chain, const JointVector& joint_stiffness, Seconds dt);
  ArmFollower(const Params& params, const FeedForward& feed_forward, const Observer& observer,
              const Joints<control::ForceGate>& gates);

  FeedForward feed_forward_;
  Observer observer_;
  Joints<control::ForceGate> gates_;
  bool observes_;
  JointVector stiffness_;
  JointVector damping_;
};

}  // namespace tactus::arm_control
