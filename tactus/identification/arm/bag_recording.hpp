// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/recording.hpp>
#include <tactus/kernel/core/result.hpp>

#include <string>
#include <vector>

namespace tactus::arm_identification {

/// An arm in a ROS 2 bag: the topic of `sensor_msgs/msg/JointState` that has position and effort of all `joints`, by
/// their names; of several such topics the one that is called after a follower. Efforts are taken as they are, in N m.
///
/// Errors: those of `telemetry::read_bag` and `recording_of`; `inconsistent` where no topic or no one topic has all
/// joints: the message lists what the topics have. Not real-time safe.
Result<ArmRecording> read_bag_arm(const std::string& file, const std::vector<std::string>& joints);

}  // namespace tactus::arm_identification
