#include <tactus/control/position_force.hpp>
#include <tactus/signal/checks.hpp>

#include <algorithm>

namespace tactus::control {

Result<PositionForceMaster> PositionForceMaster::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto cancellation = Cancellation::make({.model = {.master = params.model,
                                                          .fidelity = params.cancellation_model,
                                                          .step = params.cancellation_step,
                                                          .friction = params.cancellation_friction}},
                                               dt);
  if (!cancellation) {
    Error error = cancellation.error();
    if (error.parameter == "model.step") error.parameter = "cancellation_step";
    return error;
  }
  return PositionForceMaster(params, *cancellation);
}

PositionForceMaster::Output PositionForceMaster::respond(const Input& input) noexcept {
  // A NaN passes through clamp, so it reaches the gate, which catches and latches it.
  const double displayed_N = std::clamp(force_gain_ * input.arrival.message.force_N, -force_limit_N_, force_limit_N_);
  const double intended_m = cancellation_.intended(input.motor_position_m);
  const double command_m = mode_ == CancellationMode::on ? intended_m : input.motor_position_m;
  return {.motor_force_N = -displayed_N,
          .message = {.position_m = position_scale_ * command_m},
          .induced_position_m = cancellation_.model().motor_position_m(),
          .intended_position_m = intended_m};
}

Result<PositionForceSlave> PositionForceSlave::make(const Params& params, Seconds dt) {
  const auto servo = ServoPd::make(params, dt);
  if (!servo) return servo.error();
  return PositionForceSlave(*servo);
}

}  // namespace tactus::control
