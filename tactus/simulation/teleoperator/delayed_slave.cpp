// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/delayed_slave.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace tactus::simulation {

namespace {

/// Actuator's force, velocity and position of the body, measured position.
using State = std::array<double, 4>;

State rate(const DelayedSlaveParams& p, const State& z, double command) {
  const auto [force, velocity, position, measured] = z;
  return {(p.actuator_gain * command - force) / p.actuator_lag_s,
          (force - p.viscous_damping_N_s_per_m * velocity) / p.mass_kg, velocity,
          (p.sensor_gain * position - measured) / p.sensor_lag_s};
}

State plus(const State& z, double factor, const State& d) {
  State sum{};
  for (std::size_t i = 0; i < z.size(); ++i) sum[i] = z[i] + factor * d[i];
  return sum;
}

struct Command {
  double value = 0.0, rate_per_s = 0.0;
};

Command command_at(const DelayedSlaveParams& p, const PathPoint& path, const State& z) {
  const double measured_rate = (p.sensor_gain * z[2] - z[3]) / p.sensor_lag_s;
  return {.value = p.controller_gain_N_per_m * (path.position_m - z[3]),
          .rate_per_s = p.controller_gain_N_per_m * (path.velocity_m_per_s - measured_rate)};
}

/// The command at step `at` (a fraction too), not after the newest one; zero before the start.
double past(const std::vector<Command>& history, double at, double step_s) {
  if (at < 0.0 || history.size() < 2) return at < 0.0 ? 0.0 : history.back().value;
  const auto i = std::min(static_cast<std::size_t>(at), history.size() - 2);
  const double t = at - static_cast<double>(i);
  const Command& a = history[i];
  const Command& b = history[i + 1];
  const double t2 = t * t, t3 = t2 * t;
  return (2.0 * t3 - 3.0 * t2 + 1.0) * a.value + (t3 - 2.0 * t2 + t) * step_s * a.rate_per_s +
         (3.0 * t2 - 2.0 * t3) * b.value + (t3 - t2) * step_s * b.rate_per_s;
}

}  // namespace

std::complex<double> transfer(const DelayedSlaveParams& p, std::complex<double> s) {
  return p.actuator_gain * p.sensor_gain * std::exp(-p.delay_s() * s) /
         ((p.actuator_lag_s * s + 1.0) * (p.sensor_lag_s * s + 1.0) * (p.mass_kg * s + p.viscous_damping_N_s_per_m) *
          s);
}

double phase_margin_deg(const DelayedSlaveParams& p) {
  const auto gain = [&](double omega) {
    return p.controller_gain_N_per_m * std::abs(transfer(p, std::complex<double>(0.0, omega)));
  };
  // The gain falls with frequency, so there is one crossover.
  double low = 1e-9, high = 1e9;
  if (gain(low) <= 1.0 || gain(high) >= 1.0) return 180.0;
  for (int i = 0; i < 200; ++i) (gain(std::sqrt(low * high)) > 1.0 ? low : high) = std::sqrt(low * high);
  const double phase = -std::numbers::pi / 2.0 - std::atan2(p.mass_kg * low, p.viscous_damping_N_s_per_m) -
                       std::atan(p.actuator_lag_s * low) - std::atan(p.sensor_lag_s * low) - p.delay_s() * low;
  return 180.0 + 180.0 / std::numbers::pi * phase;
}

Result<SlaveRecord> follow(const DelayedSlaveParams& params, const Path& path, double duration_s,
                           double sample_time_s) {
  if (Check error = validate(params)) return *std::move(error);
  constexpr double longest_step_s = 1e-4, most_samples = 1e7;
  double longest_s = longest_step_s;
  if (params.delay_s() > 0.0) longest_s = std::min(longest_s, params.delay_s());
  const double substeps = std::ceil(sample_time_s / longest_s * (1.0 - 1e-12));
  if (!(sample_time_s > 0.0) || !(duration_s * substeps / sample_time_s <= most_samples)) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "slave.actuator_delay_s",
                 .message = "duration, sample rate and shortest delay would take more than 10 million steps",
                 .place = {}};
  }
  const double h = sample_time_s / substeps;
  const auto every = static_cast<std::size_t>(substeps);
  const auto count = static_cast<std::size_t>(std::floor(duration_s / sample_time_s * (1.0 + 1e-12))) * every + 1;
  const bool direct = params.delay_s() == 0.0;

  SlaveRecord record;
  std::vector<Command> history;
  history.reserve(count);
  State z{};
  for (std::size_t k = 0; k < count; ++k) {
    const double time_s = static_cast<double>(k) * h;
    history.push_back(command_at(params, path(time_s), z));
    if (k % every == 0) {
      record.time_s.push_back(time_s);
      record.command.push_back(history.back().value);
      record.position.push_back(z[3]);
    }
    const auto slope = [&](const State& state, double fraction) {
      const double at = static_cast<double>(k) + fraction;
      const double command = direct ? command_at(params, path(at * h), state).value
                                    : past(history, std::min(at - params.delay_s() / h, static_cast<double>(k)), h);
      return rate(params, state, command);
    };
    const State k1 = slope(z, 0.0);
    const State k2 = slope(plus(z, 0.5 * h, k1), 0.5);
    const State k3 = slope(plus(z, 0.5 * h, k2), 0.5);
    const State k4 = slope(plus(z, h, k3), 1.0);
    for (std::size_t i = 0; i < z.size(); ++i) z[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
  }
  return record;
}

}  // namespace tactus::simulation
