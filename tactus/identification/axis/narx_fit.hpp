// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/narx_force_estimator.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus::identification {

/// Which polynomial NARX terms stand for election.
struct NarxStructure {
  std::int64_t degree = 3;
  std::int64_t differences = 4;
  std::int64_t output_lags = 0;
  std::int64_t most_terms = 12;
  double lag_s = 0.002;
  double cutoff_Hz = 100.0;
  double actuator_gain = 1.0;
  static constexpr auto fields() {
    using S = NarxStructure;
    return List{
        field("degree", &S::degree, between(1, 3), "Highest degree of a term."),
        field("differences", &S::differences, between(2, 6), "Number of differences of neighbouring lagged positions."),
        field("output_lags", &S::output_lags, between(0, 3),
              "Number of lagged outputs of the model itself; 0: no feedback."),
        field("most_terms", &S::most_terms, between(1, 12), "Largest number of terms that are chosen."),
        field("lag_s", &S::lag_s, units::second, positive, "Time between two lags; 1 to 64 samples."),
        field("cutoff_Hz", &S::cutoff_Hz, units::hertz, positive, "Low-pass on position and command."),
        field("actuator_gain", &S::actuator_gain, units::none, any_finite, "K_a: force in N per unit of the command.")};
  }
};

/// A term as the data ranks it.
struct RankedNarxTerm {
  control::NarxTerm term{};
  double error_reduction = 0.0;   ///< share of the command's squares, when it was chosen
  double standard_error_N = 0.0;  ///< of its coefficient, for white residuals
};

struct NarxFit {
  control::NarxForceEstimator::Params model{};
  std::vector<RankedNarxTerm> terms;  ///< best first
  std::size_t candidates = 0;
  std::size_t rows = 0;
  double command_rms_N = 0.0;    ///< low-passed force of the actuator
  double residual_rms_N = 0.0;   ///< one step ahead, with the measured output in the lags
  double simulated_rms_N = 0.0;  ///< what the estimator itself leaves of the command, run over the same motion
};

/// A polynomial NARX model of the actuator's force in free motion, its terms chosen by `rank_regressors` among all
/// products of up to `degree` variables, and its coefficients by `fit_linear`. One row every lag; scales are the RMS of
/// the variables, and the output's limit is four times the largest force in the motion.
///
/// `motion` must be free of contact. Errors: whatever the structure has out of bounds; `inconsistent`, with the remedy,
/// when the data are too poor: fewer than five rows for each candidate term, no force or no motion, no term that
/// explains the force, or a model that, run freely over its own data, leaves as much as no model would (it diverges, or
/// it only repeats the outputs before). Not real-time safe.
Result<NarxFit> fit_narx(std::span<const control::SlaveMotionSample> motion, const NarxStructure& structure,
                         Seconds dt);

}  // namespace tactus::identification
