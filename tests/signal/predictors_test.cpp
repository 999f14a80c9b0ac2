// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/predictor.hpp>

#include <cmath>
#include <complex>
#include <numbers>
#include <string>

#include "tests/oracle_table.hpp"
#include "tests/signal/frequency_response.hpp"
#include <gtest/gtest.h>

// Polynomial and Kalman prediction, the rivals of the prediction block.
namespace tactus::signal {
namespace predictors_test {

constexpr double dt_s = 2e-4;
constexpr double horizon_s = 0.0036;

KalmanPredictor kalman(Kinematics kinematics, double process_noise) {
  return KalmanPredictor::make({.kinematics = kinematics, .process_noise = process_noise}, Seconds{dt_s}).value();
}
PolynomialPredictor polynomial(std::int64_t samples, std::int64_t degree) {
  return PolynomialPredictor::make({.samples = samples, .degree = degree, .horizon_s = horizon_s}, Seconds{dt_s})
      .value();
}

TEST(PolynomialPredictor, HasTheTapsThatSavitzkyAndGolayGive) {
  const OracleTable oracle("signal_polynomial_predictor");
  for (std::size_t row = 0; row < oracle.column("tap").size(); ++row) {
    const auto samples = static_cast<std::int64_t>(oracle.column("samples")[row]);
    const auto degree = static_cast<std::int64_t>(oracle.column("degree")[row]);
    const auto lag = static_cast<std::size_t>(oracle.column("lag")[row]);
    const PolynomialPredictor predictor = polynomial(samples, degree);
    EXPECT_NEAR(predictor.taps()[lag], oracle.column("tap")[row], 1e-9 * predictor.white_noise_gain())
        << samples << " samples, degree " << degree << ", lag " << lag;
  }
}

TEST(PolynomialPredictor, SeesEveryPolynomialUpToItsDegreeByTheHorizonAhead) {
  for (std::int64_t degree = 1; degree <= 3; ++degree) {
    for (const std::int64_t samples : {degree + 1, std::int64_t{40}, std::int64_t{128}}) {
      PolynomialPredictor predictor = polynomial(samples, degree);
      const auto signal = [degree](double time_s) {
        const double t = 10.0 * time_s;
        return 2.0 - 3.0 * t + (degree > 1 ? 5.0 * t * t : 0.0) - (degree > 2 ? 7.0 * t * t * t : 0.0);
      };
      double ahead = 0.0;
      for (int tick = 0; tick <= 300; ++tick) ahead = predictor.step(signal(tick * dt_s));
      EXPECT_NEAR(ahead, signal(300 * dt_s + horizon_s), 1e-11 * predictor.white_noise_gain()) << samples;
    }
  }
}

TEST(PolynomialPredictor, OfDegreeZeroIsTheMeanOfTheLastSamples) {
  PolynomialPredictor predictor = polynomial(4, 0);
  for (const double sample : {9.0, 1.0, 2.0, 3.0}) (void)predictor.step(sample);
  EXPECT_DOUBLE_EQ(predictor.step(6.0), 3.0);
  EXPECT_DOUBLE_EQ(predictor.white_noise_gain(), 0.5);
}

TEST(PolynomialPredictor, OfAStraightLineAmplifiesNoiseAsTheVarianceOfRegressionSays) {
  // Variance of a straight line's prediction at t_h: 1/N + (t_h − mean)²/Σ(t − mean)², Σ = N(N² − 1)/12.
  for (const double samples : {2.0, 16.0, 64.0}) {
    const double offset = 0.5 * (samples - 1.0) + horizon_s / dt_s;
    const double variance = 1.0 / samples + 12.0 * offset * offset / (samples * (samples * samples - 1.0));
    EXPECT_NEAR(polynomial(static_cast<std::int64_t>(samples), 1).white_noise_gain(), std::sqrt(variance), 1e-11);
  }
}

TEST(PolynomialPredictor, RefusesFewerSamplesThanTheDegreeAsksFor) {
  const auto refused = PolynomialPredictor::make({.samples = 3, .degree = 3}, Seconds{dt_s});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "samples");
  EXPECT_EQ(refused.error().code, ErrorCode::inconsistent);
}

TEST(KalmanPredictor, HasTheGainThatTheRiccatiEquationGives) {
  const OracleTable oracle("signal_kalman_predictor");
  for (std::size_t row = 0; row < oracle.column("order").size(); ++row) {
    const auto predictor =
        KalmanPredictor::make({.kinematics = oracle.column("order")[row] == 2.0 ? Kinematics::constant_velocity
                                                                                : Kinematics::constant_acceleration,
                               .process_noise = oracle.column("process_noise")[row],
                               .measurement_noise = oracle.column("measurement_noise")[row]},
                              Seconds{oracle.column("dt_s")[row]});
    ASSERT_TRUE(predictor) << describe(predictor.error());
    for (std::size_t k = 0; k < 3; ++k) {
      const double expected = oracle.column(("gain_" + std::to_string(k)).c_str())[row];
      EXPECT_NEAR(predictor->gain()[k], expected, 1e-8 * expected) << "row " << row << ", gain " << k;
    }
  }
}

TEST(KalmanPredictor, SeesWhatItsKinematicsAllowByTheHorizonAhead) {
  for (const auto kinematics : {Kinematics::constant_velocity, Kinematics::constant_acceleration}) {
    const double acceleration = kinematics == Kinematics::constant_acceleration ? 40.0 : 0.0;
    const auto signal = [acceleration](double t) { return 1.0 - 3.0 * t + 0.5 * acceleration * t * t; };
    KalmanPredictor predictor = kalman(kinematics, 3.0);
    double ahead = 0.0;
    for (int tick = 0; tick <= 5000; ++tick) ahead = predictor.step(signal(tick * dt_s));
    EXPECT_NEAR(ahead, signal(5000 * dt_s + horizon_s), 1e-10);
  }
}

TEST(KalmanPredictor, OnlyTheRatioOfItsNoisesMatters) {
  const auto one = KalmanPredictor::make({.process_noise = 1e4, .measurement_noise = 1e-2}, Seconds{dt_s}).value();
  const auto other = KalmanPredictor::make({.process_noise = 1e7, .measurement_noise = 10.0}, Seconds{dt_s}).value();
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(one.gain()[k], other.gain()[k], 1e-12);
}

TEST(KalmanPredictor, RefusesNoisesSoFarApartThatNoStableGainIsLeft) {
  const auto refused = KalmanPredictor::make({.process_noise = 1e-300, .measurement_noise = 1e100}, Seconds{dt_s});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "process_noise");
  EXPECT_EQ(refused.error().code, ErrorCode::inconsistent);
}

/// Sum of squares of the impulse response by brute force.
template <class Element>
double measured_noise_gain(Element element) {
  double sum = 0.0;
  for (int tick = 0; tick < 100000; ++tick) sum += std::pow(element.step(tick == 0 ? 1.0 : 0.0), 2);
  return std::sqrt(sum);
}

TEST(Predictors, ResponseAndNoiseGainAreThoseOfTheImpulseResponse) {
  const auto check = [](const auto& predictor) {
    for (const double frequency_Hz : {0.1, 10.0, 300.0, 2500.0}) {
      const auto measured = measured_response(predictor, frequency_Hz, dt_s, 20000);
      EXPECT_NEAR(std::abs(predictor.response(frequency_Hz) - measured), 0.0, 1e-8 * std::abs(measured));
    }
    EXPECT_NEAR(predictor.white_noise_gain(), measured_noise_gain(predictor), 1e-10 * predictor.white_noise_gain());
  };
  check(polynomial(56, 2));
  check(polynomial(7, 0));
  check(kalman(Kinematics::constant_velocity, 0.03));
  check(kalman(Kinematics::constant_acceleration, 3.0));
}

TEST(Predictors, AtEqualLeadAndEqualBandBothAmplifyNoiseLessThanThePredictionBlocks) {
  // Two blocks of 1.8 ms: a tenth of the signal is wrong at 16 Hz.
  const PredictionCascade::Params blocks{.blocks = 2, .block = {.time_constant_s = 0.5 * horizon_s}};
  const double noise_gain = white_noise_gain(blocks, Seconds{dt_s}).value();
  const double band_Hz = usable_band_Hz(blocks);
  const auto check = [&](const auto& predictor) {
    const std::complex<double> ideal = std::polar(1.0, 2.0 * std::numbers::pi * band_Hz * horizon_s);
    EXPECT_LT(std::abs(predictor.response(band_Hz) - ideal), 0.1);
    EXPECT_LT(predictor.white_noise_gain(), 0.5 * noise_gain);
  };
  check(polynomial(56, 2));
  check(kalman(Kinematics::constant_acceleration, 3.0));
}

TEST(Predictor, IsTheOneThatItsKindNames) {
  for (const auto kind : {PredictionKind::blocks, PredictionKind::polynomial, PredictionKind::kalman}) {
    const Predictor::Params params{.kind = kind};
    Predictor predictor = Predictor::make(params, Seconds{dt_s}).value();
    auto blocks = PredictionCascade::make({}, Seconds{dt_s}).value();
    auto fitted = PolynomialPredictor::make({}, Seconds{dt_s}).value();
    auto filter = KalmanPredictor::make({}, Seconds{dt_s}).value();
    EXPECT_DOUBLE_EQ(params.lead_s(), horizon_s);
    for (int tick = 0; tick < 50; ++tick) {
      const double input = std::sin(0.1 * tick);
      const double of_blocks = blocks.step(input), of_fit = fitted.step(input), of_filter = filter.step(input);
      EXPECT_EQ(predictor.step(input), kind == PredictionKind::blocks       ? of_blocks
                                       : kind == PredictionKind::polynomial ? of_fit
                                                                            : of_filter);
    }
  }
}

TEST(Predictor, NamesTheKeyOfWhatItRefuses) {
  const Predictor::Params params{.kind = PredictionKind::polynomial, .polynomial = {.samples = 2, .degree = 2}};
  const auto refused = Predictor::make(params, Seconds{dt_s});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "polynomial.samples");
}

}  // namespace predictors_test
}  // namespace tactus::signal
