#include <tactus/control/architecture.hpp>
#include <tactus/control/position_force.hpp>
#include <tactus/signal/checks.hpp>

#include <algorithm>
#include <string_view>

namespace tactus::control {

Result<PositionForceMaster> PositionForceMaster::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto cancellation =
      GripCancellation::make({.cancellation = {.model = {.master = params.model,
                                                         .fidelity = params.cancellation_model,
                                                         .step = params.cancellation_step,
                                                         .friction = params.cancellation_friction}},
                              .estimate = params.operator_estimate},
                             dt);
  if (!cancellation) {
    Error error = cancellation.error();
    // The keys here are flatter than the parameters of the cancellation.
    constexpr std::string_view nested = "cancellation.model.master.";
    if (error.parameter == "cancellation.model.step") error.parameter = "cancellation_step";
    if (error.parameter.starts_with(nested)) error.parameter.erase(0, nested.size()).insert(0, "model.");
    return error;
  }
  const auto damping = LocalDamping::make(params.damping, dt);
  if (!damping) return under("damping", damping.error());
  const auto command_filter = ShapingFilter::make(params.command_filter, dt);
  if (!command_filter) return under("command_filter", command_filter.error());
  const auto force_filter = ShapingFilter::make(params.force_filter, dt);
  if (!force_filter) return under("force_filter", force_filter.error());
  const auto crossover = Crossover::make(params.crossover, dt);
  if (!crossover) return under("crossover", crossover.error());
  const auto hand_compensation =
      HandForceCompensation::make({.master = params.model, .band_Hz = params.hand_compensation_Hz}, dt);
  if (!hand_compensation) {
    Error error = hand_compensation.error();
    if (error.parameter == "band_Hz") error.parameter = "hand_compensation_Hz";
    return error;
  }
  return PositionForceMaster(params, {.cancellation = *cancellation,
                                      .damping = *damping,
                                      .command_filter = *command_filter,
                                      .force_filter = *force_filter,
                                      .crossover = *crossover,
                                      .hand_compensation = *hand_compensation});
}

PositionForceMaster::Output PositionForceMaster::respond(const Input& input) noexcept {
  const auto [below_N, above_N] =
      stages_.crossover.step(stages_.force_filter.step(force_gain_ * input.arrival.message.force_N));
  const double wanted_N = stages_.hand_compensation.on()
                              ? stages_.hand_compensation.step(std::clamp(below_N, -force_limit_N_, force_limit_N_))
                              : below_N;
  const double damping_N = stages_.damping.step(input.motor_position_m);
  // A NaN passes through clamp, so it reaches the gate, which catches and latches it.
  const double displayed_N = std::clamp(wanted_N - damping_N, -force_limit_N_, force_limit_N_);
  const double handle_N = std::clamp(above_N, -force_limit_N_, force_limit_N_);
  const double intended_m = stages_.cancellation.intended(input.motor_position_m, input.grip);
  const double command_m =
      stages_.command_filter.step(mode_ == CancellationMode::on ? intended_m : input.motor_position_m);
  return {.motor_force_N = -displayed_N,
          .handle_force_N = -handle_N,
          .message = {.position_m = position_scale_ * command_m},
          .induced_position_m = stages_.cancellation.induced_position_m(),
          .intended_position_m = intended_m};
}

Result<PositionForceSlave> PositionForceSlave::make(const Params& params, Seconds dt) {
  const auto servo = ServoPd::make(params, dt);
  if (!servo) return servo.error();
  return PositionForceSlave(*servo);
}

namespace {

Result<Controllers> make_position_force(const ControlParams& params, Seconds dt) {
  const auto master = PositionForceMaster::make(params, dt);
  if (!master) return master.error();
  const auto slave = PositionForceSlave::make(params.slave, dt);
  if (!slave) return under("slave", slave.error());
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

}  // namespace

Architecture position_force_architecture() {
  return {.name = "position-force",
          .summary = "the slave follows the master's position, the master displays the slave's tip force",
          .make = make_position_force};
}

}  // namespace tactus::control
