#pragma once

#include <tactus/core/parameters.hpp>

namespace tactus::simulation {

/// The servo clock of the sites.
struct ServoParams {
  double rate_Hz = 5000.0;
  double computation_delay_s = 20e-6;
  static constexpr auto fields() {
    return List{field("rate_Hz", &ServoParams::rate_Hz, units::hertz, between(500.0, 20000.0),
                      "Control cycles per second (paper A: 5000)."),
                field("computation_delay_s", &ServoParams::computation_delay_s, units::second, between(0.0, 0.002),
                      "From a sample to the change of the command that follows from it, rounded to whole plant "
                      "steps, less than a control cycle.")};
  }
};

/// How finely the plants are stepped.
struct PlantClockParams {
  double longest_step_s = 10e-6;
  static constexpr auto fields() {
    return List{field("longest_step_s", &PlantClockParams::longest_step_s, units::second, between(1e-7, 1e-4),
                      "Longest step of the plants; a control cycle is cut into equal steps no longer than this.")};
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
