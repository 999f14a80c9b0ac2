// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/estimators/narx_force_estimator.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace tactus::control {

namespace {

/// No product of three variables can overflow.
double held(double variable) { return std::clamp(variable, -1000.0, 1000.0); }

}  // namespace

NarxTerms NarxTerms::of(std::span<const NarxTerm> terms) noexcept {
  const auto at = [terms](std::size_t i) { return i < terms.size() ? terms[i] : NarxTerm{}; };
  return {at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7), at(8), at(9), at(10), at(11)};
}

Result<NarxMemory> NarxMemory::make(const NarxScales& scales, double actuator_gain, Seconds dt) {
  if (Check error = signal::check(scales, dt)) return *std::move(error);
  const auto filter =
      signal::SecondOrderFilter::make({.kind = signal::FilterKind::low_pass, .frequency_Hz = scales.cutoff_Hz}, dt);
  if (!filter) {
    Error error = filter.error();
    error.parameter = "cutoff_Hz";
    return error;
  }
  const double ticks = std::round(scales.lag_s / dt.value);
  if (!(ticks >= 1.0 && ticks <= static_cast<double>(most_lag_ticks))) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "lag_s",
                 .message = "is " + rounded_number(scales.lag_s) + " s, which must be 1 to " +
                            std::to_string(most_lag_ticks) + " samples of " + rounded_number(dt.value) + " s",
                 .place = {}};
  }
  return NarxMemory(*filter, scales, actuator_gain, static_cast<std::size_t>(ticks));
}

NarxMemory::Variables NarxMemory::see(const SlaveMotionSample& sample) noexcept {
  if (!started_) {
    position_filter_.settle(sample.position);
    positions_m_.fill(sample.position);
    started_ = true;
  }
  positions_m_[now_] = position_filter_.step(sample.position);
  command_N_ = command_filter_.step(actuator_gain_ * sample.command);
  const auto ago = [this](std::size_t lags) { return (now_ + capacity - lags * lag_ticks_) % capacity; };
  Variables variables{1.0};
  for (std::size_t i = 0; i < NarxVariables::most_differences; ++i) {
    const double difference_m = positions_m_[ago(i)] - positions_m_[ago(i + 1)];
    variables[NarxVariables::first_difference + i] = held(difference_m / scales_.difference_scale_m);
  }
  for (std::size_t i = 0; i < NarxVariables::most_outputs; ++i) {
    variables[NarxVariables::first_output + i] = held(outputs_N_[ago(i + 1)] / scales_.force_limit_N);
  }
  return variables;
}

void NarxMemory::remember(double output_N) noexcept {
  outputs_N_[now_] = output_N;
  now_ = now_ + 1 < capacity ? now_ + 1 : 0;
}

void NarxMemory::reset() noexcept {
  position_filter_.reset();
  command_filter_.reset();
  positions_m_.fill(0.0);
  outputs_N_.fill(0.0);
  now_ = 0;
  command_N_ = 0.0;
  started_ = false;
}

Result<NarxForceEstimator> NarxForceEstimator::make(const Params& params, Seconds dt) {
  if (Check error = signal::check(params, dt)) return *std::move(error);
  const auto memory = NarxMemory::make(params.scales, params.actuator_gain, dt);
  if (!memory) return under("scales", memory.error());
  NarxForceEstimator estimator(*memory, params.scales.force_limit_N);
  for (const NarxTerm& term : params.terms.all()) {
    if (term.coefficient_N == 0.0) continue;
    estimator.products_[estimator.count_++] = {
        .coefficient_N = term.coefficient_N,
        .variables = {static_cast<std::size_t>(term.variable_1), static_cast<std::size_t>(term.variable_2),
                      static_cast<std::size_t>(term.variable_3)}};
  }
  return estimator;
}

ForceEstimate NarxForceEstimator::step(const SlaveMotionSample& sample) noexcept {
  const NarxMemory::Variables v = memory_.see(sample);
  double output_N = 0.0;
  for (std::size_t i = 0; i < count_; ++i) {
    const auto& [coefficient_N, variables] = products_[i];
    output_N += coefficient_N * v[variables[0]] * v[variables[1]] * v[variables[2]];
  }
  output_N = std::clamp(output_N, -limit_N_, limit_N_);
  memory_.remember(output_N);
  return {.force = output_N - memory_.command_N()};
}

}  // namespace tactus::control
