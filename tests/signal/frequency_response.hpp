// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <complex>
#include <numbers>

/// Measured response of a linear element, from nothing but its impulse response: H(f) = Σ h[n] exp(−2πi f n dt).
/// The impulse response must have died away after `ticks`.
template <class Filter>
std::complex<double> measured_response(Filter filter, double frequency_Hz, double dt_s, int ticks = 50000) {
  std::complex<double> sum = 0.0;
  filter.reset();
  for (int n = 0; n < ticks; ++n) {
    const double sample = filter.step(n == 0 ? 1.0 : 0.0);
    sum += sample * std::polar(1.0, -2.0 * std::numbers::pi * frequency_Hz * dt_s * n);
  }
  return sum;
}
