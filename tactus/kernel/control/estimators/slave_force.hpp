// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/disturbance_observer.hpp>
#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>
#include <tactus/kernel/control/estimators/kalman_force_estimator.hpp>
#include <tactus/kernel/control/estimators/momentum_observer.hpp>
#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/control/stages/stage.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <memory>
#include <variant>

/// Where the slave's tip force comes from: its sensor, or an estimate from its motor alone (paper B in any loop).
namespace tactus::control {

enum class SlaveForceSource { sensor, inverse_model, disturbance_observer, momentum_observer, kalman };

/// The words for a source in a file.
constexpr auto enumerators(SlaveForceSource) {
  return std::array{Enumerator{SlaveForceSource::sensor, "sensor"},
                    Enumerator{SlaveForceSource::inverse_model, "inverse-model"},
                    Enumerator{SlaveForceSource::disturbance_observer, "disturbance-observer"},
                    Enumerator{SlaveForceSource::momentum_observer, "momentum-observer"},
                    Enumerator{SlaveForceSource::kalman, "kalman"}};
}

/// The default slave (paper A, Table I) as one rigid body: the sums of its masses and of its Coulomb frictions. Its
/// cable, the hysteresis of its linkage and sticking stay unknown to every estimator.
inline constexpr SlaveModel rigid_slave{
    .mass_kg = 0.0075 + 0.01075 + 0.014,
    .friction = {.law = FrictionLaw::smooth_coulomb, .force_N = 0.01 + 0.0144, .velocity_scale_m_per_s = 0.003}};

/// The tip force of the slave by one of the sources, positive when the environment pushes the slave back: the opposite
/// of `ForceEstimate`. The sensor's reading passes unchanged. An estimate counts positions from the first sample, and
/// is good when the slave starts at rest and untouched.
class SlaveForce {
 public:
  struct Params {
    SlaveForceSource source = SlaveForceSource::sensor;
    InverseModelEstimator::Params inverse_model{.mass_kg = rigid_slave.mass_kg,
                                                .viscous_damping_N_s_per_m = 0.0,
                                                .friction = rigid_slave.friction,
                                                .force_filter_s = 0.001,
                                                .derivative_filter_s = 0.001,
                                                .prediction = {.blocks = 2, .block = {.time_constant_s = 0.0006}}};
    DisturbanceObserver::Params disturbance_observer{.model = rigid_slave};
    MomentumObserver::Params momentum_observer{.model = rigid_slave};
    KalmanForceEstimator::Params kalman{.model = rigid_slave, .force_walk_N = 20.0};
    static constexpr auto fields() {
      return List{
          field("source", &Params::source, "The force sensor at the tip, or an estimator that needs no such sensor."),
          field("inverse_model", &Params::inverse_model, "Source inverse-model (paper B)."),
          field("disturbance_observer", &Params::disturbance_observer, "Source disturbance-observer."),
          field("momentum_observer", &Params::momentum_observer, "Source momentum-observer."),
          field("kalman", &Params::kalman, "Source kalman.")};
    }
  };
  struct Input {
    double acted_N = 0.0;  ///< the motor force that acted until this sample, positive toward the environment
    double motor_position_m = 0.0;
    double tip_force_N = 0.0;  ///< of the sensor
  };
  using Output = double;

  static constexpr std::optional<Unfit> not_linear(const Params& params) {
    if (params.source == SlaveForceSource::sensor) return {};
    return Unfit{"source",
                 "linear analysis has no model of the estimators, whose friction is not linear: choose sensor"};
  }
  static constexpr std::optional<Unfit> not_on_lanes(const Params& params) {
    if (params.source == SlaveForceSource::sensor) return {};
    return Unfit{"source", "write sensor"};
  }

  /// Errors: a value out of bounds in any group; what the chosen estimator's `make` refuses, under its group.
  static Result<SlaveForce> make(const Params& params, Seconds dt);

  /// Tip force in N, once a tick. Real-time safe.
  double step(const Input& input) noexcept;
  void reset() noexcept;

 private:
  struct Sensor {};
  using Source =
      std::variant<Sensor, InverseModelEstimator, DisturbanceObserver, MomentumObserver, KalmanForceEstimator>;

  explicit SlaveForce(const Source& source) : source_(source) {}

  Source source_;
  double start_m_ = 0.0;
  bool started_ = false;
};

/// Any slave's controller with `force` in place of the sensor's reading. The estimator gets the force that the safety
/// gate let through at the tick before: the one that acted until the sample.
class EstimatingSlave final : public SlaveController {
 public:
  EstimatingSlave(const SlaveForce& force, std::unique_ptr<SlaveController> controller)
      : force_(force), controller_(std::move(controller)) {}

  SlaveOutput respond(const SlaveInput& input) noexcept override {
    SlaveInput estimated = input;
    estimated.tip_force_N = force_.step(
        {.acted_N = acted_N_, .motor_position_m = input.motor_position_m, .tip_force_N = input.tip_force_N});
    return controller_->respond(estimated);
  }
  void applied(double motor_force_N) noexcept override {
    acted_N_ = motor_force_N;
    controller_->applied(motor_force_N);
  }
  void reset() noexcept override {
    force_.reset();
    controller_->reset();
    acted_N_ = 0.0;
  }
  [[nodiscard]] std::unique_ptr<SlaveController> clone() const override {
    auto copy = std::make_unique<EstimatingSlave>(force_, controller_->clone());
    copy->acted_N_ = acted_N_;
    return copy;
  }

 private:
  SlaveForce force_;
  std::unique_ptr<SlaveController> controller_;
  double acted_N_ = 0.0;
};

}  // namespace tactus::control
