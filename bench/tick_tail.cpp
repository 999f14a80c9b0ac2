#include <tactus/control/induced_motion_model.hpp>
#include <tactus/simulation/quantile.hpp>

#include <chrono>
#include <cstddef>

#include <bench/impact_forces.hpp>
#include <bench/sections.hpp>
#include <benchmark/benchmark.h>

namespace tactus::bench {

// The machine interrupts a program now and then, and a clock costs about as much as a tick. So a probe with nothing
// between two readings of the clock follows every tick, and equal quantiles are subtracted. A window is 4 s of servo
// time; the median over the windows leaves out those that the machine spoiled.
Findings tick_tail() {
  using Clock = std::chrono::steady_clock;
  constexpr int windows = 41, passes = 4;
  constexpr const char* section = "Spread of the exact tick, an empty probe subtracted";
  const auto forces = impact_forces();
  auto model = *control::InducedMotionModel::make({}, Seconds{tick_s});

  std::vector<double> usual, tail, ratio;
  std::vector<double> ticks_ns, empty_ns;
  for (int window = 0; window < windows; ++window) {
    ticks_ns.clear();
    empty_ns.clear();
    for (int pass = 0; pass < passes; ++pass) {
      for (const double force : forces) {
        const auto start = Clock::now();
        model.step({.motor_force_N = -force});
        benchmark::DoNotOptimize(model);
        const auto middle = Clock::now();
        const auto end = Clock::now();
        ticks_ns.push_back(std::chrono::duration<double, std::nano>(middle - start).count());
        empty_ns.push_back(std::chrono::duration<double, std::nano>(end - middle).count());
      }
    }
    const auto tick_at = [&](double q) {
      return simulation::quantile(ticks_ns, q) - simulation::quantile(empty_ns, q);
    };
    usual.push_back(tick_at(0.5));
    tail.push_back(tick_at(0.9999));
    ratio.push_back(tail.back() / usual.back());
  }
  return {{section, "p50", simulation::quantile(usual, 0.5), "ns"},
          {section, "p99.99", simulation::quantile(tail, 0.5), "ns"},
          {section, "p99.99 / p50", simulation::quantile(ratio, 0.5), "", Finding::Goal::at_most, 2.0}};
}

}  // namespace tactus::bench
