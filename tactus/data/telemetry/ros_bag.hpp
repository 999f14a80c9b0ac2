// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace tactus::telemetry {

/// The file itself, the one `.mcap` file of a folder, or the parts of one log in it, in their order. Errors: `missing`.
Result<std::vector<std::filesystem::path>> log_files(const std::filesystem::path& file_or_folder);

/// One number of a topic's messages over time.
struct BagSignal {
  std::string topic = {};
  std::string joint = {};  ///< of a JointState, as its messages name it; else empty
  std::string quantity =
      {};                 ///< `position`, `velocity`, `effort`; of a WrenchStamped `force.x`, `torque.z` and the like
  std::string unit = {};  ///< `rad`, `rad/s`, `N m` for joints, as ROS has it for those that turn; `N`, `N m`
  std::vector<double> time_s = {};  ///< of the header, or of reception where that is 0; from the bag's first on
  std::vector<double> values = {};

  /// `/follower/joint_states/joint_2.position`, `/ft_sensor/wrench/force.x`.
  [[nodiscard]] std::string name() const;
};

/// What a ROS 2 bag (MCAP) holds of arms.
struct Bag {
  std::vector<BagSignal> signals = {};
  std::vector<std::string> ignored = {};  ///< topics of other types: `/camera (sensor_msgs/msg/Image, 120 messages)`
  bool complete = true;                   ///< has its end
  std::uint64_t damaged_chunks = 0;       ///< left out
};

/// Reads all `sensor_msgs/msg/JointState` and `geometry_msgs/msg/WrenchStamped` of a bag: an `.mcap` file, or the
/// folder that holds one. Joints are distinguished by their names, so messages may hold them in any order, or some of
/// them.
///
/// Errors: those of `scan_log`; `syntax` for a message that is not what its type states, with topic and number;
/// `missing` for a bag without such topics (the message lists the topics); `out_of_bounds` for more than 2^26 numbers
/// or 4,096 signals. Not real-time safe.
Result<Bag> read_bag(const std::filesystem::path& file_or_folder);

}  // namespace tactus::telemetry
