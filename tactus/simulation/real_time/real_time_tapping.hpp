// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/end_request.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/runtime/servo/shared_device.hpp>
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/real_time/real_time_tap.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace tactus::real_time {

class ArmTapStreams;

/// A plant that another process owns.
struct PlantChoice {
  std::string name;
  Seconds silence = station::usual_silence;  ///< the timeout of the plant
};

/// How an experiment is to be run in real time.
struct RealTimeOptions {
  runtime::ServoThreadParams servo;          ///< the rate is that of the experiment
  std::optional<std::filesystem::path> log;  ///< file that takes every tick while it runs; its folder is made
  std::uint64_t log_limit_bytes = 0;         ///< as in `LogWriter::create`
  std::map<std::string, std::string> about;  ///< for the log, in addition to the configuration
  std::function<Check()> before_log{};       ///< called once the request has proved right, before the log is opened
  std::optional<PlantChoice> plant{};        ///< else devices are simulated on the servo thread
  const runtime::EndRequest* end = nullptr;  ///< that somebody may make while it runs; outlives the run
  /// Called with the streams of each run before the first tick, for observers other than the log.
  std::function<Check(const std::vector<runtime::RealTimeStreams>&)> look_on{};
  /// The same of taps of two arms, with the names of the leader's joints.
  std::function<Check(const ArmTapStreams&, const std::vector<std::string>&)> look_on_arms{};
};

/// What came out, and what became of the log.
struct RealTimeOutcome {
  experiments::Outcome outcome;
  Check log;                 ///< why it is not whole, where it is not
  bool interrupted = false;  ///< its end was asked for before all taps had run
};

/// Most taps of one run, and most runs, in real time: each tap takes the better part of a second.
inline constexpr std::size_t most_real_time_taps = 1000;
inline constexpr std::size_t most_real_time_runs = 64;

/// The experiments `tapping` and `arm-tapping` in real time, through a servo thread and simulated devices: the table
/// and report that virtual time makes, and how time was kept. The outcome has no traces: the log has every tick of
/// every tap, of one axis on the topics `/teleoperator`, `/sites` and `/servo`, with several runs `/run_1/teleoperator`
/// and so on; of two arms on those of `ArmTapStreams`. If its end was requested, the outcome is that of the taps
/// that had run by then, and states so.
///
/// Errors: another kind of experiment, more taps or runs than the limits, those of the experiment, of the log and of
/// the plant; arms with a plant or with several combinations. A log that fails during the run stops nothing; a plant
/// that is lost ends the run, and the log has all of it.
Result<RealTimeOutcome> run_in_real_time(const experiments::Request& request, const RealTimeOptions& options,
                                         const experiments::Progress& progress);

}  // namespace tactus::real_time
