// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/contest/contest.hpp>
#include <tactus/simulation/experiments/contest/score_bytes.hpp>
#include <tactus/simulation/experiments/contest/spectral_error.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tactus::experiments {

namespace {

constexpr double kept_before_touch_s = 0.005;
constexpr double reach_m = 0.06;
constexpr double reach_s = 0.5;

double round_trip_s(const simulation::Teleoperator::Params& params) {
  return params.channel.to_slave.delay_s + params.channel.to_master.delay_s;
}

/// What the hand should feel and what it feels, over the taps that touched.
std::optional<double> hand_error(const TappingParams& params,
                                 const std::vector<simulation::Teleoperator::Record>& trace, double first_touch_s) {
  std::vector<double> wanted;
  std::vector<double> felt;
  const double limit_N = params.control.force_limit_N;
  for (const simulation::Teleoperator::Record& record : trace) {
    if (record.time_s < first_touch_s - kept_before_touch_s) continue;
    wanted.push_back(std::clamp(params.control.force_gain * record.contact_force_N, -limit_N, limit_N));
    felt.push_back(record.hand_force_N);
  }
  return spectral_error(wanted, felt, 1.0 / params.servo.rate_Hz, contest_band_lower_Hz, contest_band_upper_Hz);
}

/// Between what the slave told and the contact force at its sample, from first touch on.
double sent_force_error(const std::vector<simulation::Teleoperator::Record>& trace, double first_touch_s) {
  double squares = 0.0;
  std::size_t counted = 0;
  for (std::size_t i = 1; i < trace.size(); ++i) {
    if (trace[i].time_s < first_touch_s) continue;
    const double error_N = trace[i].sent_force_N - trace[i - 1].contact_force_N;
    squares += error_N * error_N;
    ++counted;
  }
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(counted, 1)));
}

}  // namespace

Check check(const GainSearch& search) {
  if (search.lowest_gain < search.highest_gain) return {};
  return Error{.code = ErrorCode::inconsistent,
               .parameter = "task.highest_gain",
               .message = rounded_number(search.highest_gain) + " is not above lowest_gain, " +
                          rounded_number(search.lowest_gain) + ": raise one or lower the other",
               .place = {}};
}

TappingParams tapping_of(const simulation::Teleoperator::Params& teleoperator, const TapSeries& taps) {
  TappingParams params;
  static_cast<simulation::Teleoperator::Params&>(params) = teleoperator;
  static_cast<TapSeries&>(params.task) = taps;
  params.task.supervised = false;
  return params;
}

TappingParams with_display(TappingParams params, double force_limit_N) {
  params.control.force_limit_N = force_limit_N;
  return params;
}

TappingParams with_grip(TappingParams params, double factor) {
  params.person.grip_change = {.factor = factor, .start_s = 0.0, .duration_s = 0.0};
  return params;
}

TappingParams with_delay(TappingParams params, double each_way_s) {
  params.channel.to_slave.delay_s = each_way_s;
  params.channel.to_master.delay_s = each_way_s;
  params.task.observation_s += 5.0 * round_trip_s(params);
  return params;
}

GainLimit tapping_gain_limit(TappingParams params, const GainSearch& search) {
  return find_gain_limit(search.lowest_gain, search.highest_gain, [&params](double gain) {
    params.control.force_gain = gain;
    return taps_settle(params);
  });
}

bool taps_settle(const TappingParams& params) {
  const auto ensemble = TappingEnsemble::make(params);
  const std::size_t may_fail = ensemble->size() / 20;
  std::size_t failed = 0;
  std::vector<double> settling_s;
  for (std::size_t tap = 0; tap < ensemble->size() && failed <= may_fail; ++tap) {
    const TapResult result = ensemble->run(tap);
    if (!result.metrics.settled) ++failed;
    settling_s.push_back(result.metrics.settling_time_s);
  }
  return failed <= may_fail && simulation::quantile(settling_s, 0.5) <= settled_within_s + 2.0 * round_trip_s(params);
}

GainScore score_taps(const TappingParams& params) {
  const auto ensemble = TappingEnsemble::make(params);
  std::vector<TapResult> taps;
  std::vector<double> errors;
  std::vector<double> sent_errors_N;
  for (std::size_t tap = 0; tap < ensemble->size(); ++tap) {
    std::vector<simulation::Teleoperator::Record> trace;
    taps.push_back(ensemble->run(tap, &trace));
    if (!taps.back().touched) continue;
    if (const auto error = hand_error(params, trace, taps.back().first_touch_s)) errors.push_back(*error);
    sent_errors_N.push_back(sent_force_error(trace, taps.back().first_touch_s));
  }
  GainScore score{.force_gain = params.control.force_gain,
                  .force_limit_N = params.control.force_limit_N,
                  .metrics = summarise(taps),
                  .spectral_error = {},
                  .sent_force_error_N = {}};
  if (!errors.empty()) score.spectral_error = simulation::quantile(errors, 0.5);
  if (!sent_errors_N.empty()) score.sent_force_error_N = simulation::quantile(sent_errors_N, 0.5);
  return score;
}

FreeSpaceScore score_free_space(const simulation::Teleoperator::Params& params) {
  constexpr double rest_s = 0.05;
  constexpr double touch_timeout_s = 0.5;
  const double end_m = params.environment.position_m / params.control.position_scale - reach_m;
  const mechanics::MinimumJerk path{
      .start_m = end_m - reach_m, .end_m = end_m, .start_time_s = rest_s, .duration_s = reach_s};
  const double half_way_m = 0.5 * (path.start_m + path.end_m);
  auto teleoperator = simulation::Teleoperator::make(params, path.start_m);
  const double tick_s = teleoperator->tick_s();

  double squares = 0.0;
  double displayed_squares = 0.0;
  std::size_t counted = 0;
  std::optional<double> master_half_way_s;
  std::optional<double> slave_half_way_s;
  for (double time_s = 0.0; time_s < rest_s + reach_s + touch_timeout_s + round_trip_s(params); time_s += tick_s) {
    const auto record = teleoperator->step(path.position_m(time_s), path.position_m(time_s + tick_s));
    if (time_s >= rest_s && time_s <= rest_s + reach_s) {
      squares += record.hand_force_N * record.hand_force_N;
      displayed_squares += record.displayed_force_N * record.displayed_force_N;
      ++counted;
    }
    if (!master_half_way_s && record.master_position_m >= half_way_m) master_half_way_s = time_s;
    if (!slave_half_way_s && record.tip_position_m >= half_way_m * params.control.position_scale) {
      slave_half_way_s = time_s;
    }
  }
  FreeSpaceScore score{.hand_force_rms_N = std::sqrt(squares / static_cast<double>(counted)),
                       .displayed_force_rms_N = std::sqrt(displayed_squares / static_cast<double>(counted)),
                       .lag_s = {}};
  if (master_half_way_s && slave_half_way_s) score.lag_s = *slave_half_way_s - *master_half_way_s;
  return score;
}

Result<std::vector<ContestJob>> contest_jobs(std::size_t method, const ContestParams& params) {
  if (auto error = validate(params)) return *std::move(error);
  const ContestTask task = params.task;
  if (auto error = check(task)) return *std::move(error);
  const TappingParams nominal = tapping_of(params, params.task);
  const TappingParams strong = with_display(nominal, task.strong_display_N);
  std::vector<TappingParams> conditions;
  std::vector<ContestJob> jobs;
  const auto add = [&](std::string name, auto compute, auto place) {
    jobs.push_back(
        {.method = method,
         .name = std::move(name),
         .run = [compute] { return to_bytes(compute()); },
         .take = [place](std::string_view piece, MethodScore& score) { return from_bytes(piece, place(score)); }});
  };
  const auto find_limit = [&](std::string name, const TappingParams& condition, auto place) {
    conditions.push_back(condition);
    add(
        "gain limit, " + std::move(name), [condition, task] { return tapping_gain_limit(condition, task); }, place);
  };
  const auto score_at = [&](std::string name, TappingParams condition, double gain, auto place) {
    condition.control.force_gain = gain;
    conditions.push_back(condition);
    add(
        "taps, " + std::move(name), [condition] { return score_taps(condition); }, place);
  };

  // The longest first, so that no core waits for them at the end.
  for (std::size_t i = contest_delays_s.size(); i-- > 0;) {
    find_limit(
        "delay " + std::to_string(i),
        with_delay(nominal, contest_delays_s[i]), [i](MethodScore & s) -> auto& { return s.delayed[i]; });
  }
  find_limit(
      "nominal", nominal, [](MethodScore & s) -> auto& { return s.limit; });
  find_limit(
      "strong display", strong, [](MethodScore & s) -> auto& { return s.strong_display; });
  for (std::size_t i = 0; i < contest_grips.size(); ++i) {
    find_limit(
        "grip " + std::to_string(i),
        with_grip(nominal, contest_grips[i]), [i](MethodScore & s) -> auto& { return s.gripped[i]; });
  }
  for (std::size_t i = 0; i < contest_gains.size(); ++i) {
    score_at(
        "nominal, gain " + std::to_string(i), nominal,
        contest_gains[i], [i](MethodScore & s) -> auto& { return s.at_gain[i]; });
    score_at(
        "strong display, gain " + std::to_string(i), strong,
        contest_gains[i], [i](MethodScore & s) -> auto& { return s.strong_at_gain[i]; });
  }
  simulation::Teleoperator::Params free_space = nominal;
  free_space.control.force_gain = 1.0;
  add(
      "free space", [free_space] { return score_free_space(free_space); },
      [](MethodScore & s) -> auto& { return s.free_space; });

  for (TappingParams& condition : conditions) {
    condition.task.taps = 1;
    if (auto ensemble = TappingEnsemble::make(condition); !ensemble) return ensemble.error();
  }
  return jobs;
}

}  // namespace tactus::experiments
