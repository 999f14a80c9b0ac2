// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/estimators/disturbance_observer.hpp>
#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>
#include <tactus/kernel/control/estimators/kalman_force_estimator.hpp>
#include <tactus/kernel/control/estimators/momentum_observer.hpp>
#include <tactus/kernel/control/estimators/narx_force_estimator.hpp>

#include <cmath>
#include <vector>

#include <bench/sections.hpp>
#include <benchmark/benchmark.h>

namespace tactus::bench {

namespace {

constexpr const char* section = "One tick (200 us) of the force estimators";
constexpr int ticks = 2000;

std::vector<control::SlaveMotionSample> motion() {
  std::vector<control::SlaveMotionSample> samples;
  for (int i = 0; i < ticks; ++i) samples.push_back({.command = std::cos(0.01 * i), .position = std::sin(0.01 * i)});
  return samples;
}

/// A pass over the motion; each tick starts from the state that the last one left.
template <class Estimator>
void add_estimator(const char* name, Estimator estimator) {
  add_case(name, [estimator, samples = motion()]() mutable {
    for (const control::SlaveMotionSample& sample : samples) {
      auto estimate = estimator.step(sample);
      benchmark::DoNotOptimize(estimate);
    }
  });
}

control::InverseModelEstimator inverse_model(control::FrictionLaw law,
                                             signal::PredictionKind kind = signal::PredictionKind::blocks) {
  control::InverseModelEstimator::Params params;
  params.prediction.kind = kind;
  params.prediction.polynomial.samples = 20;
  params.friction = {.law = law, .force_N = 1.0};
  return *control::InverseModelEstimator::make(params, Seconds{200e-6});
}

/// With the same friction law in each.
template <class Observer>
Observer observer() {
  typename Observer::Params params;
  params.model.friction = {.law = control::FrictionLaw::smooth_coulomb, .force_N = 0.02};
  return *Observer::make(params, Seconds{200e-6});
}

/// Six terms up to the third degree, as the experiment finds them.
control::NarxForceEstimator narx() {
  control::NarxForceEstimator::Params params;
  params.terms = {.term_0 = {.coefficient_N = 0.7, .variable_1 = 1},
                  .term_1 = {.coefficient_N = -0.5, .variable_1 = 4},
                  .term_2 = {.coefficient_N = 0.05, .variable_1 = 2, .variable_2 = 2, .variable_3 = 1},
                  .term_3 = {.coefficient_N = -0.4, .variable_1 = 2},
                  .term_4 = {.coefficient_N = 0.3, .variable_1 = 3},
                  .term_5 = {.coefficient_N = -0.05, .variable_1 = 3, .variable_2 = 1, .variable_3 = 1}};
  return *control::NarxForceEstimator::make(params, Seconds{200e-6});
}

}  // namespace

void add_force_estimators() {
  add_estimator("inverse model", inverse_model(control::FrictionLaw::none));
  add_estimator("inverse model, sigmoid", inverse_model(control::FrictionLaw::sigmoid));
  add_estimator("inverse model, tanh", inverse_model(control::FrictionLaw::smooth_coulomb));
  add_estimator("inverse model, polynomial",
                inverse_model(control::FrictionLaw::smooth_coulomb, signal::PredictionKind::polynomial));
  add_estimator("inverse model, Kalman",
                inverse_model(control::FrictionLaw::smooth_coulomb, signal::PredictionKind::kalman));
  add_estimator("disturbance observer", observer<control::DisturbanceObserver>());
  add_estimator("momentum observer", observer<control::MomentumObserver>());
  add_estimator("Kalman filter", observer<control::KalmanForceEstimator>());
  add_estimator("NARX", narx());
}

Findings force_estimators(const Times& times) {
  const auto tick_ns = [&times](const char* name) { return 1e9 * times.at(name) / ticks; };
  return {{section, "inverse model, two blocks", tick_ns("inverse model"), "ns"},
          {section, "the same with the paper's damping function", tick_ns("inverse model, sigmoid"), "ns"},
          {section, "the same with smoothed Coulomb friction", tick_ns("inverse model, tanh"), "ns"},
          {section, "the same, polynomial through 20 samples for blocks", tick_ns("inverse model, polynomial"), "ns"},
          {section, "the same, Kalman predictor for blocks", tick_ns("inverse model, Kalman"), "ns"},
          {section, "disturbance observer, smoothed Coulomb friction", tick_ns("disturbance observer"), "ns"},
          {section, "momentum observer, smoothed Coulomb friction", tick_ns("momentum observer"), "ns"},
          {section, "Kalman filter, smoothed Coulomb friction", tick_ns("Kalman filter"), "ns"},
          {section, "NARX model, six terms", tick_ns("NARX"), "ns"}};
}

}  // namespace tactus::bench
