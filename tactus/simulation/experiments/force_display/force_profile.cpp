// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/resample.hpp>
#include <tactus/simulation/experiments/force_display/force_display.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::experiments {

namespace {

std::vector<double> synthetic_transient(const ForceProfileParams& profile, double full_scale_N, double tick_s) {
  std::vector<double> force;
  const auto samples = static_cast<std::size_t>(std::lround(profile.duration_s / tick_s));
  for (std::size_t i = 0; i < samples; ++i) {
    const double time_s = static_cast<double>(i) * tick_s;
    force.push_back(full_scale_N * std::exp(-time_s / profile.decay_time_s) *
                    std::cos(2.0 * std::numbers::pi * profile.frequency_Hz * time_s));
  }
  return force;
}

double largest_magnitude(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::fabs(value));
  return largest;
}

}  // namespace

Result<std::vector<double>> load_profile(const ForceDisplayParams& params) {
  const ForceProfileParams& profile = params.profile;
  const double limit_N = params.task.force_limit_N;
  const double tick_s = 1.0 / params.servo.rate_Hz;
  if (profile.file.empty()) return synthetic_transient(profile, limit_N, tick_s);

  recording::Source source{
      .file = profile.file, .variable = profile.variable, .column = profile.column, .time = {}, .sample_time_s = {}};
  if (profile.sample_time_s > 0.0) source.sample_time_s = profile.sample_time_s;
  auto signal = recording::read(source);
  if (!signal) return under("profile", signal.error());
  if (!signal->sample_time_s) {
    return Error{.code = ErrorCode::missing,
                 .parameter = "profile.sample_time_s",
                 .message = "the file does not state the times of its samples: give the time between samples",
                 .place = {}};
  }
  const double recorded_s = static_cast<double>(signal->values.size()) * *signal->sample_time_s;
  const auto first = static_cast<std::size_t>(std::lround(profile.start_s / *signal->sample_time_s));
  const auto count = static_cast<std::size_t>(std::lround(profile.duration_s / *signal->sample_time_s));
  if (first + count > signal->values.size() || count < 2) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "profile.start_s",
                 .message = "the piece from " + rounded_number(profile.start_s) + " s to " +
                            rounded_number(profile.start_s + profile.duration_s) +
                            " s is not within the recording of " + rounded_number(recorded_s) +
                            " s: choose start_s and duration_s inside it",
                 .place = {}};
  }
  const auto begin = signal->values.begin() + static_cast<std::ptrdiff_t>(first);
  signal->values = std::vector<double>(begin, begin + static_cast<std::ptrdiff_t>(count));

  const double largest = largest_magnitude(signal->values);
  if (largest == 0.0) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "profile.start_s",
                 .message = "the piece of the recording is zero throughout: choose one with a force in it",
                 .place = {}};
  }
  const double scale_N = profile.scale_N == 0.0 ? limit_N / largest : profile.scale_N;
  auto resampled = recording::resample(*signal, Seconds{tick_s});
  if (!resampled) return under("profile", resampled.error());
  for (double& value : resampled->values) value = std::clamp(scale_N * value, -limit_N, limit_N);
  return std::move(resampled->values);
}

}  // namespace tactus::experiments
