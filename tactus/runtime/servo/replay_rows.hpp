// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/kernel/station/device.hpp>
#include <tactus/runtime/servo/replay.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

/// What all replays share: rows of a log as records, and what is compared with them.
namespace tactus::runtime {

/// Reads the content of the log.
template <class Reading>
class RecordedDeviceOf final : public station::DeviceOf<Reading> {
 public:
  using Limits = Each<Reading, station::DeviceLimits>;
  explicit RecordedDeviceOf(const Limits& limits)
      : reading(same_for_each(limits, station::DeviceReading{})), limits_(limits) {}
  [[nodiscard]] Limits limits() const override { return limits_; }
  [[nodiscard]] bool simulated() const noexcept override { return true; }
  Reading read(const station::Tick&) noexcept override { return reading; }
  void write(const Each<Reading, station::DeviceCommand>&) noexcept override {}
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return state; }
  Reading reading;
  station::DeviceHealth state = station::DeviceHealth::good;

 private:
  Limits limits_;
};

inline Error refuse_replay(ErrorCode code, std::string message) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = {}};
}

/// That the table has the signals of the record, and no record is missing.
template <Recordable Record>
Check check_table(const telemetry::LogTable& table) {
  auto expected = telemetry::columns_of<Record>();
  const auto has = [&table](const telemetry::Column& column) {
    return std::ranges::find(table.columns, column.name, &telemetry::Column::name) != table.columns.end();
  };
  // The log of a joint that turns calls its signals by their units.
  auto turning = expected;
  for (telemetry::Column& column : turning) column = telemetry::of_turning_joint(std::move(column));
  if (!std::ranges::all_of(expected, has) && std::ranges::all_of(turning, has)) expected = std::move(turning);
  std::string lacking;
  for (const telemetry::Column& column : expected) {
    if (has(column)) continue;
    lacking += (lacking.empty() ? "" : ", ") + column.name;
  }
  if (!lacking.empty()) {
    return refuse_replay(ErrorCode::missing, "topic " + table.topic + " has no " + lacking +
                                                 ": the log is of another version, and this one replays with it; "
                                                 "replay it with the version that wrote it, or record it again");
  }
  if (!std::ranges::equal(table.columns, expected, [](const auto& one, const auto& other) {
        return one.name == other.name && one.type == other.type;
      })) {
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

/// A row of a checked table. A whole number beyond 2^53 is rounded, in any column.
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
  std::size_t column = 0;
  for_each_signal<Record>([&](const auto& signal) {
    const std::size_t own = column++;
    const auto left = recorded.*signal.member, right = replayed.*signal.member;
    bool same = false;
    if constexpr (std::is_same_v<decltype(left), const double>) {
      same = std::bit_cast<std::uint64_t>(left) == std::bit_cast<std::uint64_t>(right);
    } else {
      same = left == right;
    }
    if (found || same) return;
    found = ReplayDifference{.topic = table.topic,
                             .joint = {},
                             .tap = tap,
                             .tick = recorded.tick,
                             .signal = table.columns[own].name,
                             .recorded = static_cast<double>(left),
                             .replayed = static_cast<double>(right)};
  });
  return found;
}

/// The table of this topic; null if the log does not have it.
inline const telemetry::LogTable* find_table(const telemetry::LogContent& content, const std::string& topic) {
  for (const telemetry::LogTable& table : content.tables) {
    if (table.topic == topic) return &table;
  }
  return nullptr;
}

/// A value of the log's metadata; empty if it is not there.
std::string about(const telemetry::LogContent& content, const std::string& name, const std::string& key);

}  // namespace tactus::runtime
