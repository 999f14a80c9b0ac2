// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/names.hpp>
#include <tactus/data/recording/times.hpp>
#include <tactus/data/recording/unit_words.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <chrono>
#include <cmath>
#include <utility>

namespace tactus::recording {
namespace {

struct Scale {
  std::string_view unit;
  double seconds;
};
constexpr std::array scales{Scale{"s", 1.0}, Scale{"ms", 1e-3}, Scale{"us", 1e-6}, Scale{"ns", 1e-9}};

const Scale* scale_of(std::string_view unit) {
  const auto found = std::find_if(scales.begin(), scales.end(), [&](const Scale& scale) { return scale.unit == unit; });
  return found == scales.end() ? nullptr : found;
}

std::string small_letters(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

/// The digits at the start of `text`, which moves behind them, as a number; none where there are not as many.
std::optional<int> take_digits(std::string_view& text, std::size_t count) {
  int value = 0;
  if (text.size() < count) return std::nullopt;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + count, value);
  if (failure != std::errc{} || end != text.data() + count || value < 0) return std::nullopt;
  text.remove_prefix(count);
  return value;
}

bool take(std::string_view& text, std::string_view any_of) {
  if (text.empty() || any_of.find(text.front()) == std::string_view::npos) return false;
  text.remove_prefix(1);
  return true;
}

/// The fraction of a second at the start of `text`: `.125`.
double take_fraction(std::string_view& text) {
  double fraction = 0.0, place = 0.1;
  if (!take(text, ".,")) return 0.0;
  for (; !text.empty() && std::isdigit(static_cast<unsigned char>(text.front())) != 0; text.remove_prefix(1)) {
    fraction += place * (text.front() - '0');
    place *= 0.1;
  }
  return fraction;
}

/// A name without one of these endings, or nothing where it has none.
std::optional<std::string> without_ending(std::string_view name, std::span<const std::string_view> endings) {
  const std::string small = small_letters(name);
  for (const std::string_view ending : endings) {
    if (small.ends_with(ending)) return small.substr(0, small.size() - ending.size());
  }
  return std::nullopt;
}

}  // namespace

std::optional<Instant> parse_instant(std::string_view text) {
  Instant instant;
  text = trim(text);
  if (std::string_view rest = text; const auto year = take_digits(rest, 4)) {
    if (!take(rest, "-/")) return std::nullopt;
    const auto month = take_digits(rest, 2);
    if (!month || !take(rest, "-/")) return std::nullopt;
    const auto day = take_digits(rest, 2);
    if (!day || !take(rest, "T t_")) return std::nullopt;
    const std::chrono::year_month_day date{std::chrono::year(*year), std::chrono::month(static_cast<unsigned>(*month)),
                                           std::chrono::day(static_cast<unsigned>(*day))};
    if (!date.ok()) return std::nullopt;
    instant.seconds = std::int64_t{86400} * std::chrono::sys_days(date).time_since_epoch().count();
    text = rest;
  }
  const auto hour = take_digits(text, 2);
  if (!hour || !take(text, ":")) return std::nullopt;
  const auto minute = take_digits(text, 2);
  if (!minute || !take(text, ":")) return std::nullopt;
  const auto second = take_digits(text, 2);
  if (!second || *hour > 24 || *minute > 59 || *second > 60) return std::nullopt;
  instant.seconds += std::int64_t{3600} * *hour + std::int64_t{60} * *minute + *second;
  instant.fraction_s = take_fraction(text);
  if (take(text, "Zz") || text.empty()) return text.empty() ? std::optional(instant) : std::nullopt;
  const int sign = text.front() == '-' ? 1 : -1;
  if (!take(text, "+-")) return std::nullopt;
  const auto hours = take_digits(text, 2);
  take(text, ":");
  const auto minutes = text.empty() ? std::optional(0) : take_digits(text, 2);
  if (!hours || !minutes || !text.empty()) return std::nullopt;
  instant.seconds += std::int64_t{sign} * (std::int64_t{3600} * *hours + std::int64_t{60} * *minutes);
  return instant;
}

std::optional<double> part_of_second(std::string_view seconds, std::string_view parts) {
  using namespace std::string_view_literals;
  constexpr std::array nano{"nanoseconds"sv, "nanosecs"sv, "nanosec"sv, "nsecs"sv, "nsec"sv, "nanos"sv, "_ns"sv};
  constexpr std::array micro{"microseconds"sv, "microsecs"sv, "microsec"sv, "usecs"sv, "usec"sv, "micros"sv, "_us"sv};
  constexpr std::array whole{"seconds"sv, "secs"sv, "sec"sv, "_s"sv};
  for (const auto& [endings, worth] : {std::pair{std::span<const std::string_view>(nano), 1e-9},
                                       std::pair{std::span<const std::string_view>(micro), 1e-6}}) {
    const auto stem = without_ending(parts, endings);
    const auto of_seconds = without_ending(seconds, whole);
    if (stem && without_ending(seconds, endings) == std::nullopt && stem == of_seconds) return worth;
  }
  return std::nullopt;
}

bool sounds_like_time(std::string_view name) {
  constexpr std::array names{"time",    "timestamp", "timestamps", "time_stamp", "stamp",        "times",
                             "zeit",    "temps",     "tiempo",     "tempo",      "elapsed",      "elapsed_time",
                             "seconds", "secs",      "sec",        "clock",      "header.stamp", "system_time"};
  const std::string small = small_letters(name);
  return std::find(names.begin(), names.end(), small) != names.end() || name == "t";
}

Result<Times> to_seconds(Column time, const std::filesystem::path& file, std::string_view unit) {
  Times result;
  double scale = 1.0;
  const std::string stated = unit.empty() ? time.unit : unit_of(unit);
  if (!stated.empty() || !unit.empty()) {
    const Scale* const found = scale_of(stated);
    if (found == nullptr) {
      return Error{.code = ErrorCode::wrong_type,
                   .parameter = "time",
                   .message = in_quotes(time.name) + " of '" + file.string() + "' is in '" +
                              (unit.empty() ? time.unit : std::string(unit)) + "'; times are in s, ms, us or ns",
                   .place = {}};
    }
    scale = found->seconds;
    result.unit_stated = true;
  } else if (!time.values.empty()) {
    constexpr double in_2001_s = 978'307'200.0, in_2040_s = 2'208'988'800.0;
    for (const Scale& since_1970 : scales) {
      const auto [first, last] =
          std::pair{time.values.front() * since_1970.seconds, time.values.back() * since_1970.seconds};
      if (!(first > in_2001_s && first < in_2040_s && last > in_2001_s && last < in_2040_s)) continue;
      scale = since_1970.seconds;
      result.unit_stated = true;
    }
  }
  const double first = time.values.empty() ? 0.0 : time.values.front();
  result.first_s = first * scale;
  result.since_first_s = std::move(time.values);
  // Times since 1970 have few digits left behind the point.
  for (double& value : result.since_first_s) value = (value - first) * scale;
  return result;
}

}  // namespace tactus::recording
