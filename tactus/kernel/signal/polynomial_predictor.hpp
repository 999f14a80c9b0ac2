// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>

namespace tactus::signal {

/// Prediction by extrapolation: the least-squares polynomial through the last samples, read `horizon_s` after the
/// newest one.
///
/// A fixed FIR filter, y = Σ h_k·u_{n−k}, h_k = Σ_j p_j(t_h)·p_j(t_k)/‖p_j‖² with the polynomials p_j orthogonal on the
/// sample instants t_k (Gram). Exact on polynomials up to `degree`; a sine lags or leads it and grows as the frequency
/// does. Degree 0 is the moving average, which looks at no horizon. White noise grows by √(Σ h_k²).
/// Starts at rest at zero, as if all samples before had been 0. One tick: `samples` multiplications.
/// Source: A. Savitzky, M. J. E. Golay, Smoothing and differentiation of data by simplified least squares procedures,
/// Analytical Chemistry 36(8), 1964, at a point outside the window.
class PolynomialPredictor {
 public:
  static constexpr std::size_t most_samples = 128;
  struct Params {
    std::int64_t samples = 56;
    std::int64_t degree = 2;
    double horizon_s = 0.0036;
    static constexpr auto fields() {
      return List{field("samples", &Params::samples, between(1, 128),
                        "Number of newest samples in the fit; it must exceed the degree."),
                  field("degree", &Params::degree, between(0, 3), "Degree of the polynomial; 0 is the mean."),
                  field("horizon_s", &Params::horizon_s, units::second, between(0.0, 10.0),
                        "Time after the newest sample at which the polynomial is evaluated.")};
    }
  };
  using Input = double;
  using Output = double;
  using Taps = std::array<double, most_samples>;

  /// Errors: a value out of bounds; `inconsistent` for no more samples than the degree.
  static Result<PolynomialPredictor> make(const Params& params, Seconds dt);

  /// The predicted sample. Real-time safe.
  double step(double input) noexcept;
  /// Back to rest at zero.
  void reset() noexcept {
    past_.fill(0.0);
    newest_ = 0;
  }

  /// h_k, the newest sample's first; zeros behind the last sample of the fit.
  [[nodiscard]] const Taps& taps() const noexcept { return taps_; }
  /// H at `frequency_Hz`, from 0 to half the sample rate.
  [[nodiscard]] std::complex<double> response(double frequency_Hz) const noexcept;
  /// RMS out over RMS in for white noise.
  [[nodiscard]] double white_noise_gain() const noexcept;

 private:
  PolynomialPredictor() = default;
  double sample_time_s_ = 0.0;
  std::size_t count_ = 0;
  std::size_t newest_ = 0;  ///< where in `past_`; older samples lie before it, around the end
  Taps taps_{};
  Taps past_{};
};

}  // namespace tactus::signal
