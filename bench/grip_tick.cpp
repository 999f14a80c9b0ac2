// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

#include <bench/impact_forces.hpp>
#include <bench/sections.hpp>
#include <benchmark/benchmark.h>

namespace tactus::bench {

namespace {

using control::OperatorEstimate;

/// A second of impacts on a hand half as firm as the one that is identified, so that there is something to find.
struct Impacts {
  std::vector<double> motor_force_N, position_m;
};

Impacts impacts_on_another_hand() {
  constexpr double force_over_drawn = 8.0;  // to a display of 10 N, not of 1 N
  control::InducedMotionModel::Params params;
  params.master = control::held(params.master, 0.5);
  auto device = *control::InducedMotionModel::make(params, Seconds{tick_s});
  Impacts impacts;
  for (const double force_N : impact_forces()) {
    impacts.motor_force_N.push_back(-force_over_drawn * force_N);
    impacts.position_m.push_back(device.motor_position_m());
    device.step({.motor_force_N = impacts.motor_force_N.back()});
  }
  return impacts;
}

/// The time in ns of a tick of `a` and of `b` over the same impacts, passes taken in turn: the tenth percentile, as
/// near to undisturbed as a busy machine gives.
struct Pair {
  double a_ns, b_ns;
};

template <class Make, class Tick>
Pair in_turn(const Impacts& impacts, int passes, const Make& make, const Tick& tick) {
  using Clock = std::chrono::steady_clock;
  const auto pass_ns = [&](auto element) {
    const auto start = Clock::now();
    for (std::size_t i = 0; i < impacts.position_m.size(); ++i) {
      tick(element, impacts.position_m[i], impacts.motor_force_N[i]);
    }
    benchmark::DoNotOptimize(element);
    const std::chrono::duration<double, std::nano> taken = Clock::now() - start;
    return taken.count() / static_cast<double>(impacts.position_m.size());
  };
  std::vector<double> fixed, online;
  for (int pass = 0; pass < passes; ++pass) {
    fixed.push_back(pass_ns(make(OperatorEstimate::off)));
    online.push_back(pass_ns(make(OperatorEstimate::online)));
  }
  return {.a_ns = simulation::quantile(fixed, 0.1), .b_ns = simulation::quantile(online, 0.1)};
}

control::GripCancellation stage(OperatorEstimate estimate) {
  return *control::GripCancellation::make({.cancellation = {}, .estimate = estimate}, Seconds{tick_s});
}

control::MasterSite gated_site(OperatorEstimate estimate) {
  control::PositionForceMaster::Params params;
  params.force_limit_N = 10.0;
  params.operator_estimate = estimate;
  return {control::master_controller(*control::PositionForceMaster::make(params, Seconds{tick_s})),
          *control::SafetyGate::make({}, Seconds{tick_s})};
}

}  // namespace

Findings grip_tick(bool quick) {
  const Impacts impacts = impacts_on_another_hand();
  const int passes = quick ? 40 : 400;
  const Pair alone =
      in_turn(impacts, passes, stage, [](control::GripCancellation& each, double position_m, double force_N) {
        double intended_m = each.step({.measured_position_m = position_m, .motor_force_N = force_N});
        benchmark::DoNotOptimize(intended_m);
      });
  const Pair gated =
      in_turn(impacts, passes, gated_site, [](control::MasterSite& each, double position_m, double force_N) {
        control::MasterOutput output =
            each.step({.motor_position_m = position_m, .arrival = {.message = {.force_N = -force_N}, .fresh = true}});
        benchmark::DoNotOptimize(output);
      });
  constexpr const char* section =
      "An online estimate of the hand beside a fixed one, tenth percentile of passes in turn";
  using enum Finding::Goal;
  return {{section, "stage, fixed hand", alone.a_ns, "ns"},
          {section, "stage, online estimate", alone.b_ns, "ns"},
          {section, "stage, online / fixed", alone.b_ns / alone.a_ns, "", at_most, 2.0},
          {section, "site with its gate, fixed hand", gated.a_ns, "ns"},
          {section, "site with its gate, online estimate", gated.b_ns, "ns"},
          {section, "site with its gate, online / fixed", gated.b_ns / gated.a_ns, "", at_most, 2.0}};
}

}  // namespace tactus::bench
