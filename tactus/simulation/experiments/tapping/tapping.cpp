// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/random.hpp>
#include <tactus/simulation/experiments/draws.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <type_traits>
#include <utility>

namespace tactus::experiments {

namespace {

/// The person rests this long before the reach, so that every filter is at rest too.
constexpr double tap_rest_s = 0.05;

template <class Teleoperator>
TapResult run_tap(const Tap& tap, TapObserver judge, std::vector<simulation::Teleoperator::Record>* trace) {
  constexpr bool supervised = std::is_same_v<Teleoperator, simulation::SupervisedTeleoperator>;
  const auto& [params, path] = tap;
  auto teleoperator = Teleoperator::make(params, path.start_m);
  const double tick_s = teleoperator->tick_s();
  bool more = true;
  for (std::size_t tick = 0; more; ++tick) {
    const double time_s = static_cast<double>(tick) * tick_s;
    const auto record = teleoperator->step(path.position_m(time_s), path.position_m(time_s + tick_s));
    if (trace != nullptr) trace->push_back(record);
    // Supervision stops for a gate that has latched a tick later, and knows why.
    const bool healthy = supervised || teleoperator->healthy();
    more = judge.observe(record, healthy, teleoperator->stopped());
  }
  return judge.result();
}

/// Whether it can be made, and armed.
Check check(const Tap& tap, bool supervised) {
  const auto error_of = [](const auto& made) { return made ? Check{} : Check{made.error()}; };
  return supervised ? error_of(simulation::SupervisedTeleoperator::make(tap.params, tap.path.start_m))
                    : error_of(simulation::Teleoperator::make(tap.params, tap.path.start_m));
}

}  // namespace

station::TeleoperatorParams sites_of(const TappingParams& params) {
  station::TeleoperatorParams sites = params;
  sites.control.model = mismatched(sites.control.model, params.task.mismatch);
  return sites;
}

Check refuse_supervised(const TappingParams& params, const std::string& who) {
  if (!params.task.supervised) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "task.supervised",
               .message = "is true, and " + who + " runs simulated sites without supervision: set it to false",
               .place = {}};
}

Result<TappingEnsemble> TappingEnsemble::make(const TappingParams& params) {
  if (auto error = validate(params)) return *std::move(error);
  const TappingTask& task = params.task;
  if (auto error = check_range(task.slowest_m_per_s, task.fastest_m_per_s, "slowest_m_per_s", "fastest_m_per_s")) {
    return *std::move(error);
  }
  if (auto error = check_range(task.shallowest_m, task.deepest_m, "shallowest_m", "deepest_m")) {
    return *std::move(error);
  }

  std::vector<Tap> taps;
  const signal::Random ensemble(static_cast<std::uint64_t>(task.seed));
  for (std::int64_t i = 0; i < task.taps; ++i) {
    signal::Random draw = ensemble.fork(static_cast<std::uint64_t>(i));
    const auto between = [&draw](double lower, double upper) { return lower + (upper - lower) * draw.uniform(); };
    const double speed = between(task.slowest_m_per_s, task.fastest_m_per_s);
    const double depth = between(task.shallowest_m, task.deepest_m);
    Tap tap{.params = params, .path = {}};
    tap.params.person.tremor_amplitude_m *= between(0.5, 1.5);
    tap.params.person.tremor_frequency_Hz *= between(0.8, 1.2);
    tap.params.person.tremor_phase_cycles = draw.uniform();
    limit_to_bounds(tap.params.person);
    tap.params.slave.force_sensor.seed = static_cast<std::int64_t>(draw.bits() >> 1);
    ModelMismatch mismatch = task.mismatch;
    mismatch.mass *= between(1.0 - task.model_error, 1.0 + task.model_error);
    mismatch.linkage_stiffness *= between(1.0 - task.model_error, 1.0 + task.model_error);
    mismatch.operator_damping *= between(1.0 - task.model_error, 1.0 + task.model_error);
    tap.params.control.model = mismatched(params.control.model, mismatch);
    tap.params.channel.to_slave.seed = static_cast<std::int64_t>(draw.bits() >> 1);
    tap.params.channel.to_master.seed = static_cast<std::int64_t>(draw.bits() >> 1);
    tap.params.master.force_sensor.seed = static_cast<std::int64_t>(draw.bits() >> 1);

    // The wall stands half-way, where a minimum-jerk reach is fastest.
    const double wall = params.environment.position_m / params.control.position_scale;
    tap.path = {.start_m = wall - depth,
                .end_m = wall + depth,
                .start_time_s = tap_rest_s,
                .duration_s = mechanics::MinimumJerk::duration_for(2.0 * depth, speed)};
    if (auto error = check(tap, task.supervised)) return *std::move(error);
    taps.push_back(tap);
  }
  return TappingEnsemble(std::move(taps), task.observation_s, task.supervised);
}

TapResult TappingEnsemble::run(std::size_t tap, std::vector<simulation::Teleoperator::Record>* trace) const {
  return supervised_ ? run_tap<simulation::SupervisedTeleoperator>(taps_[tap], observer(tap), trace)
                     : run_tap<simulation::Teleoperator>(taps_[tap], observer(tap), trace);
}

namespace {

/// Whether a tap that did not settle, whose time is only a lower bound, enters the quantile `q` of the settling times.
bool is_censored(std::vector<TapResult> taps, double q) {
  const auto place = static_cast<std::size_t>(std::ceil(q * static_cast<double>(taps.size() - 1)));
  std::sort(taps.begin(), taps.end(),
            [](const auto& a, const auto& b) { return a.metrics.settling_time_s < b.metrics.settling_time_s; });
  return std::any_of(taps.begin(), taps.begin() + static_cast<std::ptrdiff_t>(place) + 1,
                     [](const TapResult& tap) { return !tap.metrics.settled; });
}

}  // namespace

TappingMetrics summarise(const std::vector<TapResult>& taps) {
  const auto collect = [&taps](auto&& value) {
    std::vector<double> values;
    values.reserve(taps.size());
    for (const TapResult& tap : taps) values.push_back(static_cast<double>(value(tap)));
    return values;
  };
  const auto settling = collect([](const TapResult& tap) { return tap.metrics.settling_time_s; });
  const auto settled =
      std::count_if(taps.begin(), taps.end(), [](const TapResult& tap) { return tap.metrics.settled; });
  const bool diverged = std::any_of(taps.begin(), taps.end(), [](const TapResult& tap) { return tap.diverged; });

  TappingMetrics metrics;
  metrics.taps = taps.size();
  for (const TapResult& tap : taps) {
    if (tap.stopped && metrics.stopped++ == 0) metrics.stopped_by = tap.stopped;
  }
  metrics.settled_fraction = static_cast<double>(settled) / static_cast<double>(taps.size());
  metrics.settling_time_median_s = simulation::quantile(settling, 0.5);
  metrics.settling_time_p90_s = simulation::quantile(settling, 0.9);
  metrics.settling_time_median_censored = is_censored(taps, 0.5);
  metrics.settling_time_p90_censored = is_censored(taps, 0.9);
  metrics.contacts_median =
      simulation::quantile(collect([](const TapResult& tap) { return tap.metrics.contacts; }), 0.5);
  metrics.peak_force_N =
      simulation::quantile(collect([](const TapResult& tap) { return tap.metrics.peak_force_N; }), 0.5);
  metrics.residual_rms_N =
      simulation::quantile(collect([](const TapResult& tap) { return tap.metrics.residual_rms_N; }), 0.5);
  if (diverged) {
    metrics.verdict = Verdict::diverged;
  } else if (metrics.stopped > 0) {
    metrics.verdict = Verdict::stopped;
  } else if (metrics.settled_fraction < 0.5) {
    metrics.verdict = Verdict::limit_cycle;
  } else if (metrics.settled_fraction >= 0.95 && metrics.settling_time_median_s <= settled_within_s) {
    metrics.verdict = Verdict::settled;
  } else {
    metrics.verdict = Verdict::ringing;
  }
  return metrics;
}

std::size_t median_tap(const std::vector<TapResult>& taps) {
  std::vector<std::size_t> order(taps.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&taps](std::size_t a, std::size_t b) {
    return taps[a].metrics.settling_time_s < taps[b].metrics.settling_time_s;
  });
  return order[(order.size() - 1) / 2];
}

}  // namespace tactus::experiments
