// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <span>
#include <vector>

/// Models from measured data: frequency responses, fits and what the data cannot determine.
namespace tactus::identification {

/// What a linear fit found.
struct LinearFit {
  std::vector<double> parameters = {};
  /// One for each parameter, in its unit: square root of the diagonal of s²·(AᵀA)⁻¹, s² the residual's variance with
  /// as many degrees of freedom as there are observations less parameters. Holds for white, independent residuals.
  std::vector<double> standard_errors = {};
  /// Root mean square of what the fit leaves, in the unit of the observations.
  double residual_rms = 0;
};

/// Least squares: the parameters p that minimise |A·p − b|, by column-pivoting Householder QR of A with its columns
/// scaled to unit length.
///
/// `regressors` is A row by row, `columns` values for each of the observations b.
///
/// Errors: `inconsistent` when the sizes do not fit one another, when there are not more observations than parameters,
/// or when the columns are linearly dependent (to 1e-10 of their length), so that the data cannot determine the
/// parameters apart; the message names the column, from 0, that adds nothing. `out_of_bounds` for a value that is not
/// finite. Not real-time safe.
Result<LinearFit> fit_linear(std::span<const double> regressors, std::size_t columns,
                             std::span<const double> observations);

}  // namespace tactus::identification
