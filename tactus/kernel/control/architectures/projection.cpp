// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/projection.hpp>
#include <tactus/kernel/signal/checks.hpp>

#include <algorithm>

namespace tactus::control {

double held_force_N(double force_N, double hand_force_N, double negligible_force_N) noexcept {
  const double squared = std::max(hand_force_N * hand_force_N, negligible_force_N * negligible_force_N);
  return std::clamp(hand_force_N * force_N / squared, 0.0, 1.0) * hand_force_N;
}

Result<ProjectionMaster> ProjectionMaster::make(const Params& params, Seconds dt) {
  if (auto error = signal::check(params, dt)) return *std::move(error);
  const auto display = PositionForceMaster::make(params.position_force, dt);
  if (!display) return under("position_force", display.error());
  const MasterModel& model = params.position_force.model;
  const auto hand = HandForceObserver::make({.mass_kg = model.motor.mass_kg + model.drum.mass_kg + model.handle.mass_kg,
                                             .friction_N = model.motor.friction_N + model.drum.friction_N,
                                             .cutoff_Hz = params.projection.hand_force_cutoff_Hz},
                                            dt);
  if (!hand) {
    Error error = hand.error();
    if (error.parameter == "cutoff_Hz") error.parameter = "projection.hand_force_cutoff_Hz";
    return error;
  }
  return ProjectionMaster(params.projection, *display, *hand);
}

namespace {

Result<Controllers> make_projection(const ControlParams& params, Seconds dt) {
  const auto master =
      ProjectionMaster::make({.position_force = params, .projection = params.own<ProjectionParams>()}, dt);
  if (!master) return out_of("position_force", master.error());
  const auto slave = PositionForceSlave::make(params.slave, dt);
  if (!slave) return under("slave", slave.error());
  return Controllers{master_controller(*master), slave_controller(*slave)};
}

}  // namespace

Architecture projection_architecture() {
  return {.name = "projection",
          .summary = "position-force that displays at once only what the hand holds",
          .make = make_projection,
          .keys = own_keys<ProjectionParams>(
              "projection", "Architecture projection: share of the force that is displayed immediately.")};
}

}  // namespace tactus::control
