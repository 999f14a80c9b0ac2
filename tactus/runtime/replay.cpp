#include <tactus/configuration/document.hpp>
#include <tactus/experiments/tapping/tapping.hpp>
#include <tactus/runtime/replay.hpp>
#include <tactus/runtime/rights.hpp>
#include <tactus/runtime/sites_record.hpp>
#include <tactus/telemetry/log_reader.hpp>

#include <bit>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace tactus::runtime {

namespace {

using experiments::TappingEnsemble;
using experiments::TappingParams;
using telemetry::LogTable;

constexpr std::string_view sites_topic = "/sites";

Error refuse(ErrorCode code, std::string message) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = {}};
}

/// Reads what the log says.
class RecordedDevice final : public station::Device {
 public:
  explicit RecordedDevice(const station::DeviceLimits& limits) : limits_(limits) {}
  [[nodiscard]] station::DeviceLimits limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  station::DeviceReading read(const station::Tick&) noexcept override { return reading; }
  void write(const station::DeviceCommand&) noexcept override {}
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return station::DeviceHealth::good; }
  station::DeviceReading reading;

 private:
  station::DeviceLimits limits_;
};

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

SitesRecord row_of(const LogTable& table, std::size_t row) {
  SitesRecord record;
  std::size_t column = 0;
  for_each_signal<SitesRecord>([&](const auto& signal) {
    auto& member = record.*signal.member;
    member = static_cast<std::remove_reference_t<decltype(member)>>(table.values[column++][row]);
  });
  return record;
}

std::optional<ReplayDifference> compare(const LogTable& table, const SitesRecord& recorded,
                                        const SitesRecord& replayed) {
  std::optional<ReplayDifference> found;
  for_each_signal<SitesRecord>([&](const auto& signal) {
    const auto left = recorded.*signal.member, right = replayed.*signal.member;
    if (found || std::bit_cast<std::uint64_t>(left) == std::bit_cast<std::uint64_t>(right)) return;
    found = ReplayDifference{.topic = table.topic,
                             .tap = recorded.tap,
                             .tick = recorded.tick,
                             .signal = signal.name,
                             .recorded = static_cast<double>(left),
                             .replayed = static_cast<double>(right)};
  });
  return found;
}

Check check_table(const LogTable& table) {
  const auto expected = telemetry::columns_of<SitesRecord>();
  bool same = table.columns.size() == expected.size();
  for (std::size_t i = 0; same && i < expected.size(); ++i) {
    same = table.columns[i].name == expected[i].name && table.columns[i].type == expected[i].type;
  }
  if (!same) {
    return refuse(ErrorCode::inconsistent,
                  "topic " + table.topic +
                      " has other signals than this version records: replay it with the version "
                      "that wrote it");
  }
  if (table.missing > 0) {
    return refuse(ErrorCode::inconsistent, "topic " + table.topic + " lacks " + std::to_string(table.missing) +
                                               " steps that found the log's ring full: there is nothing to replay "
                                               "them from");
  }
  return std::nullopt;
}

/// The steps of one run, tap after tap.
Check replay_run(const LogTable& table, const TappingParams& params, Replay& replay) {
  if (auto error = check_table(table)) return error;
  const auto ensemble = TappingEnsemble::make(params);
  if (!ensemble) return ensemble.error();
  std::unique_ptr<RecordedTap> tap;
  std::int64_t number = -1, next = 0;
  for (std::size_t row = 0; row < table.times_ns.size(); ++row) {
    const SitesRecord recorded_step = row_of(table, row);
    if (recorded_step.tap != number) {
      if (recorded_step.tap < 0 || static_cast<std::size_t>(recorded_step.tap) >= ensemble->size()) {
        return refuse(ErrorCode::inconsistent, "topic " + table.topic + " has a tap that its configuration has not");
      }
      auto made = RecordedTap::make(ensemble->tap(static_cast<std::size_t>(recorded_step.tap)));
      if (!made) return made.error();
      tap = *std::move(made);
      number = recorded_step.tap;
      next = 0;
      ++replay.taps;
    }
    if (recorded_step.tick != next + recorded_step.missed) {
      return refuse(ErrorCode::inconsistent, "topic " + table.topic + ", tap " + std::to_string(number) + ": tick " +
                                                 std::to_string(next) + " is missing");
    }
    next = recorded_step.tick + 1;
    tap->master.reading = {.position_m = recorded_step.master_position_m,
                           .force_N = recorded_step.hand_force_N,
                           .grip = recorded_step.grip};
    tap->slave.reading = {.position_m = recorded_step.slave_position_m, .force_N = recorded_step.tip_force_N};
    const station::Tick tick{.number = recorded_step.tick, .missed = recorded_step.missed};
    ++replay.ticks;
    replay.difference = compare(table, recorded_step, recorded(number, tick, tap->loop->step(tick, 1.0)));
    if (replay.difference) return std::nullopt;
  }
  return std::nullopt;
}

Check replay_all(const telemetry::LogContent& content, Replay& replay) {
  const auto about = content.summary.metadata.find("tactus");
  const auto text = [&](const char* key) -> std::string {
    if (about == content.summary.metadata.end()) return {};
    const auto found = about->second.find(key);
    return found == about->second.end() ? std::string() : found->second;
  };
  replay.version = text("version");
  bool any = false;
  for (const LogTable& table : content.tables) {
    if (!table.topic.ends_with(sites_topic)) continue;
    any = true;
    auto document = configuration::Document::parse(text("configuration"), "configuration of the log");
    if (!document) return document.error();
    const std::string run = table.topic.size() > sites_topic.size()
                                ? table.topic.substr(1, table.topic.size() - sites_topic.size() - 1)
                                : "run_1";
    if (const auto settings = content.summary.metadata.find(run); settings != content.summary.metadata.end()) {
      for (const auto& [key, value] : settings->second) {
        if (auto error = document->set(key + "=" + value)) return error;
      }
    }
    const auto params = document->read<TappingParams>();
    if (!params) return params.error();
    if (auto error = replay_run(table, *params, replay)) return error;
    if (replay.difference) return std::nullopt;
  }
  if (any) return std::nullopt;
  return refuse(ErrorCode::missing, "the log has no topic " + std::string(sites_topic) +
                                        ": only one that `tactus run --realtime --out` wrote can be replayed");
}

}  // namespace

Result<Replay> replay(const std::filesystem::path& log) {
  const auto content = telemetry::read_log(log);
  if (!content) return content.error();
  Replay replayed;
  const FlushedDenormals as_the_sites_ran;
  if (auto error = replay_all(*content, replayed)) return *std::move(error);
  return replayed;
}

}  // namespace tactus::runtime
