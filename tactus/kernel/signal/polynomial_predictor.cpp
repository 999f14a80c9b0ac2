// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/polynomial_predictor.hpp>

#include <cmath>
#include <numbers>
#include <string>

namespace tactus::signal {

Result<PolynomialPredictor> PolynomialPredictor::make(const Params& params, Seconds dt) {
  if (Check error = check(params, dt)) return *std::move(error);
  if (params.samples <= params.degree) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "samples",
                 .message = std::to_string(params.samples) + " samples do not determine a polynomial of degree " +
                            std::to_string(params.degree) + ": write " + std::to_string(params.degree + 1) +
                            " or more, or a lower degree",
                 .place = {}};
  }
  PolynomialPredictor predictor;
  predictor.sample_time_s_ = dt.value;
  predictor.count_ = static_cast<std::size_t>(params.samples);
  const std::size_t count = predictor.count_;
  // Stieltjes' recurrence p_{j+1} = t·p_j − b_j·p_{j−1} on instants that are symmetric about 0 and spaced by 1.
  const double newest = 0.5 * static_cast<double>(count - 1);
  const double ahead = newest + params.horizon_s / dt.value;
  Taps polynomial{}, before{};
  double polynomial_ahead = 1.0, before_ahead = 0.0, square_before = 1.0;
  for (std::size_t k = 0; k < count; ++k) polynomial[k] = 1.0;
  for (std::int64_t j = 0;; ++j) {
    double square = 0.0;
    for (std::size_t k = 0; k < count; ++k) square += polynomial[k] * polynomial[k];
    for (std::size_t k = 0; k < count; ++k) predictor.taps_[k] += polynomial_ahead * polynomial[k] / square;
    if (j == params.degree) return predictor;
    const double b = j == 0 ? 0.0 : square / square_before;
    for (std::size_t k = 0; k < count; ++k) {
      const double next = (newest - static_cast<double>(k)) * polynomial[k] - b * before[k];
      before[k] = polynomial[k];
      polynomial[k] = next;
    }
    const double next_ahead = ahead * polynomial_ahead - b * before_ahead;
    before_ahead = polynomial_ahead;
    polynomial_ahead = next_ahead;
    square_before = square;
  }
}

double PolynomialPredictor::step(double input) noexcept {
  newest_ = newest_ + 1 < count_ ? newest_ + 1 : 0;
  past_[newest_] = input;
  double sum = 0.0;
  for (std::size_t k = 0; k <= newest_; ++k) sum += taps_[k] * past_[newest_ - k];
  for (std::size_t k = newest_ + 1; k < count_; ++k) sum += taps_[k] * past_[newest_ + count_ - k];
  return sum;
}

std::complex<double> PolynomialPredictor::response(double frequency_Hz) const noexcept {
  std::complex<double> sum = 0.0;
  const double angle = 2.0 * std::numbers::pi * frequency_Hz * sample_time_s_;
  for (std::size_t k = 0; k < count_; ++k) sum += taps_[k] * std::polar(1.0, -angle * static_cast<double>(k));
  return sum;
}

double PolynomialPredictor::white_noise_gain() const noexcept {
  double sum = 0.0;
  for (const double tap : taps_) sum += tap * tap;
  return std::sqrt(sum);
}

}  // namespace tactus::signal
