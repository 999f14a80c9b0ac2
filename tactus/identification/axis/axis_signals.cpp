// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/identification/axis/axis_signals.hpp>
#include <tactus/identification/axis/refusal.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace tactus::identification {
namespace {

Check check_signal(const std::vector<double>& values, const char* role) {
  for (const double value : values) {
    if (!std::isfinite(value)) {
      return Error{ErrorCode::out_of_bounds, role, "a sample is not a finite number: correct or cut the recording", {}};
    }
  }
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (*high - *low <= 1e-12 * std::max(std::abs(*high), std::abs(*low))) {
    return inconsistent(std::string("the ") + role + " is constant (" + report::number(*low, 3) +
                        " throughout): name the column that moves, or record motion");
  }
  return std::nullopt;
}

/// Lost samples show as a step of the position far beyond all others.
Check check_gaps(const std::vector<double>& position, Seconds dt) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < position.size(); ++i) {
    if (position[i] != position[i - 1]) steps.push_back(std::abs(position[i] - position[i - 1]));
  }
  auto sorted = steps;
  const auto usual = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() * 99 / 100);
  std::nth_element(sorted.begin(), usual, sorted.end());
  for (std::size_t i = 1; i < position.size(); ++i) {
    if (std::abs(position[i] - position[i - 1]) <= 20.0 * *usual) continue;
    return inconsistent("the position jumps by " + report::number(position[i] - position[i - 1], 3) + " at " +
                        report::number(static_cast<double>(i) * dt.value, 3) +
                        " s, 20 times more than it moves between samples elsewhere: samples are missing or the signal "
                        "wraps; use a part of the recording without the jump");
  }
  return std::nullopt;
}

}  // namespace

Check check_axis(const AxisSignals& signals) {
  const std::size_t count = signals.position.size();
  const double dt = signals.sample_time.value;
  if (signals.force.size() != count) {
    return inconsistent("the position has " + std::to_string(count) + " samples and the force " +
                        std::to_string(signals.force.size()) + ": they must be of one recording");
  }
  if (!(dt >= 1e-5 && dt <= 0.05)) {
    return Error{ErrorCode::out_of_bounds,
                 "sample_time_s",
                 "a sample time of " + report::number(dt, 3) +
                     " s is outside 1e-05 to 0.05 s, in which the motion of an actuator is recorded: is the time in "
                     "another unit than seconds? State it with --sample-time-s",
                 {}};
  }
  if (count < 200 || static_cast<double>(count) * dt < 0.5) {
    return inconsistent("the recording is too short to judge: " + std::to_string(count) + " samples, " +
                        report::number(static_cast<double>(count) * dt, 3) +
                        " s; it takes 200 samples and 0.5 s, better several seconds");
  }
  if (auto error = check_signal(signals.position, "position")) return error;
  if (auto error = check_signal(signals.force, "force")) return error;
  return check_gaps(signals.position, signals.sample_time);
}

std::vector<double> every_second(const std::vector<double>& values, std::size_t first) {
  std::vector<double> result = values;
  for (std::size_t i = 1 - first; i < values.size(); i += 2) {
    if (i > 0 && i + 1 < values.size()) result[i] = 0.5 * (values[i - 1] + values[i + 1]);
  }
  return result;
}

}  // namespace tactus::identification
