// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/diagnosis/signals.hpp>
#include <tactus/kernel/core/result.hpp>

#include <optional>
#include <string>
#include <vector>

namespace tactus::diagnosis {

/// A signal of a rig's log that plays a role.
struct RigChannel {
  Role role = Role::master_position;
  std::string name = {};
  std::string unit = {};
  std::vector<double> values = {};  ///< turned as `Role` states
};

/// The signals of one joint in one episode.
struct RigChannels {
  std::vector<RigChannel> channels = {};
  std::vector<double> time_s = {};  ///< of the control cycles
  std::vector<std::string> notes = {};
};

/// Reads the log that `tactus run --realtime --device RIG --out` leaves: of the joint that is named, or that moves most
/// roughly, the episode (`telemetry::episodes_of`) in which it moves most roughly, from both sides where both are in
/// it. Forces are what the motors report, or what they were commanded where they report none; the force at the tip is
/// what the follower sends to the leader.
///
/// None where the log is not of a rig's joints. Errors: those of `telemetry::read_log`; `missing` for a joint that the
/// rig has not, and for a log in which no episode is long enough; `inconsistent` for a value that is not finite. Not
/// real-time safe.
Result<std::optional<RigChannels>> read_rig_channels(const SignalRoles& roles);

}  // namespace tactus::diagnosis
