#pragma once

#include <tactus/arm_control/arm_leader.hpp>
#include <tactus/arm_control/arm_message.hpp>
#include <tactus/arm_control/external_torque_observer.hpp>
#include <tactus/arm_control/feed_forward.hpp>

#include <array>

namespace tactus::arm_control {

/// Where the follower's external torque comes from.
enum class TorqueSource { observer, sensor };
constexpr auto enumerators(TorqueSource) {
  return std::array{Enumerator{TorqueSource::observer, "observer"}, Enumerator{TorqueSource::sensor, "sensor"}};
}

/// The site of the arm that touches things: its drives pull it to where the leader wants it, by their own law, and it
/// tells the torque from outside. Feed-forward is bounded by each joint's effort limit, 100 N m at most; the drive
/// bounds the rest.
class ArmFollower {
 public:
  struct Params {
    EachJoint<DriveGains> gains = {};
    FeedForward::Params feed_forward = {};
    TorqueSource torque = TorqueSource::observer;
    ExternalTorqueObserver::Params observer = {};
    static constexpr auto fields() {
      using P = Params;
      return List{field("gains", &P::gains, "Of the drives."),
                  field("feed_forward", &P::feed_forward, "What carries the follower and helps it against friction."),
                  field("torque", &P::torque, "Where the external torque that comes back is from."),
                  field("observer", &P::observer, "The observer of external torque.")};
    }
  };
  struct Output {
    ArmCommand command;
    ArmMessage message;
  };

  /// `arm` is what it is believed to be. Errors: a number out of bounds; those of the parts.
  static Result<ArmFollower> make(const Params& params, const arm::Chain::Params& arm, Seconds dt);

  /// One tick. `sensed` is external torque as sensors in the joints tell it; not looked at where an observer is.
  /// Real-time safe.
  Output step(const ArmReading& reading, const JointVector& sensed, const ArmMessage& leader) noexcept;

 private:
  ArmFollower(const Params& params, const FeedForward& feed_forward, const ExternalTorqueObserver& observer,
              const Joints<control::ForceGate>& gates);

  FeedForward feed_forward_;
  ExternalTorqueObserver observer_;
  Joints<control::ForceGate> gates_;
  bool observes_;
  JointVector stiffness_;
  JointVector damping_;
};

}  // namespace tactus::arm_control
