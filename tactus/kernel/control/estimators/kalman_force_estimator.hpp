// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/force_estimator.hpp>
#include <tactus/kernel/control/estimators/slave_model.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>

namespace tactus::control {

/// Kalman filter with the environment's force as a state that walks at random, at its steady gain.
///
/// State position, velocity, force; x⁺ = A x + B (K_a u − friction(v̂)) exactly over a tick for held forces, with the
/// process noise of a force that walks with density q² per second and of model error as white force noise of density
/// w²,
///
///     Q = ∫₀^dt e^{Fτ} diag(0, w²/M², q²) e^{Fᵀτ} dτ,   R = r²,
///
/// K = P Cᵀ/(C P Cᵀ + R) from the P that solves the discrete Riccati equation (`signal::steady_kalman`). The output is
/// the estimate that includes this sample. r of an encoder is its step over √12. The larger q, the faster and the
/// noisier. Starts at rest, with no force, wherever the first sample is. Source: R. E. Kalman, A new approach to
/// linear filtering and prediction problems, J. Basic Engineering 82, 1960.
class KalmanForceEstimator {
 public:
  struct Params {
    SlaveModel model{};
    double force_walk_N = 10.0;
    double model_noise_N = 1e-3;
    double position_noise_m = 3e-6;
    static constexpr auto fields() {
      return List{field("model", &Params::model, "The nominal slave."),
                  field("force_walk_N", &Params::force_walk_N, units::newton, positive,
                        "q: standard deviation of the change of the force within one second."),
                  field("model_noise_N", &Params::model_noise_N, units::newton, positive,
                        "w: error of the model, treated as white noise of the force. The value is the standard "
                        "deviation of the mean of this noise over one second."),
                  field("position_noise_m", &Params::position_noise_m, units::metre, positive,
                        "r: standard deviation of the noise of the measured position.")};
    }
  };
  using Input = SlaveMotionSample;
  using Output = ForceEstimate;
  using Gain = std::array<double, 3>;  ///< of position, velocity [1/s] and force [N/m]

  /// Errors: a value out of bounds; `inconsistent` when no gain can be found in double precision, for noises that lie
  /// too far apart.
  static Result<KalmanForceEstimator> make(const Params& params, Seconds dt);

  /// Once a tick. Real-time safe.
  Output step(const Input& sample) noexcept;
  void reset() noexcept {
    state_ = {};
    started_ = false;
  }
  [[nodiscard]] const Gain& gain() const noexcept { return gain_; }

 private:
  using State = std::array<double, 3>;

  KalmanForceEstimator() = default;

  FrictionFunction friction_;
  double actuator_gain_ = 1.0;
  std::array<State, 3> transition_{};  ///< rows of A
  State input_{};                      ///< B
  Gain gain_{};
  State state_{};  ///< predicted for the next sample
  bool started_ = false;
};

}  // namespace tactus::control
