// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/excitation.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

namespace tactus::identification {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double most_samples = 1e8;

Check check_limit(const char* parameter, double force_N, double limit_N) {
  if (force_N <= limit_N) return std::nullopt;
  return inconsistent(parameter,
                      rounded_number(force_N) + " N exceeds force_limit_N, " + rounded_number(limit_N) + " N");
}

Check check_length(double duration_s, Seconds tick) {
  if (duration_s / tick.value <= most_samples) return std::nullopt;
  return inconsistent("duration_s", "the signal of " + rounded_number(duration_s) + " s has more than 1e8 samples");
}

Check check_fade(double fade_s, double duration_s) {
  if (2.0 * fade_s <= duration_s) return std::nullopt;
  return inconsistent("envelope.fade_s", rounded_number(fade_s) + " s is more than half of the signal's " +
                                             rounded_number(duration_s) + " s");
}

std::size_t samples_in(double duration_s, Seconds tick) {
  return static_cast<std::size_t>(std::max(1.0, std::round(duration_s / tick.value)));
}

/// 0 at time 0, 1 from the end of the fade on.
double faded(double time_s, double fade_s) {
  return time_s >= fade_s ? 1.0 : 0.5 - 0.5 * std::cos(pi * std::max(0.0, time_s) / fade_s);
}

void fade(std::vector<double>& samples, double fade_s, Seconds tick) {
  const std::size_t last = samples.size() - 1;
  for (std::size_t i = 0; i <= last; ++i) {
    const double edge_s = tick.value * static_cast<double>(std::min(i, last - i));
    if (edge_s < fade_s) samples[i] *= faded(edge_s, fade_s);
  }
  samples.front() = samples.back() = 0.0;
}

}  // namespace

Result<std::vector<double>> swept_sine_N(const SweptSineParams& params, Seconds tick) {
  if (Check error = signal::check(params, tick)) return *std::move(error);
  if (Check error = signal::check_below_nyquist("start_Hz", params.start_Hz, tick)) return *std::move(error);
  if (Check error = signal::check_below_nyquist("end_Hz", params.end_Hz, tick)) return *std::move(error);
  const double limit_N = params.envelope.force_limit_N;
  if (Check error = check_limit("amplitude_N", params.amplitude_N, limit_N)) return *std::move(error);
  if (Check error = check_fade(params.envelope.fade_s, params.duration_s)) return *std::move(error);
  if (Check error = check_length(params.duration_s, tick)) return *std::move(error);

  const double span_Hz = params.end_Hz - params.start_Hz;
  const double ratio_log = std::log(params.end_Hz / params.start_Hz);
  const bool linear = params.spacing == SweepSpacing::linear || ratio_log == 0.0;
  std::vector<double> force_N(samples_in(params.duration_s, tick) + 1);
  for (std::size_t i = 0; i < force_N.size(); ++i) {
    const double part = static_cast<double>(i) * tick.value / params.duration_s;
    // Integral of f0 + (f1 − f0)·p, or of f0·(f1/f0)^p, over the time.
    const double cycles = params.duration_s * (linear ? params.start_Hz * part + 0.5 * span_Hz * part * part
                                                      : params.start_Hz * std::expm1(ratio_log * part) / ratio_log);
    force_N[i] = params.amplitude_N * std::sin(2.0 * pi * cycles);
  }
  fade(force_N, params.envelope.fade_s, tick);
  return force_N;
}

Result<std::vector<double>> multisine_N(const MultisineParams& params, Seconds tick) {
  if (Check error = signal::check(params, tick)) return *std::move(error);
  if (Check error = signal::check_below_nyquist("highest_Hz", params.highest_Hz, tick)) return *std::move(error);
  const double limit_N = params.envelope.force_limit_N;
  if (Check error = check_limit("peak_N", params.peak_N, limit_N)) return *std::move(error);
  const std::size_t length = samples_in(params.period_s, tick);
  const double period_s = static_cast<double>(length) * tick.value;
  const double fade_periods = std::max(1.0, std::ceil(params.envelope.fade_s / period_s));
  const double periods = static_cast<double>(params.periods) + 2.0 * fade_periods;
  if (Check error = check_length(periods * period_s, tick)) return *std::move(error);
  // A line that a rounding puts beside the limit still counts.
  const auto lowest = static_cast<std::size_t>(std::max(1.0, std::ceil(params.lowest_Hz * period_s - 1e-9)));
  const auto highest = static_cast<std::size_t>(std::floor(params.highest_Hz * period_s + 1e-9));
  if (highest < lowest)
    return inconsistent("highest_Hz", "no line of the period lies between lowest_Hz and highest_Hz");
  const std::size_t lines = highest - lowest + 1;
  if (static_cast<double>(lines) * static_cast<double>(length) > 1e9) {
    return inconsistent("period_s", std::to_string(lines) + " lines are too many; shorten the period");
  }

  std::vector<double> circle(length);
  for (std::size_t i = 0; i < length; ++i) {
    circle[i] = 2.0 * pi * static_cast<double>(i) / static_cast<double>(length);
  }
  std::vector<double> period_N(length);
  for (std::size_t k = 0; k < lines; ++k) {
    const double phase = -pi * static_cast<double>(k) * static_cast<double>(k + 1) / static_cast<double>(lines);
    for (std::size_t i = 0; i < length; ++i) period_N[i] += std::cos(circle[(lowest + k) * i % length] + phase);
  }
  double peak = 0.0;
  for (const double sample : period_N) peak = std::max(peak, std::abs(sample));
  for (double& sample : period_N) sample *= params.peak_N / peak;
  std::vector<double> force_N(static_cast<std::size_t>(periods) * length);
  for (std::size_t i = 0; i < force_N.size(); ++i) force_N[i] = period_N[i % length];
  fade(force_N, params.envelope.fade_s, tick);
  return force_N;
}

Result<std::vector<double>> random_binary_N(const RandomBinaryParams& params, Seconds tick) {
  if (Check error = signal::check(params, tick)) return *std::move(error);
  const double limit_N = params.envelope.force_limit_N;
  if (Check error = check_limit("amplitude_N", params.amplitude_N, limit_N)) return *std::move(error);
  if (Check error = check_fade(params.envelope.fade_s, params.duration_s)) return *std::move(error);
  if (Check error = check_length(params.duration_s, tick)) return *std::move(error);
  const std::size_t hold = samples_in(std::min(params.hold_s, params.duration_s), tick);
  signal::Random random(static_cast<std::uint64_t>(params.seed));
  std::vector<double> force_N(samples_in(params.duration_s, tick) + 1);
  for (std::size_t i = 0; i < force_N.size(); ++i) {
    if (i % hold != 0) {
      force_N[i] = force_N[i - 1];
    } else {
      force_N[i] = random.uniform() < 0.5 ? -params.amplitude_N : params.amplitude_N;
    }
  }
  fade(force_N, params.envelope.fade_s, tick);
  return force_N;
}

Result<std::vector<double>> force_loops_N(const ForceLoopParams& params, Seconds tick) {
  if (Check error = signal::check(params, tick)) return *std::move(error);
  if (Check error = check_limit("peak_N", params.peak_N, params.force_limit_N)) return *std::move(error);
  const double loop_s = 4.0 * params.peak_N / params.rate_N_per_s;
  const double duration_s = loop_s * static_cast<double>(params.loops);
  if (Check error = check_length(duration_s, tick)) return *std::move(error);
  std::vector<double> force_N(samples_in(duration_s, tick) + 1);
  for (std::size_t i = 0; i + 1 < force_N.size(); ++i) {
    const double quarters = 4.0 * std::fmod(static_cast<double>(i) * tick.value / loop_s, 1.0);
    const double triangle = quarters < 1.0 ? quarters : quarters < 3.0 ? 2.0 - quarters : quarters - 4.0;
    force_N[i] = params.peak_N * triangle;
  }
  return force_N;
}

Result<std::vector<double>> crossing_m(const CrossingParams& params, Seconds tick) {
  if (Check error = signal::check(params, tick)) return *std::move(error);
  for (const auto& [name, position_m] : {std::pair{"from_m", params.from_m}, std::pair{"to_m", params.to_m}}) {
    if (position_m < params.workspace_lower_m || position_m > params.workspace_upper_m) {
      return inconsistent(name, rounded_number(position_m) + " m lies outside the workspace from " +
                                    rounded_number(params.workspace_lower_m) + " to " +
                                    rounded_number(params.workspace_upper_m) + " m");
    }
  }
  const double distance_m = std::abs(params.to_m - params.from_m);
  const double cruise_s = distance_m / params.speed_m_per_s - params.fade_s;
  if (cruise_s <= 0.0) {
    return inconsistent("fade_s", "the way of " + rounded_number(distance_m) +
                                      " m ends before the speed is reached; shorten the fade or lower the speed");
  }
  const double way_s = cruise_s + 2.0 * params.fade_s;
  if (Check error = check_length(2.0 * way_s, tick)) return *std::move(error);
  // Integral of the fade up to a time within it, in seconds at full speed.
  const auto ramp_s = [fade_s = params.fade_s](double time_s) {
    return fade_s > 0.0 ? 0.5 * (time_s - fade_s / pi * std::sin(pi * time_s / fade_s)) : 0.0;
  };
  const auto run_s = [&](double time_s) {
    if (time_s < params.fade_s) return ramp_s(time_s);
    const double left_s = way_s - time_s;
    const double whole_s = cruise_s + params.fade_s;
    return left_s < params.fade_s ? whole_s - ramp_s(std::max(0.0, left_s)) : time_s - 0.5 * params.fade_s;
  };
  const double direction = params.to_m > params.from_m ? 1.0 : -1.0;
  std::vector<double> position_m(samples_in(2.0 * way_s, tick) + 1);
  for (std::size_t i = 0; i < position_m.size(); ++i) {
    const double time_s = std::min(static_cast<double>(i) * tick.value, 2.0 * way_s);
    const double there_s = run_s(std::min(time_s, 2.0 * way_s - time_s));
    position_m[i] = std::clamp(params.from_m + direction * params.speed_m_per_s * there_s,
                               std::min(params.from_m, params.to_m), std::max(params.from_m, params.to_m));
  }
  return position_m;
}

}  // namespace tactus::identification
