// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace tactus::identification {

/// A regressor that forward regression chose.
struct RankedRegressor {
  std::size_t column = 0;
  double error_reduction = 0.0;  ///< ERR = g²·wᵀw / yᵀy: the share of the observations' squares that it explains
};

/// Forward regression by orthogonal least squares: which columns of A to keep of A·p ≈ y, the best first.
///
/// Each round takes the column whose part w orthogonal to those chosen has the largest error reduction ratio. It stops
/// before the column that does not lower Schwarz's criterion n·ln(RSS/n) + m·ln(n), after `most` columns, or when
/// nothing is left to explain. A column of which less than 1e-8 of its length is new is never taken.
///
/// `regressors` is A row by row. Errors: `inconsistent` when the sizes do not fit one another, and when all
/// observations are 0; `out_of_bounds` for a value that is not finite. An empty result states that no column explains
/// anything. Not real-time safe.
/// Sources: S. Chen, S. A. Billings, W. Luo, Int. J. Control 50(5), 1989, with modified Gram-Schmidt (section 3.2);
/// G. Schwarz, Estimating the dimension of a model, Annals of Statistics 6(2), 1978.
Result<std::vector<RankedRegressor>> rank_regressors(std::span<const double> regressors, std::size_t columns,
                                                     std::span<const double> observations, std::size_t most);

}  // namespace tactus::identification
