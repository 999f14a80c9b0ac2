// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/cdr.hpp>
#include <tactus/data/telemetry/log_writer.hpp>
#include <tactus/kernel/core/signals.hpp>

#include <cstdint>

namespace tactus::telemetry {

/// A record with every type there is, and a member of one byte where the next one needs padding.
struct Sample {
  double time_s = 0.0;
  bool touched = false;
  double force_N = 0.0;
  std::int64_t count = 0;
  static constexpr auto signals() {
    return List{
        observed("time_s", &Sample::time_s, units::second, "", "", "", "When."),
        observed("touched", &Sample::touched, units::none, "environment", "", "", "Whether the wall was met."),
        observed("force_N", &Sample::force_N, units::newton, "master", "hand", "pushes the hand back", "Shown force."),
        observed("count", &Sample::count, units::none, "slave", "", "", "Counts down.")};
  }
};

/// The same formulas stand in the scripts under `foreign`.
inline Sample sample(std::int64_t k) {
  return {.time_s = 0.001 * static_cast<double>(k),
          .touched = k % 3 == 0,
          .force_N = 0.5 * static_cast<double>(k) - 100.0,
          .count = -k};
}

inline std::uint64_t time_of(std::int64_t k) { return static_cast<std::uint64_t>(k) * 1'000'000; }

inline ChannelDescription sample_channel(const char* topic) {
  return {.topic = topic, .type_name = "tactus_msgs/msg/Sample", .columns = columns_of<Sample>()};
}

inline void write_sample(LogWriter& log, std::uint16_t channel, std::int64_t k) {
  log.write(channel, static_cast<std::uint32_t>(k), time_of(k), to_cdr(sample(k)));
}

}  // namespace tactus::telemetry
