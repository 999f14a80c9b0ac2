// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/angle.hpp>
#include <tactus/analysis/stability/scorecard.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

namespace tactus::stability {

namespace {

/// Calls `visit(key, value, bounds)` for every number of a parameter struct, nested ones included.
template <class T, class Visit>
void for_each_number(T& params, const std::string& prefix, const Visit& visit) {
  for_each_field<T>([&](const auto& field) {
    auto& value = params.*field.member;
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (Described<Value>) {
      for_each_number(value, prefix + field.name + ".", visit);
    } else if constexpr (std::is_same_v<Value, double>) {
      visit(prefix + field.name, value, field.bounds);
    }
  });
}

bool same(const StateSpace& a, const StateSpace& b) {
  return a.states() == b.states() && a.a == b.a && a.b == b.b && a.c == b.c && a.d == b.d;
}

/// Hand force over motor force, the hand at rest holding the handle as the file says.
struct ForceWay {
  StateSpace device;
  TipLoad grip;
  [[nodiscard]] double at(double frequency_Hz) const {
    const auto answer = response(device, {0.0, turn * frequency_Hz});
    return std::abs(grip.stiffness_N_per_m * answer(tip_out, command_in) +
                    grip.damping_N_s_per_m * answer(tip_velocity_out, command_in));
  }
};

void judge_force_way(const simulation::Teleoperator::Params& params, const Linearisation& linearisation,
                     Scorecard& card) {
  const ForceWay way{
      .device = linear_device(params.master.mechanism, params.master.amplifier, params.master.force_sensor.bandwidth_Hz,
                              params.person.grip, linearisation),
      .grip = params.person.grip};
  const double highest_Hz = 0.5 * params.servo.rate_Hz;
  const double at_rest = way.at(1.0);
  const double low = at_rest / std::numbers::sqrt2;
  double before_Hz = 1.0;
  for (double frequency_Hz = 1.0; frequency_Hz <= highest_Hz; frequency_Hz *= 1.005) {
    const double gain = way.at(frequency_Hz);
    if (gain / at_rest > card.force_peak) {
      card.force_peak = gain / at_rest;
      card.force_peak_Hz = frequency_Hz;
    }
    if (!card.force_bandwidth_Hz && gain < low) {
      double lower = before_Hz, upper = frequency_Hz;
      for (int i = 0; i < 40; ++i) {
        const double middle = 0.5 * (lower + upper);
        (way.at(middle) > low ? lower : upper) = middle;
      }
      card.force_bandwidth_Hz = lower;
    }
    before_Hz = frequency_Hz;
  }
}

std::vector<Sensitivity> sensitivities(const simulation::Teleoperator::Params& params,
                                       const Linearisation& linearisation, const Loop& nominal, double limit,
                                       const experiments::Progress& progress) {
  constexpr double raised = 1.1, least_change = 1e-3;
  simulation::Teleoperator::Params changed = params;
  std::size_t numbers = 0, done = 0;
  for_each_number(changed, "", [&numbers](const auto&, auto&, const auto&) { ++numbers; });
  std::vector<Sensitivity> found;
  for_each_number(changed, "", [&](const std::string& key, double& value, const Bounds& bounds) {
    if (progress) progress(static_cast<double>(++done) / static_cast<double>(numbers));
    const double as_it_was = value;
    if (as_it_was == 0.0 || key == "control.force_gain" || !bounds.contain(raised * as_it_was)) return;
    value = raised * as_it_was;
    const auto loop = make_loop(changed, linearisation);
    value = as_it_was;
    if (!loop) return;
    const bool untouched = same(loop->master, nominal.master) && same(loop->slave, nominal.slave) &&
                           loop->delay_ticks == nominal.delay_ticks && loop->tick_s == nominal.tick_s;
    if (untouched) return;
    const double change = gain_limit(*loop).force_gain / limit - 1.0;
    if (std::fabs(change) >= least_change) found.push_back({.key = key, .limit_change = change});
  });
  std::stable_sort(found.begin(), found.end(), [](const Sensitivity& a, const Sensitivity& b) {
    return std::fabs(a.limit_change) > std::fabs(b.limit_change);
  });
  return found;
}

}  // namespace

Result<Scorecard> score(const simulation::Teleoperator::Params& params, const Linearisation& linearisation,
                        const experiments::Progress& progress) {
  const auto loop = make_loop(params, linearisation);
  if (!loop) return loop.error();
  simulation::Teleoperator::Params plain = params;
  plain.control.cancellation = control::CancellationMode::off;
  const auto plain_loop = make_loop(plain, linearisation);
  if (!plain_loop) return plain_loop.error();
  const auto port = TwoPort::make(params, linearisation);
  if (!port) return port.error();

  Scorecard card;
  card.limit = gain_limit(*loop);
  card.uncancelled = gain_limit(*plain_loop);
  card.mass_ratio = mass_ratio(params);
  judge_force_way(params, linearisation, card);
  card.effort_2_Hz_N_s_per_m = std::abs(port->at(turn * 2.0).h11);
  card.effort_10_Hz_N_s_per_m = std::abs(port->at(turn * 10.0).h11);
  if (std::isfinite(card.limit.force_gain) && card.limit.force_gain > 0.0) {
    card.sensitivities = sensitivities(params, linearisation, *loop, card.limit.force_gain, progress);
  }
  return card;
}

}  // namespace tactus::stability
