// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architectures/position_force.hpp>

#include <numbers>

/// What the tests of the rivals share: a site, and what goes into it.
namespace tactus::control {

using Params = PositionForceMaster::Params;

inline constexpr double tick_s = 200e-6;

inline PositionForceMaster master(const Params& params) {
  return PositionForceMaster::make(params, Seconds{tick_s}).value();
}

inline MasterInput input(double position_m, double tip_force_N) {
  return {.motor_position_m = position_m, .arrival = {.message = {.force_N = tip_force_N}, .fresh = true}};
}

/// Without cancellation, and with no limit near.
inline Params plain() {
  Params params;
  params.cancellation = CancellationMode::off;
  params.force_limit_N = 100.0;
  return params;
}

inline double angle_of(double frequency_Hz) { return 2.0 * std::numbers::pi * frequency_Hz * tick_s; }

}  // namespace tactus::control
