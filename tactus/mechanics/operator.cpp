#include <tactus/mechanics/operator.hpp>

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
  return Operator(params, dt, *low_pass, *reaction);
}

Operator::Operator(const Params& params, Seconds dt, const signal::LowPass& low_pass, const Reaction& reaction)
    : dt_s_(dt.value),
      correction_gain_per_s_(params.correction.gain_per_s),
      tremor_start_{.cosine = std::cos(2.0 * std::numbers::pi * params.tremor_phase_cycles),
                    .sine = std::sin(2.0 * std::numbers::pi * params.tremor_phase_cycles)},
      tremor_turn_{.cosine = std::cos(2.0 * std::numbers::pi * params.tremor_frequency_Hz * dt.value),
                   .sine = std::sin(2.0 * std::numbers::pi * params.tremor_frequency_Hz * dt.value)},
      tremor_amplitude_m_(params.tremor_amplitude_m),
      tremor_(tremor_start_),
      low_pass_(low_pass),
      reaction_(reaction) {}

Operator::Output Operator::step(const Input& input) noexcept {
  const double error_m = reaction_.step(low_pass_.step(input.handle_position_m - input.path_m));
  const double correction_velocity = -correction_gain_per_s_ * error_m;
  const double tremor_now_m = tremor_amplitude_m_ * tremor_.sine;
  tremor_ = {.cosine = tremor_.cosine * tremor_turn_.cosine - tremor_.sine * tremor_turn_.sine,
             .sine = tremor_.sine * tremor_turn_.cosine + tremor_.cosine * tremor_turn_.sine};
  const double tremor_next_m = tremor_amplitude_m_ * tremor_.sine;

  const Output aim{
      .position_m = input.path_m + tremor_now_m + correction_m_,
      .velocity_m_per_s =
          (input.path_at_next_tick_m - input.path_m + tremor_next_m - tremor_now_m) / dt_s_ + correction_velocity};
  correction_m_ += correction_velocity * dt_s_;
  return aim;
}

void Operator::reset() noexcept {
  tremor_ = tremor_start_;
  correction_m_ = 0.0;
  low_pass_.reset();
  reaction_.reset();
}

}  // namespace tactus::mechanics
