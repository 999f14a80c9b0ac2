// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/station/arm_teleoperator_params.hpp>
#include <tactus/kernel/station/described_arms.hpp>
#include <tactus/kernel/station/teleoperator_params.hpp>

#include <cstdint>
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
  std::int64_t taps = 0;   ///< 0 where an operator armed the sites
  std::int64_t ticks = 0;  ///< steps that were compared, the one that differs included
  std::optional<ReplayDifference> difference;
  std::string version;  ///< of the program that wrote the log; another build may round otherwise
};

/// Steps the sites of a run at the real clock again on the logged readings and requests, and on the packets that came
/// over the link, and compares all their outputs bit for bit. The first difference ends it. Of a log that was
/// cut, as by a program that was killed, what all its topics have is replayed. Call it with denormals flushed, as the
/// sites ran (`FlushedDenormals`). `real_time::replay` does all this for logs of experiments, whose configuration it
/// reads.
///
/// The log is of one site, or of both under supervision, of one axis or of joints that are driven each by itself; false
/// where it is no such log. `params` are those of the run.
///
/// Errors: `missing` for what a later version replays with; `inconsistent` where steps are missing in the log or its
/// signals are others; those of sites that cannot be made.
Result<bool> replay_sites(const telemetry::LogContent& content, const station::TeleoperatorParams& params,
                          Replay& replay);

/// The same of two arms of a rig.
Result<bool> replay_arms(const telemetry::LogContent& content, const station::ArmTeleoperatorParams& params,
                         const station::DescribedArms& arms, Replay& replay);

}  // namespace tactus::runtime
