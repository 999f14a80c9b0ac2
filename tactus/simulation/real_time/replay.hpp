// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/urdf/described_arms.hpp>
#include <tactus/runtime/servo/replay.hpp>
#include <tactus/simulation/experiments/arm_tapping/params.hpp>

#include <filesystem>

namespace tactus::real_time {

/// Steps the sites of a run in real time again on the logged readings and requests, and on the packets that came
/// over the link, with the configuration in the log, and compares all their outputs bit for bit. The first
/// difference ends it. The run is one of taps, of one site over a network, or of both sites, of one axis or of several
/// joints. Of a log that was cut, as by a program that was killed, what all its topics have is replayed.
///
/// Errors: those of reading a log; `missing` where it lacks the topics `/sites`, `/site`, `/master/site` and
/// `/slave/site`, or lacks what a later version replays with; `inconsistent` where steps are missing in it or its
/// signals are others; `out_of_bounds` and others where its configuration makes no teleoperator.
Result<runtime::Replay> replay(const std::filesystem::path& log);

/// Taps of simulated arms, whose sites are bare.
Check replay_arm_taps(const telemetry::LogContent& content, const experiments::ArmTappingParams& params,
                      const urdf::Urdfs& urdfs, runtime::Replay& replay);

}  // namespace tactus::real_time
