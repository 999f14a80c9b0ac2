// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/margins.hpp>
#include <tactus/analysis/stability/two_port.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <optional>
#include <string>
#include <vector>

/// A master device judged by the induced motion that it allows (paper A, Sec. IX: choosing hardware by it).
namespace tactus::stability {

/// What 10 % more of one described parameter does.
struct Sensitivity {
  std::string key;          ///< as in a file: `master.mechanism.drum.mass_kg`
  double limit_change = 0;  ///< of the gain limit, as a share of it
};

struct Scorecard {
  GainLimit limit;          ///< as the file has it
  GainLimit uncancelled;    ///< the same without cancellation: the device by itself
  double mass_ratio = 0.0;  ///< Daniel and McAree's bound on λ μ
  /// Where the force on the hand has fallen by 3 dB from what the motor does at 1 Hz, held as the file states; none
  /// where that lies beyond half the servo rate.
  std::optional<double> force_bandwidth_Hz;
  double force_peak = 0.0;     ///< largest hand force over motor force up to half the servo rate, over that at 1 Hz
  double force_peak_Hz = 0.0;  ///< where
  double effort_2_Hz_N_s_per_m = 0.0;   ///< hand force per handle velocity in free motion, |h11|
  double effort_10_Hz_N_s_per_m = 0.0;  ///< the same at 10 Hz
  /// Every described number of the file that is not zero, raised by 10 % one at a time in the device and nowhere else,
  /// so that with cancellation on the model no longer fits; those that move the limit by 0.1 % or more, largest first.
  /// What cannot be raised within its bounds, or made, is left out.
  std::vector<Sensitivity> sensitivities;
};

/// Errors: those of `make_loop`. Not real-time safe; some seconds, and `progress` reports how far.
Result<Scorecard> score(const simulation::Teleoperator::Params& params, const Linearisation& linearisation,
                        const experiments::Progress& progress);

}  // namespace tactus::stability
