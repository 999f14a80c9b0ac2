// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/units.hpp>

#include <array>
#include <cstddef>

namespace tactus::signal {

/// A square matrix, row by row.
template <std::size_t Order>
using SquareMatrix = std::array<std::array<double, Order>, Order>;

/// A Kalman filter whose gain has come to rest.
template <std::size_t Order>
struct SteadyKalman {
  SquareMatrix<Order> transition{};  ///< A = e^{F·dt}
  std::array<double, Order> gain{};  ///< K = P Cᵀ/(C P Cᵀ + R), for the estimate that includes the newest sample
  bool stable = false;               ///< false when no gain with a stable error was found in double precision
};

/// The steady filter of ẋ = F x + w with white w of the given densities, independent of one another, and x_0 measured
/// every tick with the given variance:
///
///     Q = ∫₀^dt e^{Fτ} diag(density) e^{Fᵀτ} dτ   (Van Loan),    P from the discrete Riccati equation by doubling.
///
/// Not real-time safe. Orders 2 and 3. Sources: C. F. Van Loan, Computing integrals involving the matrix exponential,
/// IEEE Trans. Automatic Control 23(3), 1978; B. D. O. Anderson, Second-order convergent algorithms for the
/// steady-state Riccati equation, Int. J. Control 28(2), 1978.
template <std::size_t Order>
SteadyKalman<Order> steady_kalman(const SquareMatrix<Order>& drift, const std::array<double, Order>& noise_density,
                                  double measurement_variance, Seconds dt);

extern template SteadyKalman<2> steady_kalman(const SquareMatrix<2>&, const std::array<double, 2>&, double, Seconds);
extern template SteadyKalman<3> steady_kalman(const SquareMatrix<3>&, const std::array<double, 3>&, double, Seconds);

}  // namespace tactus::signal
