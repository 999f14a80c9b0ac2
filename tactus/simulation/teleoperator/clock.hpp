// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/station/teleoperator_params.hpp>

namespace tactus::simulation {

using station::ServoParams;

/// How finely the plants are stepped.
struct PlantClockParams {
  double longest_step_s = 10e-6;
  static constexpr auto fields() {
    return List{field(
        "longest_step_s", &PlantClockParams::longest_step_s, units::second, between(1e-7, 1e-4),
        "Longest integration step of the plants. A control cycle is divided into equal steps that are not longer.")};
  }
};

/// How virtual time is cut up: ticks of the servo, each a whole number of equal substeps of the plants.
struct Clock {
  double tick_s;
  double substep_s;
  int substeps;       ///< in a tick
  int late_substeps;  ///< at the start of a tick, still on the previous command: the computation delay

  /// Errors: `inconsistent` for a computation delay of a tick or more.
  static Result<Clock> make(const ServoParams& servo, const PlantClockParams& plant);
};

}  // namespace tactus::simulation
