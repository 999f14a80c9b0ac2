// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace tactus::identification {

/// Discrete Fourier transform of two real signals side by side, X(k) = Σ x(n)·exp(−2πi·k·n/N), one as each lane of the
/// machine's vectors.
///
/// Even and odd samples of a signal are real and imaginary part of one complex signal of half the length, which a
/// Stockham transform of radix 4 takes; the two signals never mix, so a small one alongside a large one keeps its
/// digits. Eigen's transform (kissfft) does the same, for any length, in about four times the time. Not real-time safe.
/// Source: Van Loan, Computational Frameworks for the Fast Fourier Transform, sections 1.7 and 4.3.
class RealPairTransform {
 public:
  /// One value of each signal.
  using Pair = std::array<double, 2>;
  struct alignas(2 * sizeof(double)) ComplexPair {
    Pair re;
    Pair im;
  };

  /// `length` N is a power of two, at least 4.
  explicit RealPairTransform(std::size_t length);

  [[nodiscard]] std::size_t length() const { return unit_circle_.size(); }

  /// Where the next samples go: N/2 elements, sample 2m in `re` and sample 2m + 1 in `im` of element m.
  [[nodiscard]] std::span<ComplexPair> samples() { return samples_; }

  /// The spectra of what is in `samples()`, whose content is lost: N/2 + 1 lines from 0 to half the sample rate, valid
  /// until the next call.
  std::span<const ComplexPair> spectra();

 private:
  std::vector<std::complex<double>> unit_circle_;  ///< exp(−2πi·k/N)
  std::vector<ComplexPair> samples_;
  std::vector<ComplexPair> scratch_;
  std::vector<ComplexPair> spectra_;
};

}  // namespace tactus::identification
