// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/bonded_run.hpp>
#include <tactus/analysis/stability/linear_plant.hpp>

#include <cmath>

namespace tactus::stability {

simulation::Teleoperator::Params linear_version(simulation::Teleoperator::Params params, double preload_N) {
  for (auto* mechanism : {&params.master.mechanism, &params.slave.mechanism}) {
    mechanism->motor.friction_N = 0.0;
    mechanism->drum.friction_N = 0.0;
    mechanism->linkage.hysteretic_fraction = 0.0;
  }
  control::MasterModel& model = params.control.model;
  model.motor.friction_N = 0.0;
  model.drum.friction_N = 0.0;
  model.linkage.hysteretic_fraction = 0.0;
  model.hand.quintic_stiffness_N_per_m5 = 0.0;
  params.master.encoder.resolution_m = 0.0;
  params.slave.encoder.resolution_m = 0.0;
  for (auto* sensor : {&params.master.force_sensor, &params.slave.force_sensor}) {
    sensor->noise_rms_N = 0.0;
    sensor->offset_N = 0.0;
  }
  params.person.tremor_amplitude_m = 0.0;
  params.person.correction.gain_per_s = 0.0;
  params.person.grip_change.factor = 1.0;
  for (auto* channel : {&params.channel.to_slave, &params.channel.to_master}) {
    channel->jitter_s = 0.0;
    channel->loss_fraction = 0.0;
  }
  const TipLoad wall = wall_load(params.environment, preload_N);
  params.environment = {.law = mechanics::ContactLaw::bonded,
                        .position_m = params.environment.position_m,
                        .stiffness_N_per_m = wall.stiffness_N_per_m,
                        .damping_N_s_per_m = wall.damping_N_s_per_m};
  return params;
}

bool disturbance_decays(const simulation::Teleoperator::Params& params, double duration_s) {
  constexpr double touch_m = 1e-6;
  constexpr double linear_up_to_N = 0.01;
  const double rest_m = params.environment.position_m / params.control.position_scale;
  auto teleoperator = simulation::Teleoperator::make(params, rest_m);
  const auto ticks = std::lround(duration_s / teleoperator->tick_s());
  double before_N = 0.0, long_before_N = 0.0, early = 0.0, late = 0.0;
  for (long tick = 0; tick < ticks; ++tick) {
    const double now_m = rest_m + (tick > 0 ? touch_m : 0.0);
    const double force_N = teleoperator->step(now_m, rest_m + touch_m).contact_force_N;
    // Written so that a NaN counts as too much. Far below any limit of force or rate, so that all stays linear.
    if (!(std::fabs(force_N) < linear_up_to_N) || !teleoperator->healthy()) return false;
    const double bend_N = force_N - 2.0 * before_N + long_before_N;
    long_before_N = before_N;
    before_N = force_N;
    const long part = 10 * tick / ticks;
    if (part == 2) early += bend_N * bend_N;
    if (part == 9) late += bend_N * bend_N;
  }
  return late < early;
}

experiments::GainLimit bisect_linear_limit(simulation::Teleoperator::Params params, double lowest, double highest) {
  const auto decays = [&params](double gain) {
    params.control.force_gain = gain;
    return disturbance_decays(params);
  };
  experiments::GainLimit limit = experiments::find_gain_limit(lowest, highest, decays);
  if (limit.beyond_search || limit.gain == 0.0) return limit;
  double stable = limit.gain, unstable = limit.gain * experiments::gain_resolution;
  while (unstable > 1.001 * stable) {
    const double middle = std::sqrt(stable * unstable);
    (decays(middle) ? stable : unstable) = middle;
  }
  return {.gain = std::sqrt(stable * unstable)};
}

}  // namespace tactus::stability
