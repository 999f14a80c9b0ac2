#include <tactus/signal/predictor.hpp>

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
  if (auto* cascade = std::get_if<PredictionCascade>(&chosen_)) return cascade->step(input);
  if (auto* polynomial = std::get_if<PolynomialPredictor>(&chosen_)) return polynomial->step(input);
  return std::get_if<KalmanPredictor>(&chosen_)->step(input);
}

void Predictor::reset() noexcept {
  if (auto* cascade = std::get_if<PredictionCascade>(&chosen_)) cascade->reset();
  if (auto* polynomial = std::get_if<PolynomialPredictor>(&chosen_)) polynomial->reset();
  if (auto* kalman = std::get_if<KalmanPredictor>(&chosen_)) kalman->reset();
}

}  // namespace tactus::signal
