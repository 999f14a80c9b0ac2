#include <tactus/signal/second_order_filter.hpp>
#include <tactus/simulation/tapping.hpp>

#include <cmath>
#include <cstdio>
#include <functional>
#include <vector>

#include "tests/simulation/default_experiment.hpp"
#include <gtest/gtest.h>

namespace tactus::simulation {
namespace {

using Change = std::function<void(TappingParams&)>;

struct Shown {
  double share, error, before_N;
};

Shown shown(const Change& change) {
  TappingParams params = experiment_file<TappingParams>("tapping");
  params.control.cancellation = control::CancellationMode::off;
  params.control.force_gain = 0.5;
  change(params);
  const auto ensemble = TappingEnsemble::make(params).value();
  double felt2 = 0.0, meant2 = 0.0, wrong2 = 0.0, before_N = 0.0;
  for (std::size_t tap = 0; tap < ensemble.size(); ++tap) {
    std::vector<Teleoperator::Record> trace;
    const TapResult result = ensemble.run(tap, &trace);
    auto felt_filter = signal::SecondOrderFilter::make({.kind = signal::FilterKind::high_pass, .frequency_Hz = 20.0}, Seconds{200e-6}).value();
    auto meant_filter = felt_filter;
    for (std::size_t i = 0; i + 2 < trace.size(); ++i) {
      const double felt = felt_filter.step(trace[i + 2].displayed_force_N - trace[i + 2].handle_force_N);
      const double meant = meant_filter.step(params.control.force_gain * trace[i].contact_force_N);
      const double since = trace[i].time_s - result.first_touch_s;
      if (since < 0) before_N = std::max(before_N, std::fabs(trace[i].displayed_force_N));
      if (since < 0.0 || since > 0.05) continue;
      felt2 += felt * felt;
      meant2 += meant * meant;
      wrong2 += (felt - meant) * (felt - meant);
    }
  }
  return {std::sqrt(felt2 / meant2), std::sqrt(wrong2 / meant2), before_N};
}

TEST(Rivals, Print) {
  const auto print = [](const char* name, const Change& change) {
    const Shown s = shown(change);
    std::printf("%-40s share %.3f error %.3f free %.3f\n", name, s.share, s.error, s.before_N);
  };
  print("plain", [](auto&) {});
  print("cancellation", [](auto& p) { p.control.cancellation = control::CancellationMode::on; });
  for (const double b : {2.0, 5.0, 10.0, 20.0}) print(("damping " + std::to_string(b)).c_str(), [b](auto& p) { p.control.damping.damping_N_s_per_m = b; });
  for (const double f : {10.0, 20.0, 30.0, 50.0}) {
    print(("command lp " + std::to_string(f)).c_str(), [f](auto& p) { p.control.command_filter = {.kind = control::Shaping::low_pass, .frequency_Hz = f}; });
    print(("force lp " + std::to_string(f)).c_str(), [f](auto& p) { p.control.force_filter = {.kind = control::Shaping::low_pass, .frequency_Hz = f}; });
    print(("crossover " + std::to_string(f)).c_str(), [f](auto& p) { p.control.crossover.frequency_Hz = f; });
  }
  for (const double w : {30.0, 75.0, 200.0}) {
    print(("command notch " + std::to_string(w)).c_str(), [w](auto& p) { p.control.command_filter = {.kind = control::Shaping::notch, .frequency_Hz = 75, .notch_width_Hz = w}; });
    print(("force notch " + std::to_string(w)).c_str(), [w](auto& p) { p.control.force_filter = {.kind = control::Shaping::notch, .frequency_Hz = 75, .notch_width_Hz = w}; });
  }
}

}  // namespace
}  // namespace tactus::simulation
