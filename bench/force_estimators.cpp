#include <tactus/control/inverse_model_estimator.hpp>

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

control::InverseModelEstimator inverse_model(control::FrictionLaw law) {
  control::InverseModelEstimator::Params params;
  params.friction = {.law = law, .force_N = 1.0};
  return *control::InverseModelEstimator::make(params, Seconds{200e-6});
}

}  // namespace

void add_force_estimators() {
  add_estimator("inverse model", inverse_model(control::FrictionLaw::none));
  add_estimator("inverse model, sigmoid", inverse_model(control::FrictionLaw::sigmoid));
}

Findings force_estimators(const Times& times) {
  const auto tick_ns = [&times](const char* name) { return 1e9 * times.at(name) / ticks; };
  return {{section, "inverse model, two blocks", tick_ns("inverse model"), "ns"},
          {section, "the same with the paper's damping function", tick_ns("inverse model, sigmoid"), "ns"}};
}

}  // namespace tactus::bench
