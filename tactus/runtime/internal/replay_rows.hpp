#pragma once

#include <tactus/experiments/tapping/tapping.hpp>
#include <tactus/runtime/replay.hpp>
#include <tactus/station/device.hpp>
#include <tactus/telemetry/log_reader.hpp>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

/// What all replays share: rows of a log as records, and what is compared with them.
namespace tactus::runtime {

/// Reads what the log says.
class RecordedDevice final : public station::Device {
 public:
  explicit RecordedDevice(const station::DeviceLimits& limits) : limits_(limits) {}
  [[nodiscard]] station::DeviceLimits limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  station::DeviceReading read(const station::Tick&) noexcept override { return reading; }
  void write(const station::DeviceCommand&) noexcept override {}
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return state; }
  station::DeviceReading reading;
  station::DeviceHealth state = station::DeviceHealth::good;

 private:
  station::DeviceLimits limits_;
};

inline Error refuse_replay(ErrorCode code, std::string message) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = {}};
}

/// That the table has the signals of the record, and no record is missing.
template <Recordable Record>
Check check_table(const telemetry::LogTable& table) {
  const auto expected = telemetry::columns_of<Record>();
  bool same = table.columns.size() == expected.size();
  for (std::size_t i = 0; same && i < expected.size(); ++i) {
    same = table.columns[i].name == expected[i].name && table.columns[i].type == expected[i].type;
  }
  if (!same) {
    return refuse_replay(ErrorCode::inconsistent,
                         "topic " + table.topic +
                             " has other signals than this version records: replay it with the version that wrote it");
  }
  if (table.missing > 0) {
    return refuse_replay(ErrorCode::inconsistent,
                         "topic " + table.topic + " lacks " + std::to_string(table.missing) +
                             " records that came faster than they were written: there is nothing to replay them from");
  }
  return std::nullopt;
}

/// A row of a checked table. A whole number beyond 2^53 is rounded, wherever it stands.
template <Recordable Record>
Record row_of(const telemetry::LogTable& table, std::size_t row) {
  Record record;
  std::size_t column = 0;
  for_each_signal<Record>([&](const auto& signal) {
    auto& member = record.*signal.member;
    member = static_cast<std::remove_reference_t<decltype(member)>>(table.values[column++][row]);
  });
  return record;
}

/// The first signal in which they differ by a bit.
template <Recordable Record>
std::optional<ReplayDifference> compare(const telemetry::LogTable& table, std::int64_t tap, const Record& recorded,
                                        const Record& replayed) {
  std::optional<ReplayDifference> found;
  for_each_signal<Record>([&](const auto& signal) {
    const auto left = recorded.*signal.member, right = replayed.*signal.member;
    bool same = false;
    if constexpr (std::is_same_v<decltype(left), const double>) {
      same = std::bit_cast<std::uint64_t>(left) == std::bit_cast<std::uint64_t>(right);
    } else {
      same = left == right;
    }
    if (found || same) return;
    found = ReplayDifference{.topic = table.topic,
                             .tap = tap,
                             .tick = recorded.tick,
                             .signal = signal.name,
                             .recorded = static_cast<double>(left),
                             .replayed = static_cast<double>(right)};
  });
  return found;
}

/// Where there is none, null.
inline const telemetry::LogTable* find_table(const telemetry::LogContent& content, const std::string& topic) {
  for (const telemetry::LogTable& table : content.tables) {
    if (table.topic == topic) return &table;
  }
  return nullptr;
}

/// Replays the log of one site, or of both under supervision; false where it is no such log.
Result<bool> replay_sites(const telemetry::LogContent& content, const experiments::TappingParams& params,
                          Replay& replay);

}  // namespace tactus::runtime
