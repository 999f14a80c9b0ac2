// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/force_estimator.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/predictor.hpp>
#include <tactus/kernel/signal/rational_filter.hpp>

#include <array>
#include <complex>

namespace tactus::control {

/// How friction depends on velocity, alongside the viscous part of the linear model.
enum class FrictionLaw { none, sigmoid, smooth_coulomb, dead_band_coulomb };

/// The words for a friction law in a file.
constexpr auto enumerators(FrictionLaw) {
  return std::array{Enumerator<FrictionLaw>{FrictionLaw::none, "none"},
                    Enumerator<FrictionLaw>{FrictionLaw::sigmoid, "sigmoid"},
                    Enumerator<FrictionLaw>{FrictionLaw::smooth_coulomb, "smooth-coulomb"},
                    Enumerator<FrictionLaw>{FrictionLaw::dead_band_coulomb, "dead-band-coulomb"}};
}

/// Friction as a function of velocity v without memory, r = v / `velocity_scale_m_per_s`:
///
///     sigmoid            force·(1/(1 + exp(−r)) − 1/2 + linear·r + quadratic·|r|·r)   (paper B, eq. 7)
///     smooth-coulomb     force·tanh(r)
///     dead-band-coulomb  force·sign(v) where |r| ≥ 1, else 0
///
/// and `offset_N` with each but none. The quadratic term of eq. 7 only matters for |r| near 100, so the paper's v is
/// most likely in mm/s: a scale of 1 mm/s.
struct FrictionFunction {
  FrictionLaw law = FrictionLaw::none;
  double force_N = 0.0;
  double offset_N = 0.0;
  double velocity_scale_m_per_s = 1e-3;
  double linear = 0.1;
  double quadratic = 0.00045;
  static constexpr auto fields() {
    return List{field("law", &FrictionFunction::law,
                      "Friction law, with r as in velocity_scale_m_per_s. sigmoid: force_N (1 / (1 + exp(-r)) - 1/2 + "
                      "linear r + quadratic abs(r) r). smooth-coulomb: force_N tanh(r). dead-band-coulomb: force_N "
                      "sign(r) if abs(r) is at least 1, otherwise 0. Each law except none adds offset_N."),
                field("force_N", &FrictionFunction::force_N, units::newton, non_negative,
                      "Coulomb friction; with the sigmoid its factor (h_e in the paper)."),
                field("offset_N", &FrictionFunction::offset_N, units::newton, any_finite,
                      "Constant force, independent of the motion."),
                field("velocity_scale_m_per_s", &FrictionFunction::velocity_scale_m_per_s, units::metre_per_second,
                      positive, "Velocity scale of the law: its argument is r = velocity / velocity_scale_m_per_s."),
                field("linear", &FrictionFunction::linear, units::none, non_negative,
                      "Only with the sigmoid: coefficient of its linear term."),
                field("quadratic", &FrictionFunction::quadratic, units::none, non_negative,
                      "Only with the sigmoid: coefficient of its quadratic term.")};
  }
  /// The force in N that moving at `velocity_m_per_s` takes. Real-time safe.
  [[nodiscard]] double operator()(double velocity_m_per_s) const noexcept;
};

/// Which keys state the linear model.
enum class LinearModelForm { mass_damping, rational };

/// The words for a form in a file.
constexpr auto enumerators(LinearModelForm) {
  return std::array{Enumerator<LinearModelForm>{LinearModelForm::mass_damping, "mass-damping"},
                    Enumerator<LinearModelForm>{LinearModelForm::rational, "rational"}};
}

/// Environment force from command and position through the inverse of the slave's model (paper B, eqs. 2 to 4):
///
///     F_e = [ friction(v) + (M·s + h)·s / K_s · B(s) · x_s / (T_d·s + 1) − K_a·u ] / (T_f·s + 1)
///     B(s) = ((2·Tp·s + 1)/(Tp·s + 1))^n
///
/// `rational` takes x/F = N(s)/D(s) instead of 1/((M·s + h)·s). v is the predicted
/// position behind s/(T_d·s + 1). The blocks predict the measured position, so also the instant at which friction
/// changes sign. `prediction.kind` puts a polynomial or a Kalman predictor in their place. All of it is sampled by the
/// bilinear transform, which moves no zero of the model across the axis.
///
/// `make` refuses what no choice of the other keys can repair: an unstable or undamped inverse (zeros of the plant not
/// left of the imaginary axis), an inverse that is improper behind its filters, a time constant below half a sample,
/// and a declared delay of which prediction leaves more than half.
/// One tick: about 10 multiplications for each block and filter; no allocation.
class InverseModelEstimator {
 public:
  struct Params {
    LinearModelForm form = LinearModelForm::mass_damping;
    double mass_kg = 10.0;
    double viscous_damping_N_s_per_m = 1.0;
    signal::RationalFunction plant{.denominator_0 = 0.0, .denominator_1 = 1.0, .denominator_2 = 10.0};
    FrictionFunction friction;
    double actuator_gain = 1.0;
    double sensor_gain = 1.0;
    double force_filter_s = 0.0005;
    double derivative_filter_s = 0.0005;
    double declared_delay_s = 0.0;
    signal::Predictor::Params prediction;
    static constexpr auto fields() {
      return List{
          field("form", &Params::form,
                "Form of the linear model. mass-damping uses the keys marked (mass-damping); rational uses the "
                "transfer function in the section plant."),
          field("mass_kg", &Params::mass_kg, units::kilogram, non_negative, "Moving mass M (mass-damping)."),
          field("viscous_damping_N_s_per_m", &Params::viscous_damping_N_s_per_m, units::newton_second_per_metre,
                non_negative, "Viscous damping h (mass-damping)."),
          field("plant", &Params::plant, "Transfer function from actuator force to position, N(s)/D(s) (rational)."),
          field("friction", &Params::friction, "Friction in addition to the linear model."),
          field("actuator_gain", &Params::actuator_gain, units::none, any_finite,
                "K_a: force in N per unit of the command; not 0."),
          field("sensor_gain", &Params::sensor_gain, units::none, any_finite,
                "K_s: measured position per metre of true position; not 0."),
          field("force_filter_s", &Params::force_filter_s, units::second, non_negative,
                "T_f: time constant of the low-pass on command and force; 0: no filter."),
          field("derivative_filter_s", &Params::derivative_filter_s, units::second, non_negative,
                "T_d: time constant of the low-pass on velocity; 0: no filter."),
          field("declared_delay_s", &Params::declared_delay_s, units::second, non_negative,
                "Sum of the delays and lags of actuator and sensor that prediction is to compensate; 0: none."),
          field("prediction", &Params::prediction,
                "Prediction of the measured position, by blocks or by an alternative method.")};
    }
  };
  using Input = SlaveMotionSample;
  using Output = ForceEstimate;

  static Result<InverseModelEstimator> make(const Params& params, Seconds dt);

  /// Once a tick. Real-time safe.
  Output step(const Input& sample) noexcept;
  void reset() noexcept;

 private:
  InverseModelEstimator(const FrictionFunction& friction, double actuator_gain, double position_gain,
                        const signal::Predictor& prediction, const signal::RationalFilter& inverse,
                        const signal::RationalFilter& velocity, const signal::RationalFilter& low_pass)
      : friction_(friction),
        actuator_gain_(actuator_gain),
        position_gain_(position_gain),
        prediction_(prediction),
        inverse_(inverse),
        velocity_(velocity),
        friction_filter_(low_pass),
        command_filter_(low_pass) {}

  FrictionFunction friction_;
  double actuator_gain_;
  double position_gain_;
  signal::Predictor prediction_;
  signal::RationalFilter inverse_;
  signal::RationalFilter velocity_;
  signal::RationalFilter friction_filter_;
  signal::RationalFilter command_filter_;
};

/// The inverse model as eq. 4 has it, from measured position to force in N, friction and prediction left out; `s` in
/// 1/s. Without the filter T_f, which command and model share.
std::complex<double> inverse_response(const InverseModelEstimator::Params& params, std::complex<double> s);

}  // namespace tactus::control
