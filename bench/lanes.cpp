// SPDX-License-Identifier: Apache-2.0
// Loops on SIMD lanes against the same loop alone, against Boost.odeint on the same lanes and against the most that the
// machine can multiply and add; maps on one and two threads. Only ratios of one run: a shared machine drifts. Every
// loop runs the same tap with cancellation, so ticks per second compare directly.

#include <tactus/analysis/stability/lane_block.hpp>
#include <tactus/analysis/stability/lane_memory.hpp>
#include <tactus/analysis/stability/map.hpp>
#include <tactus/simulation/tasks/engine.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <bench/counted.hpp>
#include <bench/lane_peer.hpp>
#include <benchmark/benchmark.h>

namespace tactus::stability::lane_block {

template <>
struct Access<bench::Counted> {
  using Real = double;
  static constexpr std::size_t count = 1;
  static double get(const bench::Counted& scalar, std::size_t) { return scalar.get(0); }
  static void set(bench::Counted& scalar, std::size_t, double value) { scalar.set(0, value); }
};

}  // namespace tactus::stability::lane_block

namespace {

using namespace tactus::stability;
using tactus::bench::Method;

MapParams tap(double longest_step_s) {
  MapParams params;
  params.task.observation_s = 0.15;
  params.task.speed_m_per_s = 0.2;
  params.plant.longest_step_s = longest_step_s;
  params.control.force_gain = 5.0;
  return params;
}

/// One tap on every lane, again and again.
class Taps {
 public:
  Taps(const LaneRunner& runner, double longest_step_s)
      : runner_(runner),
        point_(*make_point(tap(longest_step_s))),
        plan_(*make_plan(tap(longest_step_s))),
        points_(runner.lanes, &point_),
        lines_(lane_room(&point_, 1, runner.lanes)),
        force_N_(plan_.longest() * runner.lanes),
        results_(runner.lanes) {}
  // What it holds points into itself.
  Taps(const Taps&) = delete;
  Taps& operator=(const Taps&) = delete;

  /// How many loop ticks that were.
  double run() {
    runner_.run(points_.data(), plan_, lines_.numbers(), force_N_.data(), results_.data());
    double ticks = 0.0;
    for (const LaneResult& result : results_) ticks += static_cast<double>(result.ticks);
    return ticks;
  }

 private:
  LaneRunner runner_;
  LanePoint point_;
  LanePlan plan_;
  std::vector<const LanePoint*> points_;
  LaneMemory lines_;
  std::vector<double> force_N_;
  std::vector<LaneResult> results_;
};

benchmark::Counter rate(double amount) { return {amount, benchmark::Counter::kIsRate}; }

/// `state.range(0)`: length of the plants' substeps in µs.
void run_block(benchmark::State& state, const LaneRunner& runner) {
  Taps taps(runner, static_cast<double>(state.range(0)) * 1e-6);
  double ticks = 0.0;
  for (auto _ : state) ticks += taps.run();
  state.counters["loop_ticks_per_s"] = rate(ticks);
}

/// `state.range(0)`: threads.
void run_map_on_threads(benchmark::State& state) {
  MapRequest request;
  request.base = tap(50e-6);
  request.axes = {*parse_axis("control.force_gain=0.5:30:64"),
                  *parse_axis("environment.stiffness_N_per_m=1e3:1e5:64[log]")};
  tactus::tasks::Threads threads(static_cast<std::size_t>(state.range(0)));
  request.place.engine = &threads;
  double ticks = 0.0;
  for (auto _ : state) ticks += run_map(request, [](double) {})->ticks;
  state.counters["loop_ticks_per_s"] = rate(ticks);
}

void run_peak(benchmark::State& state) {
  double operations = 0.0;
  for (auto _ : state) operations += tactus::bench::multiply_and_add(1000);
  state.counters["flops"] = rate(operations);
}

void run_held_masters(benchmark::State& state, Method method, double step_s) {
  double masters_s = 0.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(tactus::bench::run_masters(method, step_s));
    masters_s += tactus::bench::run_length_s * static_cast<double>(tactus::bench::masters_at_once);
  }
  state.counters["masters_s_per_s"] = rate(masters_s);
}

/// Largest difference over the largest value.
double error_of(const std::vector<double>& found, const std::vector<double>& truth) {
  double worst = 0.0, most = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    // A run that blew up is as wrong as can be.
    const double off = std::fabs(found[i] - truth[i]);
    worst = std::max(worst, std::isfinite(off) ? off : 1e9);
    most = std::max(most, std::fabs(truth[i]));
  }
  return worst / most;
}

/// The longest step of a method that errs by no more than `most_error` from its own limit of short steps.
double step_within(Method method, double most_error) {
  const auto truth = tactus::bench::run_masters(method, 0.1e-6);
  for (const double step_us : {200.0, 100.0, 50.0, 40.0, 20.0, 10.0, 5.0, 4.0, 2.0, 1.0, 0.5, 0.2}) {
    const double error = error_of(tactus::bench::run_masters(method, step_us * 1e-6), truth);
    if (error <= most_error) {
      std::printf("  %.1f us, error %.2g\n", step_us, error);
      return step_us * 1e-6;
    }
  }
  return 0.1e-6;
}

void register_peers() {
  benchmark::RegisterBenchmark("peak/avx512_double", run_peak);
  const double step_s = 50e-6;
  const double error = error_of(run_masters(Method::tactus, step_s), run_masters(Method::tactus, 0.5e-6));
  std::printf("Held masters, eight on a vector, at the accuracy of tactus with 50 us, error %.2g:\n", error);
  const auto add = [](const char* name, Method method, double step) {
    benchmark::RegisterBenchmark(name,
                                 [method, step](benchmark::State& state) { run_held_masters(state, method, step); });
  };
  add("held_master/tactus", Method::tactus, step_s);
  std::printf("odeint, Euler:");
  add("held_master/odeint_euler", Method::euler, step_within(Method::euler, error));
  std::printf("odeint, Runge-Kutta with smooth friction:");
  add("held_master/odeint_runge_kutta", Method::runge_kutta, step_within(Method::runge_kutta, error));
}

void print_operations() {
  for (const double step_s : {50e-6, 100e-6}) {
    const LaneRunner counting{"counting", 1, false, &lane_block::run<tactus::bench::Counted>};
    Taps taps(counting, step_s);
    tactus::bench::Counted::operations = tactus::bench::Counted::divisions = 0.0;
    const double ticks = taps.run();
    std::printf(
        "A loop tick with substeps of %.0f us: %.0f additions, multiplications, minima and maxima, %.1f divisions\n",
        step_s * 1e6, tactus::bench::Counted::operations / ticks, tactus::bench::Counted::divisions / ticks);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const LaneRunners runners = lane_runners();
  for (std::size_t i = 0; i < runners.count; ++i) {
    const LaneRunner& runner = *runners.all[i];
    const std::string name = std::string("block/") + runner.name + (runner.single ? "_float" : "_double");
    benchmark::RegisterBenchmark(name.c_str(), [&runner](benchmark::State& state) { run_block(state, runner); })
        ->Arg(10)
        ->Arg(50)
        ->Arg(100);
  }
  benchmark::RegisterBenchmark("map_on_threads", run_map_on_threads)
      ->Arg(1)
      ->Arg(2)
      ->MeasureProcessCPUTime()
      ->UseRealTime();
  print_operations();
  if (tactus::bench::has_avx512()) register_peers();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
