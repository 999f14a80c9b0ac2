// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>
#include <tactus/kernel/signal/rational_filter.hpp>

#include <span>

namespace tactus::identification {

/// A fourth-order transfer function with a numerator of equal degree, fitted to data.
struct RationalFit {
  signal::RationalFunction function;
  double residual_rms = 0.0;  ///< of the simulated output, in its unit
  int round = 0;              ///< in which it was found, from 1
  bool moved_poles = false;   ///< that round wanted poles right of the axis, and they were mirrored
};

/// Fits output = B(s)/A(s)·input, both of the fourth order, all nine coefficients free: the output error by repeated
/// linear least squares, each behind 1/A of the round before (Steiglitz and McBride 1965, in continuous time with
/// the filters of Young's SRIVC; Sanathanan and Koerner's idea with samples in place of frequencies). It starts from
/// A = (s + 2π·`start_frequency_Hz`)⁴ and keeps the round whose simulated output errs least. Poles that a round wants
/// right of the imaginary axis are mirrored to its left, and the numerator is fitted again to the denominator of each
/// round: an inverse of a delayed plant always wants such poles, for exp(s·T) has them in every approximation of equal
/// degrees.
///
/// Errors: `inconsistent` for data of unequal or too short length, or data that cannot determine the coefficients
/// apart; `failed` when no round gives a model. Not real-time safe.
Result<RationalFit> fit_rational(std::span<const double> input, std::span<const double> output, Seconds dt,
                                 double start_frequency_Hz, int rounds = 25);

}  // namespace tactus::identification
