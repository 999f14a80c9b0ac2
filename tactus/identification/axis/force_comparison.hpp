// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <span>
#include <vector>

namespace tactus::identification {

/// How an estimated force compares with a measured one.
struct ForceComparison {
  double rmse = 0;         ///< root mean square of the difference [unit of the forces]
  double mean_error = 0;   ///< estimate less measurement, mean [unit of the forces]
  double correlation = 0;  ///< Pearson's, at no shift; NaN when one of them is constant
  double lead_s = 0;       ///< by how much the estimate is ahead, where the correlation is greatest, within ±50 ms
  std::vector<double> reference = {};  ///< the measurement after the filter
};

/// Compares an estimate with a measurement that passed a zero-phase low-pass at `cutoff_Hz` (lowered to 40 % of the
/// sample rate where that is less); the estimate is left as it is. The first `skip` samples do not count. The lead is
/// found to a fraction of a sample by a parabola through the three greatest correlations. Errors: `inconsistent` for
/// different lengths or fewer than 200 samples after the skipped ones. Not real-time safe.
Result<ForceComparison> compare_force(std::span<const double> estimate, std::span<const double> measured,
                                      double cutoff_Hz, Seconds dt, std::size_t skip);

/// What an estimate feels where there is nothing to feel.
struct FalseForce {
  double rms = 0;         ///< [unit of the forces]; 0 where the axis never moves freely
  double duration_s = 0;  ///< of free motion in the recording
};

/// The estimate in free motion: where the axis moves, faster than a twentieth of its greatest speed below 30 Hz, and
/// the `reference` stays within 1.5 times the model's `friction` or a tenth of its own greatest value, whichever is
/// more. All of one length, the first `skip` samples left out. Errors: those of the filter. Not real-time safe.
Result<FalseForce> false_force(std::span<const double> estimate, std::span<const double> reference,
                               std::span<const double> position, double friction, Seconds dt, std::size_t skip);

}  // namespace tactus::identification
