#pragma once

#include <tactus/core/result.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace tactus::runtime {

/// Where a replay first gave another number than the log has.
struct ReplayDifference {
  std::string topic;
  std::string joint;  ///< its name, where the log has names of joints
  std::int64_t tap = 0;
  std::int64_t tick = 0;
  std::string signal;
  double recorded = 0.0;
  double replayed = 0.0;
};

struct Replay {
  std::string of;          ///< what was stepped: `2 taps`, `the master`, `both sites`
  std::int64_t taps = 0;   ///< 0 where a person armed the sites
  std::int64_t ticks = 0;  ///< steps that were compared, the one that differs included
  std::optional<ReplayDifference> difference;
  std::string version;  ///< of the program that wrote the log; another build may round otherwise
};

/// Steps the sites of a run in real time once more on what its log says that they read and were asked, and on what came
/// over the link, with the configuration that the log carries, and compares all that they give bit for bit. The first
/// difference ends it. The run is one of taps, of one site over a network, or of both sites, of one axis or of several
/// joints. Of a log that was cut, as by a program that was killed, what all its topics have is replayed.
///
/// Errors: those of reading a log; `missing` where it has none of the topics `/sites`, `/site`, `/master/site` and
/// `/slave/site`, or lacks what a later version replays with; `inconsistent` where steps are missing in it or its
/// signals are others; `out_of_bounds` and others where its configuration makes no teleoperator.
Result<Replay> replay(const std::filesystem::path& log);

}  // namespace tactus::runtime
