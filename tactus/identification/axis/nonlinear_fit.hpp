// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace tactus::identification {

/// What is fitted to what, all of it in variables of about unit scale (a logarithm for what is greater than 0).
struct NonlinearProblem {
  /// Where the search starts: the variables to be found, then those that are given and only known to within
  /// `given_covariance`.
  std::vector<double> start;
  std::size_t given = 0;
  std::vector<double> given_covariance;  ///< `given` rows of as many
  /// What is known before of the first variables to be found: a fit is drawn there. Empty, or 0 where nothing is. The
  /// residuals must then be in units of their own standard deviation.
  std::vector<double> prior_middle, prior_deviation;
  /// Residuals for a vector like `start`, always as many, in an order in which neighbours belong together.
  std::function<std::vector<double>(std::span<const double>)> residuals;
};

struct NonlinearFit {
  std::vector<double> found;  ///< the variables to be found
  /// Of all variables, those to be found first, row by row.
  std::vector<double> covariance;
  /// Standard deviation of what was found that comes from the residuals alone, the given taken as true.
  std::vector<double> own_deviation;
  double residual_rms = 0.0;
  int evaluations = 0;
};

/// Least squares by Levenberg and Marquardt (Eigen's port of MINPACK), Jacobian by forward differences.
///
/// The covariance has two parts. Residuals of a simulation are not white, so their part is that of a regression with
/// clusters: (JᵀJ)⁻¹ Σ_b (J_bᵀ r_b)(J_bᵀ r_b)ᵀ (JᵀJ)⁻¹ over twenty blocks b of neighbouring residuals, times n_b/(n_b −
/// p). To it comes what the given variables do not know: S C Sᵀ with S = −(JᵀJ)⁻¹ Jᵀ J_given. With a prior of precision
/// P the fit minimises ‖r‖² + (x − m)ᵀ P (x − m); JᵀJ + P stands for JᵀJ, and P is added to the clusters' sum, so that
/// a variable of which the data determine nothing stays as uncertain as it was.
///
/// Errors: `inconsistent` for residuals that are not finite at the start, or that do not determine the variables apart,
/// with the index of one that cannot be determined as the parameter. Not real-time safe. Sources: J. Moré, The
/// Levenberg–Marquardt algorithm, 1978; K.-Y. Liang and S. Zeger, Longitudinal data analysis using generalized linear
/// models, 1986.
Result<NonlinearFit> fit_nonlinear(const NonlinearProblem& problem);

}  // namespace tactus::identification
