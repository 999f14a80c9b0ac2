// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/log_reader.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace tactus::telemetry {

/// A stretch of a rig's log in which the follower follows, from arming to release, or what the operator marked of it.
struct Episode {
  std::size_t number = 1;     ///< from 1, discarded ones counted
  std::uint64_t from_ns = 0;  ///< of its first control cycle, as `LogTable::times_ns`
  std::uint64_t to_ns = 0;    ///< of its last one
  bool discarded = false;
  [[nodiscard]] double duration_s() const { return 1e-9 * static_cast<double>(to_ns - from_ns); }
};

/// The topic on which the operator's marks are, and its column.
inline constexpr const char* episodes_topic = "/episodes";
inline constexpr const char* episode_mark = "mark";

/// The topic whose column `state` shows whether the follower follows: that of the follower's site, or of the leader's
/// if the follower runs elsewhere. Null if the log is not one of sites.
const LogTable* site_that_follows(const LogContent& content);

/// The episodes of a log, in their order. The site is `active` from the first cycle of each to the last, and
/// - `start` ends the episode that runs, if one does, and starts the next,
/// - `keep` ends it,
/// - `discard` ends it, or takes the one that ended last, and discards it.
/// After `keep` and `discard` the next episode starts with `start` or with the next arming. Empty where the log is not
/// of sites. Not real-time safe.
std::vector<Episode> episodes_of(const LogContent& content);

}  // namespace tactus::telemetry
