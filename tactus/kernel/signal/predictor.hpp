// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/kalman_predictor.hpp>
#include <tactus/kernel/signal/polynomial_predictor.hpp>
#include <tactus/kernel/signal/prediction_block.hpp>

#include <array>
#include <cstdint>
#include <variant>

namespace tactus::signal {

/// How a signal is predicted.
enum class PredictionKind { blocks, polynomial, kalman };

/// The words for a kind of prediction in a file.
constexpr auto enumerators(PredictionKind) {
  return std::array{Enumerator<PredictionKind>{PredictionKind::blocks, "blocks"},
                    Enumerator<PredictionKind>{PredictionKind::polynomial, "polynomial"},
                    Enumerator<PredictionKind>{PredictionKind::kalman, "kalman"}};
}

/// One of the predictors, as a file chooses it: `PredictionCascade`, `PolynomialPredictor` or `KalmanPredictor`.
class Predictor {
 public:
  struct Params {
    PredictionKind kind = PredictionKind::blocks;
    std::int64_t blocks = 2;
    PredictionBlock::Params block{};
    PolynomialPredictor::Params polynomial{};
    KalmanPredictor::Params kalman{};
    static constexpr auto fields() {
      return List{field("kind", &Params::kind, "Method of prediction: blocks, polynomial or kalman."),
                  field("blocks", &Params::blocks, between(0, 4),
                        "Only with the kind blocks: number of blocks in series; 0: no prediction."),
                  field("block", &Params::block, "Parameters of each block."),
                  field("polynomial", &Params::polynomial, "Extrapolation of a least-squares polynomial."),
                  field("kalman", &Params::kalman, "Kalman filter of the signal's kinematics.")};
    }
    /// Predicts nothing.
    static Params none() { return {.blocks = 0}; }
    /// How far the chosen one looks ahead at low frequency; a mean (degree 0) does not.
    [[nodiscard]] double lead_s() const noexcept {
      if (kind == PredictionKind::polynomial) return polynomial.degree > 0 ? polynomial.horizon_s : 0.0;
      if (kind == PredictionKind::kalman) return kalman.horizon_s;
      return static_cast<double>(blocks) * block.time_constant_s;
    }
  };
  using Input = double;
  using Output = double;

  /// Errors: those of the chosen one, under its key.
  static Result<Predictor> make(const Params& params, Seconds dt);

  /// The predicted sample. Real-time safe.
  double step(double input) noexcept;
  void reset() noexcept;

 private:
  using Chosen = std::variant<PredictionCascade, PolynomialPredictor, KalmanPredictor>;
  explicit Predictor(const Chosen& chosen) : chosen_(chosen) {}
  Chosen chosen_;
};

}  // namespace tactus::signal
