// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <tests/soak/two_sites.hpp>

namespace tactus::soak {

/// One period of the person's path in figures, as one sees them who stands outside of the sites.
struct Period {
  double peak_master_N = 0.0;  ///< of the master's motor
  double peak_tip_N = 0.0;     ///< measured at the slave's tip
  double farthest_m = -1e9;    ///< of the slave
  double nearest_m = 1e9;
  double master_gave_J = 0.0;  ///< the motor, Σ F·Δx
  double slave_gave_J = 0.0;
};

/// How far figures of a period may be from those of the first hour: forces, positions, energies.
struct PeriodBounds {
  double force_N = 0.0;
  double position_m = 0.0;
  double energy_J = 0.0;
};
/// One period from the mean of the first hour: contact with a stiff wall is not the same twice.
inline constexpr PeriodBounds one_period{.force_N = 0.75, .position_m = 2e-4, .energy_J = 4e-3};
/// The mean of a later hour from that of the first.
inline constexpr PeriodBounds mean_period{.force_N = 0.02, .position_m = 1e-5, .energy_J = 1e-4};

struct DayReport {
  std::vector<std::string> broken{};  ///< what did not hold, in words; the first few
  std::int64_t ticks = 0;
  Period first{}, last{};  ///< means over the first and the last hour
  Period least{}, most{};  ///< of all periods
  Period farthest_mean{};  ///< largest difference of an hour's mean from the first one's
  double master_gave_J = 0.0, slave_gave_J = 0.0;
  double told_energy_J = 0.0;    ///< by the slave, at the end
  double account_error_J = 0.0;  ///< largest difference of a monitor's account and an independent one
  std::int64_t heap_growth = 0, resident_growth = 0;  ///< bytes, from the end of the first hour to that of the last
  bool passed = false;
};

struct DayProgress {
  double virtual_s = 0.0;  ///< passed
  double all_s = 0.0;
};

/// Runs `seconds` of virtual time and looks at everything; what the first of `hours` equal parts showed is what the
/// rest must.
DayReport run_day(const simulation::Teleoperator::Params& params, const Origin& origin, double seconds, int hours,
                  const std::function<void(const DayProgress&)>& progress);

}  // namespace tactus::soak
