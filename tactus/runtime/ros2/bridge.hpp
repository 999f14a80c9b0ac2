// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/joints.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/ros2/names.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tactus::ros2 {

/// What a robot does in the words of CRTK: `paused` gives no motion of its own accord, though it may hold.
enum class OperatingState { disabled, enabled, paused, fault };
constexpr auto enumerators(OperatingState) {
  return std::array{Enumerator{OperatingState::disabled, "DISABLED"}, Enumerator{OperatingState::enabled, "ENABLED"},
                    Enumerator{OperatingState::paused, "PAUSED"}, Enumerator{OperatingState::fault, "FAULT"}};
}

/// One axis of both devices, or one joint of several, in its own unit: where a name reports m and N, one that turns has
/// rad and N m. Positions and forces are positive toward the environment, unless stated otherwise.
struct JointSnapshot {
  double master_position_m = 0.0;         ///< measured, at the motor
  double master_force_N = 0.0;            ///< commanded to the motor, behind the safety gate
  double hand_force_N = 0.0;              ///< measured, of the hand on the handle
  double slave_position_m = 0.0;          ///< measured, at the motor
  double slave_command_m = 0.0;           ///< position command as it left the master
  double environment_force_N = 0.0;       ///< as the slave sent it, positive when the environment pushes it back
  double estimated_grip = 1.0;            ///< how firmly the operator holds, over identified
  double estimated_grip_deviation = 0.0;  ///< standard deviation of that; 0 where nothing is estimated
};

/// What the other programs receive of one tick of a teleoperator.
struct Snapshot {
  std::int64_t stamp_ns = 0;  ///< since 1970
  Joints<JointSnapshot> joints{1};
  OperatingState state = OperatingState::enabled;
};

/// A teleoperator among ROS 2 nodes. Under the namespace, by default `tactus`, it publishes the topics of `topics()`
/// and subscribes to `operator/servo_jp` (`sensor_msgs/msg/JointState` with one position in m): where another program
/// means the operator's hand to be. Of one site alone it publishes that device's topics, with the state as
/// `master/state` or `slave/state`. Of devices with several joints `measured_js` has the force at each joint as its
/// effort, and there is no `measured_cf`. With `Params::ask` it takes lines on `request` and answers each on `answer`,
/// both `std_msgs/msg/String`.
///
/// The thread that steps the teleoperator calls `publish` and `take_request`, which touch a wait-free ring, the newest
/// request and nothing else. A thread of the bridge does all DDS. When it does not keep up, snapshots are dropped and
/// counted.
class Bridge {
 public:
  struct Params {
    Network network = {};
    std::string name_space = "tactus";
    /// Of both devices, in order, `most_joints` at most; none where each has one axis, which is called as the device.
    std::vector<std::string> joints = {};
    double rate_Hz = 500.0;  ///< of the measured signals, at most; positive, up to 10 kHz
    bool master = true;      ///< whether the topics of that device are published
    bool slave = true;
    bool takes_requests = true;  ///< whether `operator/servo_jp` is subscribed to
    /// Takes a line of the topic `request`, as it is typed at a console, and returns what `answer` then publishes;
    /// null: neither topic exists. Called by the bridge's thread.
    std::function<std::string(const std::string& line)> ask = {};
  };
  struct Counts {
    std::uint64_t published = 0;  ///< snapshots, each a message on every topic of a device
    std::uint64_t lost = 0;       ///< messages that DDS did not take
    std::uint64_t dropped = 0;    ///< snapshots that were due and found the ring full
    std::uint64_t requests = 0;   ///< that could be used
    std::uint64_t refused = 0;    ///< commands that could not: not exactly one finite position
  };

  /// Opens everything and starts the thread. Errors: those of `check_namespace` and `Participant::create`;
  /// `out_of_bounds` for the rate and for the number of joints.
  static Result<Bridge> create(const Params& params);
  Bridge(Bridge&&) noexcept;
  Bridge& operator=(Bridge&&) = delete;
  ~Bridge();  ///< closes

  /// Passes a snapshot, with the joints of `Params`, on where one is due by `rate_Hz` and its stamp, or the state has
  /// changed. One thread only.
  /// Real-time safe: wait-free, no allocation, no system call.
  void publish(const Snapshot& snapshot) noexcept;
  /// The newest position in m that another program requested since the last call, always finite and not bounded
  /// otherwise. The same thread. Real-time safe.
  std::optional<double> take_request() noexcept;

  /// Publishes what is waiting, reports that the teleoperator is disabled, ends the thread and leaves DDS.
  void close();

  /// Any thread.
  [[nodiscard]] Counts counts() const;

 private:
  struct State;
  explicit Bridge(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace tactus::ros2
