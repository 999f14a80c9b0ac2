// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/kernel/station/local_teleoperator.hpp>
#include <tactus/runtime/servo/replay_sites.hpp>
#include <tactus/runtime/servo/rights.hpp>
#include <tactus/runtime/servo/sites_record.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/real_time/replay.hpp>

#include <cstddef>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace tactus::real_time {

namespace {

using experiments::TappingEnsemble;
using experiments::TappingParams;
using runtime::about;
using runtime::refuse_replay;
using runtime::Replay;
using runtime::SitesRecord;
using telemetry::LogTable;

using RecordedDevice = runtime::RecordedDeviceOf<station::DeviceReading>;

constexpr std::string_view sites_topic = "/sites";

/// The sites of one tap between recorded devices.
struct RecordedTap {
  RecordedDevice master;
  RecordedDevice slave;
  std::unique_ptr<station::BareTeleoperator> loop;

  static Result<std::unique_ptr<RecordedTap>> make(const experiments::Tap& tap) {
    const auto& params = tap.params;
    auto made = std::make_unique<RecordedTap>(
        RecordedTap{RecordedDevice({.force_N = params.master.amplifier.limit_N,
                                    .handle_force_N = params.master.handle_actuator.limit_N}),
                    RecordedDevice({.force_N = params.slave.amplifier.limit_N}), nullptr});
    auto loop =
        station::BareTeleoperator::make(params.control, params.channel, Seconds{1.0 / params.servo.rate_Hz},
                                        params.control.position_scale * tap.path.start_m, made->master, made->slave);
    if (!loop) return loop.error();
    made->loop = std::make_unique<station::BareTeleoperator>(*std::move(loop));
    return made;
  }
};

/// The steps of one run, tap after tap.
Check replay_run(const LogTable& table, const TappingParams& params, Replay& replay) {
  if (auto error = runtime::check_table<SitesRecord>(table)) return error;
  const auto ensemble = TappingEnsemble::make(params);
  if (!ensemble) return ensemble.error();
  std::unique_ptr<RecordedTap> tap;
  std::int64_t number = -1, next = 0;
  for (std::size_t row = 0; row < table.times_ns.size(); ++row) {
    const SitesRecord recorded_step = runtime::row_of<SitesRecord>(table, row);
    if (recorded_step.tap != number) {
      if (recorded_step.tap < 0 || static_cast<std::size_t>(recorded_step.tap) >= ensemble->size()) {
        return refuse_replay(ErrorCode::inconsistent,
                             "topic " + table.topic + " has a tap that its configuration has not");
      }
      auto made = RecordedTap::make(ensemble->tap(static_cast<std::size_t>(recorded_step.tap)));
      if (!made) return made.error();
      tap = *std::move(made);
      number = recorded_step.tap;
      next = 0;
      ++replay.taps;
    }
    if (recorded_step.tick != next + recorded_step.missed) {
      return refuse_replay(ErrorCode::inconsistent, "topic " + table.topic + ", tap " + std::to_string(number) +
                                                        ": control cycle " + std::to_string(next) + " is missing");
    }
    next = recorded_step.tick + 1;
    tap->master.reading = {.position_m = recorded_step.master_position_m,
                           .force_N = recorded_step.hand_force_N,
                           .grip = recorded_step.grip};
    tap->slave.reading = {.position_m = recorded_step.slave_position_m, .force_N = recorded_step.tip_force_N};
    const station::Tick tick{.number = recorded_step.tick, .missed = recorded_step.missed};
    ++replay.ticks;
    replay.difference =
        compare(table, number, recorded_step, runtime::recorded(number, tick, tap->loop->step(tick, 1.0)));
    if (replay.difference) return std::nullopt;
  }
  return std::nullopt;
}

Result<configuration::Document> configuration_of(const telemetry::LogContent& content) {
  return configuration::Document::parse(about(content, "tactus", "configuration"), "configuration of the log");
}

/// The parameters of a run, by its name among several.
Result<TappingParams> params_of(const telemetry::LogContent& content, const std::string& run) {
  auto document = configuration_of(content);
  if (!document) return document.error();
  if (const auto settings = content.summary.metadata.find(run); settings != content.summary.metadata.end()) {
    for (const auto& [key, value] : settings->second) {
      if (auto error = document->set(key + "=" + value)) return *std::move(error);
    }
  }
  return document->read<TappingParams>();
}

/// Two arms, of a rig or simulated.
Result<bool> replay_pair(const telemetry::LogContent& content, const experiments::ArmTappingParams& params,
                         Replay& replay) {
  if (!runtime::is_of_joints(content)) return false;
  const auto words = content.summary.metadata.find("urdf");
  if (words == content.summary.metadata.end()) {
    return refuse_replay(ErrorCode::missing,
                         "the log does not have the URDF of its arms (urdf): it is of an earlier version, which did "
                         "not leave it, so it is not replayed; record it again");
  }
  const urdf::Urdfs urdfs = runtime::urdfs_in(words->second);
  if (about(content, "tactus", "rig").empty()) {
    if (Check failed = replay_arm_taps(content, params, urdfs, replay)) return *std::move(failed);
    return true;
  }
  const auto setup = experiments::set_up_arm_pair(params, urdfs);
  if (!setup) return setup.error();
  return runtime::replay_arms(content, params, *setup, replay);
}

/// Sites that are no taps of one axis.
Result<bool> replay_others(const telemetry::LogContent& content, Replay& replay) {
  const auto document = configuration_of(content);
  if (!document) return document.error();
  if (!experiments::is_of_arms(*document)) {
    const auto params = document->read<TappingParams>();
    return params ? runtime::replay_sites(content, experiments::sites_of(*params), replay) : params.error();
  }
  const auto params = document->read<experiments::ArmTappingParams>();
  return params ? replay_pair(content, *params, replay) : params.error();
}

/// The topics `/sites`; false where there is none.
Result<bool> replay_taps(const telemetry::LogContent& content, Replay& replay) {
  bool any = false;
  for (const LogTable& table : content.tables) {
    if (!table.topic.ends_with(sites_topic)) continue;
    any = true;
    const auto params = params_of(content, table.topic.size() > sites_topic.size()
                                               ? table.topic.substr(1, table.topic.size() - sites_topic.size() - 1)
                                               : "run_1");
    if (!params) return params.error();
    auto error = replay_run(table, *params, replay);
    replay.of = std::to_string(replay.taps) + " taps";
    if (error) return *std::move(error);
    if (replay.difference) break;
  }
  return any;
}

Check replay_all(const telemetry::LogContent& content, Replay& replay) {
  replay.version = about(content, "tactus", "version");
  auto replayed = replay_taps(content, replay);
  if (replayed && !*replayed && !about(content, "tactus", "configuration").empty()) {
    replayed = replay_others(content, replay);
  }
  if (!replayed) return replayed.error();
  if (*replayed) return std::nullopt;
  return refuse_replay(ErrorCode::missing,
                       "the log has no topic /sites, /site, /master/site or /slave/site with a configuration: only "
                       "what `tactus run --realtime --out` or "
                       "`tactus run --site --out` wrote can be replayed");
}

}  // namespace

Result<Replay> replay(const std::filesystem::path& log) {
  const auto content = telemetry::read_log(log);
  if (!content) return content.error();
  Replay replayed;
  const runtime::FlushedDenormals as_the_sites_ran;
  if (auto error = replay_all(*content, replayed)) return *std::move(error);
  return replayed;
}

}  // namespace tactus::real_time
