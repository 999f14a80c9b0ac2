// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/diagnosis/signals.hpp>
#include <tactus/kernel/core/result.hpp>

#include <optional>
#include <string>
#include <vector>

namespace tactus::diagnosis {

/// A signal of a bag that plays a role.
struct BagChannel {
  Role role = Role::master_position;
  std::string name = {};
  std::string unit = {};
  bool named = false;                 ///< by the caller: its sign is as the bag has it
  std::vector<double> values = {};    ///< at equal steps; forces that nobody named are turned as `Role` states
  double step = 0.0;                  ///< `resolution_of` the values of the messages
  std::vector<double> velocity = {};  ///< of a position, where the bag has it
  std::string velocity_name = {};
};

/// The signals of one joint of leader and follower, and those that are named, at common equal steps.
struct BagChannels {
  std::vector<BagChannel> channels = {};
  double sample_time_s = 0.0;
  std::optional<double> jitter_s = {};
  /// What was taken for what, and what was not used.
  std::vector<std::string> notes = {};
};

/// Reads a ROS 2 bag. Leader and follower are the topics of joint states that are called so; joints go together by
/// name, or by place where no name is in both. Errors: those of `telemetry::read_bag`; `missing` for a bag whose topics
/// identify no leader and no follower, for a name or a joint that it does not have; `inconsistent` for joints that go
/// together in no way, for signals that share no time, for a pause of more than ten steps and 30 ms, and for a value
/// that is not finite. Not real-time safe.
Result<BagChannels> read_bag_channels(const SignalRoles& roles);

}  // namespace tactus::diagnosis
