// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/recording/column.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::recording {

/// A moment as a date and a time of day, or a time of day alone.
struct Instant {
  std::int64_t seconds = 0;  ///< since 1970-01-01T00:00:00 UTC, or since midnight
  double fraction_s = 0.0;
};

/// `2024-01-15T10:20:30.125Z`, `2024-01-15 10:20:30.125+01:00` or `10:20:30.125`; none for another text.
std::optional<Instant> parse_instant(std::string_view text);

/// What one of the second column of a pair such as `sec, nanosec` is worth in seconds; none where the two names are no
/// such pair.
std::optional<double> part_of_second(std::string_view seconds, std::string_view parts);

/// The name that a column of times usually has: `time`, `timestamp`, `Zeit` and the like.
bool sounds_like_time(std::string_view name);

/// Times in seconds, from the first sample on.
struct Times {
  std::vector<double> since_first_s = {};
  double first_s = 0.0;  ///< what the file states of the first sample
  /// Whether the file or the caller states the unit. Times since 1970 state it by their size.
  bool unit_stated = false;
};

/// A column of times in seconds. `unit` (s, ms, us or ns) counts before that of the column; where neither states one,
/// numbers that can only be times since 1970 (2001 to 2040) are taken as such in s, ms, us or ns, and others as
/// seconds. Errors: `wrong_type` for another unit.
Result<Times> to_seconds(Column time, const std::filesystem::path& file, std::string_view unit = {});

}  // namespace tactus::recording
