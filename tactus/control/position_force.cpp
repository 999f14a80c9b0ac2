#include <tactus/control/position_force.hpp>
#include <tactus/signal/checks.hpp>

#include <algorithm>

namespace tactus::control {

Result<PositionForceMaster> PositionForceMaster::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto cancellation = Cancellation::make(
      {.model = {.master = params.model, .step = params.cancellation_step, .friction = params.cancellation_friction}},
      dt);
  if (!cancellation) {
    Error error = cancellation.error();
    if (error.parameter == "model.step") error.parameter = "cancellation_step";
    return error;
  }
  const auto gate = SafetyGate::make(params.gate, dt);
  if (!gate) return under("gate", gate.error());
  return PositionForceMaster(params, *cancellation, *gate);
}

PositionForceMaster::Output PositionForceMaster::step(const Input& input) noexcept {
  const double wanted = std::clamp(force_gain_ * input.message.tip_force_N, -force_limit_N_, force_limit_N_);
  // A NaN passes through clamp, so it reaches the gate, which catches and latches it.
  const double motor_force = gate_.step(-wanted);
  const double induced = cancellation_.model().motor_position_m();
  const double intended =
      cancellation_.step({.measured_position_m = input.measurement.motor_position_m, .motor_force_N = motor_force});
  const double command = mode_ == CancellationMode::on ? intended : input.measurement.motor_position_m;
  return {.motor_force_N = motor_force,
          .message = {.position_command_m = position_scale_ * command},
          .displayed_force_N = -motor_force,
          .induced_position_m = induced,
          .intended_position_m = intended};
}

void PositionForceMaster::reset() noexcept {
  cancellation_.reset();
  gate_.reset();
}

Result<PositionForceSlave> PositionForceSlave::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto error_rate = signal::FilteredDerivative::make(params.velocity, dt);
  if (!error_rate) return under("velocity", error_rate.error());
  const auto gate = SafetyGate::make(params.gate, dt);
  if (!gate) return under("gate", gate.error());
  return PositionForceSlave(params, *error_rate, *gate);
}

PositionForceSlave::Output PositionForceSlave::step(const Input& input) noexcept {
  const double error_m = input.message.position_command_m - input.measurement.motor_position_m;
  const double force = proportional_N_per_m_ * error_m + derivative_N_s_per_m_ * error_rate_.step(error_m);
  return {.motor_force_N = gate_.step(force), .message = {.tip_force_N = input.measurement.tip_force_N}};
}

void PositionForceSlave::reset() noexcept {
  error_rate_.reset();
  gate_.reset();
}

}  // namespace tactus::control
