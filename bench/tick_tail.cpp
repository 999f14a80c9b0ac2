// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/model/induced_motion_model.hpp>
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <numeric>
#include <string>

#include <bench/impact_forces.hpp>
#include <bench/sections.hpp>
#include <benchmark/benchmark.h>

namespace tactus::bench {

namespace {

/// Ticks between two readings of the clock. On many virtual machines the clock advances by 10 ns, half a tick.
constexpr std::size_t ticks_of_probe = 10;

struct Spread {
  double usual_ns;
  double tail_ns;
};

/// The mean of the middle nine tenths, which sees below the clock's resolution, and the quantile that one tick in
/// 10,000 would make if slow ticks came one to a probe.
Spread spread_of(std::vector<double> times_ns) {
  std::sort(times_ns.begin(), times_ns.end());
  const auto edge = static_cast<std::ptrdiff_t>(times_ns.size() / 20);
  const double sum = std::accumulate(times_ns.begin() + edge, times_ns.end() - edge, 0.0);
  return {.usual_ns = sum / static_cast<double>(times_ns.end() - times_ns.begin() - 2 * edge),
          .tail_ns = simulation::quantile(times_ns, 1.0 - 1e-4 * ticks_of_probe)};
}

// The machine interrupts a program now and then, and reading the clock costs as much as a tick. So a probe with nothing
// between two readings follows every probe of ten ticks, and like is subtracted from like. What a slow probe takes
// beyond the usual is put down to one of its ticks, which overstates the tail. The median over the windows leaves out
// those that the machine spoiled.
Findings tail_of(const std::string& linkage, const control::InducedMotionModel::Params& params) {
  using Clock = std::chrono::steady_clock;
  constexpr int windows = 21, passes = 40;
  constexpr const char* section = "Spread of the exact tick, an empty probe subtracted";
  const auto forces = impact_forces();
  auto model = *control::InducedMotionModel::make(params, Seconds{tick_s});

  std::vector<double> usual, tail, ratio, probes_ns, empty_ns;
  for (int window = 0; window < windows; ++window) {
    probes_ns.clear();
    empty_ns.clear();
    for (int pass = 0; pass < passes; ++pass) {
      for (std::size_t i = 0; i + ticks_of_probe <= forces.size(); i += ticks_of_probe) {
        const auto start = Clock::now();
        for (std::size_t tick = 0; tick < ticks_of_probe; ++tick) model.step({.motor_force_N = -forces[i + tick]});
        benchmark::DoNotOptimize(model);
        const auto middle = Clock::now();
        const auto end = Clock::now();
        probes_ns.push_back(std::chrono::duration<double, std::nano>(middle - start).count());
        empty_ns.push_back(std::chrono::duration<double, std::nano>(end - middle).count());
      }
    }
    const Spread probe = spread_of(probes_ns), empty = spread_of(empty_ns);
    const double excess_ns = (probe.tail_ns - probe.usual_ns) - (empty.tail_ns - empty.usual_ns);
    usual.push_back((probe.usual_ns - empty.usual_ns) / static_cast<double>(ticks_of_probe));
    tail.push_back(usual.back() + excess_ns);
    ratio.push_back(tail.back() / usual.back());
  }
  return {{section, linkage + ", usual tick", simulation::quantile(usual, 0.5), "ns"},
          {section, linkage + ", p99.99", simulation::quantile(tail, 0.5), "ns"},
          {section, linkage + ", p99.99 / usual", simulation::quantile(ratio, 0.5), "", Finding::Goal::at_most, 2.0}};
}

}  // namespace

Findings tick_tail() {
  const control::InducedMotionModel::Params hysteretic;
  auto linear = hysteretic;
  linear.master.linkage.hysteretic_fraction = 0.0;
  Findings findings = tail_of("linear linkage", linear);
  for (const Finding& finding : tail_of("hysteretic linkage", hysteretic)) findings.push_back(finding);
  return findings;
}

}  // namespace tactus::bench
