// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/operator.hpp>

#include <cmath>
#include <numbers>

namespace tactus::mechanics {

Result<Operator> Operator::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto low_pass = signal::LowPass::make({.cutoff_Hz = params.correction.bandwidth_Hz}, dt);
  if (!low_pass) {
    Error error = low_pass.error();
    error.parameter = "correction.bandwidth_Hz";
    return error;
  }
  const auto reaction = Reaction::make({.delay_s = params.correction.reaction_time_s}, dt);
  if (!reaction) {
    Error error = reaction.error();
    error.parameter = "correction.reaction_time_s";
    return error;
  }
  const double phase = 2.0 * std::numbers::pi * params.tremor_phase_cycles;
  const double turn = 2.0 * std::numbers::pi * params.tremor_frequency_Hz * dt.value;
  return Operator({.dt_s = dt.value,
                   .correction_gain_per_s = params.correction.gain_per_s,
                   .tremor_amplitude_m = params.tremor_amplitude_m,
                   .tremor_turn = {.cosine = std::cos(turn), .sine = std::sin(turn)},
                   .tremor = {.cosine = std::cos(phase), .sine = std::sin(phase)},
                   .correction_m = 0.0,
                   .low_pass = low_pass->section()},
                  *reaction);
}

Operator::Output Operator::step(const Input& input) noexcept {
  const double error_m = reaction_.step(motion_.felt(input.handle_position_m, input.path_m));
  return motion_.step(input.path_m, input.path_at_next_tick_m, error_m);
}

void Operator::reset() noexcept {
  motion_ = start_;
  reaction_.reset();
}

}  // namespace tactus::mechanics
