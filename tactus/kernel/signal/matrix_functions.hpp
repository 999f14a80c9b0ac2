// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

/// What a model needs of square matrices, given row by row, when it is made. Compiled once, because the templates
/// behind them take the compiler long. Cold: all of these allocate. Every number must be finite.
namespace tactus::signal {

/// Puts exp(A) in place of the matrix A of `size` rows. By scaling and squaring with Padé approximants (Higham 2005).
void exponentiate(std::span<double> matrix, std::size_t size);

/// The eigenvalues of a matrix of `size` rows, by the QR algorithm.
std::vector<std::complex<double>> eigenvalues(std::span<const double> matrix, std::size_t size);

}  // namespace tactus::signal
