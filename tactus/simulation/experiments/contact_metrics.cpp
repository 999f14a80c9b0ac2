// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/root_mean_square.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>
#include <tactus/simulation/experiments/contact_metrics.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::experiments {

namespace {
constexpr double residual_window_s = 0.1;
}  // namespace

std::vector<double> force_transient(std::span<const double> force_N, double tick_s) {
  auto high_pass = signal::SecondOrderFilter::make(
      {.kind = signal::FilterKind::high_pass, .frequency_Hz = transient_cutoff_Hz}, Seconds{tick_s});
  std::vector<double> transient;
  transient.reserve(force_N.size());
  for (const double force : force_N) transient.push_back(high_pass->step(force));
  return transient;
}

ContactMetrics judge_contact(std::span<const double> contact_force_N, std::size_t first_touch, double tick_s) {
  std::vector<double> transient = force_transient(contact_force_N, tick_s);
  for (double& force : transient) force = std::fabs(force);

  const auto window = std::span(transient).subspan(first_touch);
  const double threshold = settled_share * *std::max_element(window.begin(), window.end());
  std::size_t settled_after = 0;
  for (std::size_t i = 0; i < window.size(); ++i) {
    if (window[i] > threshold) settled_after = i + 1;
  }

  ContactMetrics metrics;
  const double window_s = static_cast<double>(window.size()) * tick_s;
  metrics.settling_time_s = static_cast<double>(settled_after) * tick_s;
  metrics.settled = metrics.settling_time_s <= window_s - quiet_time_s;
  if (!metrics.settled) metrics.settling_time_s = window_s;

  const auto residual_ticks = std::min(window.size(), ticks_in(residual_window_s, tick_s));
  metrics.residual_rms_N = signal::root_mean_square(window.last(residual_ticks));
  return metrics;
}

}  // namespace tactus::experiments
