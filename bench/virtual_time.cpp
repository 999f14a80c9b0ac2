// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include <bench/impact_forces.hpp>
#include <bench/sections.hpp>
#include <benchmark/benchmark.h>

namespace tactus::bench {

namespace {

constexpr double plant_step_s = 10e-6;
constexpr int plant_steps = 1000;
constexpr std::array<int, 3> loop_steps_us{10, 20, 40};

std::string loop_name(int step_us) { return "closed loop, plant step " + std::to_string(step_us) + " us"; }

experiments::TappingParams hard_tapping(int step_us) {
  experiments::TappingParams params;
  params.task.supervised = false;
  params.plant.longest_step_s = 1e-6 * step_us;
  params.control.force_gain = 15.0;
  return params;
}

/// The intended path of a person who taps twice a second without end, a tick at a time.
std::vector<double> tapping_path() {
  constexpr double depth_m = 0.007, reach_s = 0.22, period_s = 0.5;
  const mechanics::MinimumJerk there{.start_m = -depth_m, .end_m = depth_m, .duration_s = reach_s};
  const mechanics::MinimumJerk back{.end_m = -2.0 * depth_m, .start_time_s = 0.5 * period_s, .duration_s = reach_s};
  std::vector<double> path_m;
  for (double time_s = 0.0; time_s < period_s; time_s += tick_s) {
    path_m.push_back(there.position_m(time_s) + back.position_m(time_s));
  }
  return path_m;
}

void add_closed_loop(int step_us) {
  auto path = tapping_path();
  auto loop = *simulation::Teleoperator::make(hard_tapping(step_us), path.front());
  add_case(loop_name(step_us), [loop, path = std::move(path)]() mutable {
    for (std::size_t i = 0; i < path.size(); ++i) {
      benchmark::DoNotOptimize(loop.step(path[i], path[i + 1 == path.size() ? 0 : i + 1]));
    }
  });
}

}  // namespace

void add_virtual_time() {
  auto master = *mechanics::CableDrivenMaster::make({}, mechanics::Operator::Params{}.grip, Seconds{plant_step_s});
  add_case("master", [master]() mutable {
    for (int i = 0; i < plant_steps; ++i) master.step({.commanded_force_N = i < plant_steps / 2 ? -0.5 : 0.0});
    benchmark::DoNotOptimize(master);
  });
  auto slave = *mechanics::ElectricSlave::make({}, Seconds{plant_step_s});
  add_case("slave", [slave]() mutable {
    slave.reset(-1e-4);  // meets the wall after a third of the pass and bounces on it
    for (int i = 0; i < plant_steps; ++i) slave.step(0.5);
    benchmark::DoNotOptimize(slave);
  });
  for (const int step_us : loop_steps_us) add_closed_loop(step_us);

  const auto ensemble = *experiments::TappingEnsemble::make(hard_tapping(10));
  add_case("tap", [ensemble] { benchmark::DoNotOptimize(ensemble.run(0)); });
}

Findings virtual_time(const Times& times) {
  constexpr const char* plants = "The plants alone, steps of 10 us";
  constexpr const char* loop = "Closed loop in virtual time, tapping a wall at a force gain of 15, cancelled";
  const auto million_steps = [&times](const char* name) { return 1e-6 * plant_steps / times.at(name); };
  Findings findings{{plants, "master", million_steps("master"), "M/s"},
                    {plants, "slave against a wall", million_steps("slave"), "M/s"}};
  const double period_s = tick_s * static_cast<double>(tapping_path().size());
  for (const int step_us : loop_steps_us) {
    findings.push_back({loop, loop_name(step_us), period_s / times.at(loop_name(step_us)), "x real time",
                        Finding::Goal::at_least, 5000.0});
  }
  const auto ensemble = *experiments::TappingEnsemble::make(hard_tapping(10));
  const double tap_s = ensemble.run(0).first_touch_s + experiments::TappingTask{}.observation_s;
  findings.push_back(
      {loop, "one tap of the ensemble, set up and judged, plant step 10 us", tap_s / times.at("tap"), "x real time"});
  return findings;
}

}  // namespace tactus::bench
