// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/predictor.hpp>

namespace tactus::signal {

Result<Predictor> Predictor::make(const Params& params, Seconds dt) {
  if (Check error = check(params, dt)) return *std::move(error);
  switch (params.kind) {
    case PredictionKind::polynomial: {
      const auto polynomial = PolynomialPredictor::make(params.polynomial, dt);
      if (!polynomial) return under("polynomial", polynomial.error());
      return Predictor(*polynomial);
    }
    case PredictionKind::kalman: {
      const auto kalman = KalmanPredictor::make(params.kalman, dt);
      if (!kalman) return under("kalman", kalman.error());
      return Predictor(*kalman);
    }
    case PredictionKind::blocks:
      break;
  }
  // The bounds of blocks and block are checked above.
  return Predictor(PredictionCascade::make({.blocks = params.blocks, .block = params.block}, dt).value());
}

double Predictor::step(double input) noexcept {
  return std::visit([input](auto& predictor) { return predictor.step(input); }, chosen_);
}

void Predictor::reset() noexcept {
  std::visit([](auto& predictor) { predictor.reset(); }, chosen_);
}

}  // namespace tactus::signal
