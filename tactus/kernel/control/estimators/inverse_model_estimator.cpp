// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace tactus::control {

namespace {

using signal::RationalFilter;
using signal::RationalFunction;
using Coefficients = RationalFunction::Coefficients;

/// The plant as position over actuator force.
RationalFunction plant_of(const InverseModelEstimator::Params& params) {
  if (params.form == LinearModelForm::rational) return params.plant;
  return {.numerator_0 = 1.0,
          .denominator_0 = 0.0,
          .denominator_1 = params.viscous_damping_N_s_per_m,
          .denominator_2 = params.mass_kg};
}

/// `ascending` times (time_constant·s + 1); the caller has made sure that the product fits.
Coefficients with_lag(const Coefficients& ascending, double time_constant_s) {
  Coefficients product = ascending;
  for (std::size_t i = 1; i < product.size(); ++i) product[i] += time_constant_s * ascending[i - 1];
  return product;
}

Error inconsistent(std::string parameter, std::string message) {
  return {
      .code = ErrorCode::inconsistent, .parameter = std::move(parameter), .message = std::move(message), .place = {}};
}

Check check_gain(const char* name, double gain) {
  if (gain != 0.0) return {};
  return Error{.code = ErrorCode::out_of_bounds,
               .parameter = name,
               .message = "is 0, so the model cannot be inverted: write the gain of the transducer",
               .place = {}};
}

/// Why the inverse of this model must not run, if so.
Check check_inverse(const InverseModelEstimator::Params& params) {
  const bool rational = params.form == LinearModelForm::rational;
  const RationalFunction plant = plant_of(params);
  const auto zeros = plant.numerator();
  const auto poles = plant.denominator();
  const std::string numerator = rational ? "plant.numerator_" + std::to_string(signal::degree(zeros)) : "mass_kg";
  if (poles == Coefficients{}) {
    return inconsistent(rational ? "plant.denominator_0" : "mass_kg",
                        "the plant has neither mass nor damping: state at least one of them");
  }
  if (!signal::is_hurwitz(zeros)) {
    return inconsistent(numerator,
                        "the plant has a zero that is not left of the imaginary axis (Routh), or no numerator at all. "
                        "Its inverse has a pole there and would run away from any rounding error: leave the zero out "
                        "of the model and let prediction make up for its phase");
  }
  const int lags = (params.force_filter_s > 0.0 ? 1 : 0) + (params.derivative_filter_s > 0.0 ? 1 : 0);
  const auto order = signal::degree(zeros) + static_cast<std::size_t>(lags);
  if (signal::degree(poles) > order) {
    return inconsistent(params.force_filter_s > 0.0 ? "derivative_filter_s" : "force_filter_s",
                        "the inverse differentiates " + std::to_string(signal::degree(poles) - signal::degree(zeros)) +
                            " times and has " + std::to_string(lags) +
                            " low-pass filters: improper, noise would be amplified without bound; give each of "
                            "force_filter_s and derivative_filter_s a time constant, or a plant of lower degree");
  }
  if (order + 1 > zeros.size()) {
    return inconsistent(numerator, "numerator and filters together are of order " + std::to_string(order) +
                                       ", at most 4 can be inverted: write a plant with fewer zeros");
  }
  return {};
}

/// Why prediction does not fit the declared delay, if so.
Check check_prediction(const InverseModelEstimator::Params& params, Seconds dt) {
  const signal::Predictor::Params& prediction = params.prediction;
  const bool by_blocks = prediction.kind == signal::PredictionKind::blocks;
  const double time_constant_s = prediction.block.time_constant_s;
  if (by_blocks && prediction.blocks > 0 && time_constant_s < 0.5 * dt.value) {
    return inconsistent("prediction.block.time_constant_s",
                        "is " + rounded_number(time_constant_s) + " s, less than half a sample (" +
                            rounded_number(0.5 * dt.value) + " s): predict further or set prediction.blocks to 0");
  }
  const double wanted_s = params.declared_delay_s + params.derivative_filter_s;
  if (params.declared_delay_s > 0.0 && std::abs(wanted_s - prediction.lead_s()) > 0.5 * wanted_s) {
    std::string remedy = "set prediction.blocks to 1 or more";
    if (!by_blocks) {
      remedy =
          "set prediction." + std::string(name_of(prediction.kind)) + ".horizon_s near " + rounded_number(wanted_s);
    } else if (prediction.blocks > 0) {
      remedy = "set prediction.block.time_constant_s near " +
               rounded_number(wanted_s / static_cast<double>(prediction.blocks));
    }
    return inconsistent("declared_delay_s", "is " + rounded_number(params.declared_delay_s) +
                                                " s, and prediction looks ahead " +
                                                rounded_number(prediction.lead_s()) +
                                                " s: more than half of the delay is left, and free motion would feel "
                                                "like a force; " +
                                                remedy + ", or declare no delay");
  }
  return {};
}

RationalFilter::Params lag(double time_constant_s) { return {.denominator_0 = 1.0, .denominator_1 = time_constant_s}; }

}  // namespace

double FrictionFunction::operator()(double velocity_m_per_s) const noexcept {
  const double r = velocity_m_per_s / velocity_scale_m_per_s;
  switch (law) {
    case FrictionLaw::none:
      return 0.0;
    case FrictionLaw::sigmoid:
      // 1/(1 + exp(−r)) − 1/2 is tanh(r/2)/2, which does not overflow.
      return force_N * (0.5 * std::tanh(0.5 * r) + linear * r + quadratic * std::abs(r) * r) + offset_N;
    case FrictionLaw::smooth_coulomb:
      return force_N * std::tanh(r) + offset_N;
    case FrictionLaw::dead_band_coulomb:
      return (std::abs(r) < 1.0 ? 0.0 : std::copysign(force_N, r)) + offset_N;
  }
  return 0.0;
}

Result<InverseModelEstimator> InverseModelEstimator::make(const Params& params, Seconds dt) {
  if (Check error = signal::check(params, dt)) return *std::move(error);
  if (Check error = check_gain("actuator_gain", params.actuator_gain)) return *std::move(error);
  if (Check error = check_gain("sensor_gain", params.sensor_gain)) return *std::move(error);
  if (Check error = check_inverse(params)) return *std::move(error);
  if (Check error = check_prediction(params, dt)) return *std::move(error);

  const RationalFunction plant = plant_of(params);
  const Coefficients inverse_denominator =
      with_lag(with_lag(plant.numerator(), params.force_filter_s), params.derivative_filter_s);
  const auto inverse = RationalFilter::make(RationalFunction::of(plant.denominator(), inverse_denominator), dt);
  if (!inverse) return under("plant", inverse.error());
  // Without T_d nothing but the friction law sees the velocity, behind a low-pass of half a sample.
  const double velocity_lag_s = std::max(params.derivative_filter_s, 0.5 * dt.value);
  const auto velocity = RationalFilter::make(
      {.numerator_0 = 0.0, .numerator_1 = 1.0, .denominator_0 = 1.0, .denominator_1 = velocity_lag_s}, dt);
  if (!velocity) return under("derivative_filter_s", velocity.error());
  const auto low_pass = RationalFilter::make(lag(params.force_filter_s), dt);
  if (!low_pass) return under("force_filter_s", low_pass.error());
  const auto prediction = signal::Predictor::make(params.prediction, dt);
  if (!prediction) return under("prediction", prediction.error());
  return InverseModelEstimator(params.friction, params.actuator_gain, 1.0 / params.sensor_gain, *prediction, *inverse,
                               *velocity, *low_pass);
}

ForceEstimate InverseModelEstimator::step(const SlaveMotionSample& sample) noexcept {
  const double position = prediction_.step(position_gain_ * sample.position);
  const double moving = inverse_.step(position) + friction_filter_.step(friction_(velocity_.step(position)));
  return {.force = moving - command_filter_.step(actuator_gain_ * sample.command)};
}

void InverseModelEstimator::reset() noexcept {
  prediction_.reset();
  inverse_.reset();
  velocity_.reset();
  friction_filter_.reset();
  command_filter_.reset();
}

std::complex<double> inverse_response(const InverseModelEstimator::Params& params, std::complex<double> s) {
  return 1.0 / (plant_of(params)(s) * params.sensor_gain) / (params.derivative_filter_s * s + 1.0);
}

}  // namespace tactus::control
