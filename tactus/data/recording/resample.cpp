// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/names.hpp>
#include <tactus/data/recording/resample.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::recording {
namespace {

/// Slope of the curve at sample `i`, per sample.
double slope(const std::vector<double>& y, std::size_t i) {
  const std::size_t last = y.size() - 1;
  if (last == 1) return y[1] - y[0];
  if (i == 0) return -1.5 * y[0] + 2.0 * y[1] - 0.5 * y[2];
  if (i == last) return 1.5 * y[last] - 2.0 * y[last - 1] + 0.5 * y[last - 2];
  return 0.5 * (y[i + 1] - y[i - 1]);
}

/// The cubic Hermite curve, `fraction` (0 to 1) of the way from sample `i` to the next.
double between_samples(const std::vector<double>& y, std::size_t i, double fraction) {
  if (fraction == 0.0) return y[i];
  const double rise = y[i + 1] - y[i];
  const double excess_before = slope(y, i) - rise;
  const double excess_after = rise - slope(y, i + 1);
  const double rest = 1.0 - fraction;
  return y[i] + fraction * (rise + rest * (excess_before * rest + excess_after * fraction));
}

Error cannot(ErrorCode code, std::string message) {
  return {.code = code, .parameter = "sample_time_s", .message = std::move(message), .place = {}};
}

/// Slope of the parabola through sample `i` and its neighbours, per second.
double slope_at(std::span<const double> t, std::span<const double> y, std::size_t i) {
  const std::size_t last = y.size() - 1;
  const auto rise = [&](std::size_t k) { return (y[k + 1] - y[k]) / (t[k + 1] - t[k]); };
  if (i == 0) return rise(0);
  if (i == last) return rise(last - 1);
  const double before_s = t[i] - t[i - 1];
  const double after_s = t[i + 1] - t[i];
  return (rise(i - 1) * after_s + rise(i) * before_s) / (before_s + after_s);
}

}  // namespace

std::vector<double> at_steps(std::span<const double> time_s, std::span<const double> values, double first_s,
                             double step_s, std::size_t count) {
  std::vector<double> result(count);
  const std::size_t last = values.size() - 1;
  std::size_t before = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double at_s = first_s + static_cast<double>(k) * step_s;
    while (before + 1 < last && time_s[before + 1] <= at_s) ++before;
    const double length_s = time_s[before + 1] - time_s[before];
    const double share = std::clamp((at_s - time_s[before]) / length_s, 0.0, 1.0);
    const double rest = 1.0 - share;
    const double rise = values[before + 1] - values[before];
    const double excess_before = slope_at(time_s, values, before) * length_s - rise;
    const double excess_after = rise - slope_at(time_s, values, before + 1) * length_s;
    result[k] = values[before] + share * (rise + rest * (excess_before * rest + excess_after * share));
  }
  return result;
}

std::vector<double> at_equal_steps(std::span<const double> time_s, std::span<const double> values) {
  const std::size_t last = values.size() - 1;
  const double step_s = (time_s[last] - time_s[0]) / static_cast<double>(last);
  std::vector<double> result = at_steps(time_s, values, time_s[0], step_s, values.size());
  result.front() = values.front();
  result.back() = values.back();
  return result;
}

Result<Signal> resample(const Signal& signal, Seconds sample_time) {
  constexpr double equal_share = 1e-6;
  constexpr double most_new_samples = 1e8;
  if (!signal.sample_time_s) {
    return cannot(ErrorCode::missing, "the sample time of '" + signal.name +
                                          "' is unknown; state sample_time_s or name the time column with `time`");
  }
  for (const double value : {*signal.sample_time_s, sample_time.value}) {
    if (!positive.contain(value)) return out_of_bounds("sample_time_s", value, positive, units::second);
  }
  if (signal.values.size() < 2) {
    return cannot(ErrorCode::missing, in_quotes(signal.name) + " has fewer than two samples");
  }
  const double step = sample_time.value / *signal.sample_time_s;
  if (step > 1.0 + equal_share) {
    return cannot(ErrorCode::inconsistent,
                  in_quotes(signal.name) + " is sampled every " + rounded_number(*signal.sample_time_s) +
                      " s, and taking it only every " + rounded_number(sample_time.value) +
                      " s would fold fast content into slow; low-pass filter and decimate the recording first, or step "
                      "at its rate or faster");
  }
  Signal result = signal;
  result.sample_time_s = sample_time.value;
  if (step >= 1.0 - equal_share) return result;

  const auto last = static_cast<double>(signal.values.size() - 1);
  const double steps = std::floor(last / step * (1.0 + 1e-12));
  if (steps >= most_new_samples) {
    return cannot(ErrorCode::out_of_bounds, rounded_number(sample_time.value) +
                                                " s would make more than 1e8 samples of '" + signal.name +
                                                "'; choose a longer sample time");
  }
  result.values.resize(static_cast<std::size_t>(steps) + 1);
  for (std::size_t k = 0; k < result.values.size(); ++k) {
    double position = std::min(static_cast<double>(k) * step, last);
    // A product such as 5 * 0.4 may miss the original sample it means by a rounding error.
    if (std::abs(position - std::round(position)) < 1e-9) position = std::round(position);
    const double whole = std::floor(position);
    result.values[k] = between_samples(signal.values, static_cast<std::size_t>(whole), position - whole);
  }
  return result;
}

}  // namespace tactus::recording
