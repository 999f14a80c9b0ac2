// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/real_time/repeated_taps.hpp>

#include <cmath>
#include <utility>

namespace tactus::real_time {

namespace {

constexpr double rest_s = 0.3;

}  // namespace

RepeatedTaps::RepeatedTaps(const experiments::TappingParams& params) {
  const experiments::TapSeries& taps = params.task;
  const double depth_m = 0.5 * (taps.shallowest_m + taps.deepest_m);
  const double speed_m_per_s = 0.5 * (taps.slowest_m_per_s + taps.fastest_m_per_s);
  const double wall_m = params.environment.position_m / params.control.position_scale;
  const double reach_s = mechanics::MinimumJerk::duration_for(2.0 * depth_m, speed_m_per_s);
  there_ = {.start_m = wall_m - depth_m, .end_m = wall_m + depth_m, .start_time_s = rest_s, .duration_s = reach_s};
  back_ = {.start_m = 0.0,
           .end_m = -2.0 * depth_m,
           .start_time_s = rest_s + reach_s + taps.observation_s,
           .duration_s = reach_s};
  period_s_ = back_.start_time_s + reach_s;
}

double RepeatedTaps::position_m(double time_s) const noexcept {
  const double time_in_period_s = std::fmod(time_s, period_s_);
  return there_.position_m(time_in_period_s) + back_.position_m(time_in_period_s);
}

Result<runtime::SiteDevice> simulated_device(const experiments::TappingParams& params, control::SiteRole role) {
  if (auto error = validate(params)) return *std::move(error);
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const RepeatedTaps path(params);
  if (role == control::SiteRole::slave) {
    const double start_m = params.control.position_scale * path.start_m();
    const auto plant = simulation::SlavePlant::make(params.slave, params.environment, *clock, start_m);
    if (!plant) return plant.error();
    return runtime::SiteDevice{.device = std::make_unique<SimulatedSlave>(*plant, *clock, station::DeviceLimits{})};
  }
  const auto plant = simulation::MasterPlant::make(params.master, params.person, *clock, path.start_m());
  if (!plant) return plant.error();
  auto device = std::make_unique<SimulatedMasterOf<PatientOperator>>(
      *plant, *clock, PatientOperator(path, clock->tick_s), station::DeviceLimits{});
  PatientOperator* const person = &device->person();
  return runtime::SiteDevice{.device = std::move(device), .person = person};
}

}  // namespace tactus::real_time
