// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/clock.hpp>

#include <cmath>

namespace tactus::simulation {

Result<Clock> Clock::make(const ServoParams& servo, const PlantClockParams& plant) {
  const double tick_s = 1.0 / servo.rate_Hz;
  constexpr double round_off = 1e-9;
  const double substeps = std::ceil(tick_s / plant.longest_step_s - round_off);
  const double substep_s = tick_s / substeps;
  const double late_substeps = std::round(servo.computation_delay_s / substep_s);
  if (late_substeps >= substeps) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "servo.computation_delay_s",
                 .message = rounded_number(servo.computation_delay_s) + " s, rounded to plant steps of " +
                            rounded_number(substep_s) + " s, must be less than a control cycle, " +
                            rounded_number(tick_s) + " s: shorten the delay or lower the rate",
                 .place = {}};
  }
  return Clock{.tick_s = tick_s,
               .substep_s = substep_s,
               .substeps = static_cast<int>(substeps),
               .late_substeps = static_cast<int>(late_substeps)};
}

}  // namespace tactus::simulation
