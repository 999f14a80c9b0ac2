// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/names.hpp>
#include <tactus/data/recording/time_base.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace tactus::recording {
namespace {

/// The number that ten digits of `value` say.
double without_rounding(double value) {
  std::array<char, 32> text{};
  const auto written = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 9);
  double shorter = value;
  std::from_chars(text.data(), written.ptr, shorter);
  return shorter;
}

}  // namespace

Result<double> uniform_sample_time(std::span<const double> time_s,
                                   const std::function<std::string(std::size_t)>& place_of) {
  constexpr double tolerated_share = 0.1;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    if (time_s[i] > time_s[i - 1]) continue;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "time",
                 .message = "time does not increase: " + significant(time_s[i - 1], 9) + " s is followed by " +
                            significant(time_s[i], 9) +
                            " s; remove the doubled samples or write times with more digits",
                 .place = place_of(i)};
  }
  const double sample_time_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double expected_s = time_s.front() + static_cast<double>(i) * sample_time_s;
    if (std::abs(time_s[i] - expected_s) <= tolerated_share * sample_time_s) continue;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "time",
                 .message = "time is not uniform: sample " + std::to_string(i + 1) + " is at " +
                            significant(time_s[i], 7) + " s, but a mean step of " + significant(sample_time_s, 6) +
                            " s puts it at " + significant(expected_s, 7) +
                            " s; fill lost samples or resample the recording to a uniform rate",
                 .place = place_of(i)};
  }
  return without_rounding(sample_time_s);
}

std::optional<double> jitter_of(std::span<const double> time_s) {
  constexpr double most = 0.45, lost = 0.65;
  constexpr std::ptrdiff_t half_window = 10, short_window = 8;
  const auto count = static_cast<std::ptrdiff_t>(time_s.size());
  if (count < 3) return std::nullopt;
  const double step_s = (time_s.back() - time_s.front()) / static_cast<double>(count - 1);
  // Distances from equal steps, and their sums up to each sample.
  std::vector<double> sums(time_s.size() + 1, 0.0);
  const auto distance = [&](std::ptrdiff_t i) {
    return (time_s[static_cast<std::size_t>(i)] - time_s[0]) / step_s - static_cast<double>(i);
  };
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    if (i > 0 && !(time_s[static_cast<std::size_t>(i)] > time_s[static_cast<std::size_t>(i - 1)])) return std::nullopt;
    sums[static_cast<std::size_t>(i + 1)] = sums[static_cast<std::size_t>(i)] + distance(i);
  }
  const auto mean = [&](std::ptrdiff_t from, std::ptrdiff_t to) {
    return (sums[static_cast<std::size_t>(to)] - sums[static_cast<std::size_t>(from)]) / static_cast<double>(to - from);
  };
  double squares = 0.0;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::ptrdiff_t half = std::min({half_window, i, count - 1 - i});
    // Near the ends there is too little to average; the first and the last sample fix the steps.
    const double off = distance(i) - (half < 3 ? 0.0 : mean(i - half, i + half + 1));
    if (std::abs(off) > most) return std::nullopt;
    squares += off * off;
    if (i == 0) continue;
    const double jump =
        mean(i, std::min(count, i + short_window)) - mean(std::max<std::ptrdiff_t>(0, i - short_window), i);
    if (std::abs(jump) > lost) return std::nullopt;
  }
  return step_s * std::sqrt(squares / static_cast<double>(count));
}

Check check_step(double sample_time_s, bool unit_stated) {
  constexpr double shortest_s = 2e-6, longest_s = 0.5, usual_from_s = 5e-5, usual_to_s = 0.1;
  if (sample_time_s >= shortest_s && sample_time_s <= longest_s) return std::nullopt;
  struct Worth {
    const char* unit;
    double seconds;
  };
  std::string remedy;
  for (const Worth& worth : {Worth{"s", 1.0}, Worth{"ms", 1e-3}, Worth{"us", 1e-6}, Worth{"ns", 1e-9}}) {
    const double step_s = sample_time_s * worth.seconds;
    if (unit_stated || step_s < usual_from_s || step_s > usual_to_s) continue;
    remedy += (remedy.empty() ? "; in " : ", in ") + std::string(worth.unit) + " it would be " +
              significant(1e3 * step_s) + " ms (--time-unit " + worth.unit + ")";
  }
  return Error{.code = ErrorCode::out_of_bounds,
               .parameter = "time",
               .message = "the times are " + significant(sample_time_s) +
                          " s apart, outside 2e-06 to 0.5 s, in which such devices are recorded" + remedy +
                          "; state the unit of the times with --time-unit s, ms, us or ns, or name another column with "
                          "--time",
               .place = {}};
}

std::optional<double> step_is_too_long_by(std::span<const double> position, std::span<const double> velocity,
                                          double sample_time_s) {
  constexpr double least_correlation = 0.8, most_off = 0.3;
  const std::size_t count = std::min(position.size(), velocity.size());
  double products = 0.0, of_velocity = 0.0, of_slope = 0.0;
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const double slope = (position[i + 1] - position[i - 1]) / (2.0 * sample_time_s);
    products += slope * velocity[i];
    of_velocity += velocity[i] * velocity[i];
    of_slope += slope * slope;
  }
  if (!(of_slope > 0.0) || std::abs(products) < least_correlation * std::sqrt(of_velocity * of_slope)) {
    return std::nullopt;
  }
  const double factor = std::sqrt(of_velocity / of_slope);
  for (const double power : {1e3, 1e6, 1e9, 1e-3, 1e-6, 1e-9}) {
    if (std::abs(factor / power - 1.0) < most_off) return power;
  }
  return std::nullopt;
}

Error contradicted_by_velocity(const std::string& velocity, double too_long_by, double sample_time_s) {
  const double right_s = sample_time_s / too_long_by;
  return {.code = ErrorCode::inconsistent,
          .parameter = "time",
          .message = "the times are " + significant(sample_time_s) + " s apart, but by the measured velocity '" +
                     velocity + "' the positions are " + significant(right_s) + " s apart: the times are in a unit " +
                     significant(too_long_by > 1.0 ? too_long_by : 1.0 / too_long_by) + " times " +
                     (too_long_by > 1.0 ? "shorter" : "longer") + "; state it with --time-unit s, ms, us or ns",
          .place = {}};
}

Result<std::optional<double>> agree(std::optional<double> stated_s, std::optional<double> found_s) {
  if (!stated_s || !found_s) return stated_s ? stated_s : found_s;
  constexpr double tolerated_share = 1e-3;
  if (std::abs(*stated_s - *found_s) <= tolerated_share * *stated_s) return stated_s;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "sample_time_s",
               .message = "a sample time of " + rounded_number(*stated_s) + " s contradicts the times in the file, " +
                          rounded_number(*found_s) + " s apart; correct it or leave it out",
               .place = {}};
}

}  // namespace tactus::recording
