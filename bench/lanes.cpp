// Loops on SIMD lanes against the same loop alone, and maps on one and two threads. Only ratios of one
// run: a shared machine drifts. Every case runs the same tap with cancellation, so ticks per second compare directly.

#include <tactus/stability/lane_memory.hpp>
#include <tactus/stability/map.hpp>

#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace {

using namespace tactus::stability;

MapParams tap(double longest_step_s) {
  MapParams params;
  params.task.observation_s = 0.15;
  params.task.speed_m_per_s = 0.2;
  params.plant.longest_step_s = longest_step_s;
  params.control.force_gain = 5.0;
  return params;
}

/// `state.range(0)`: length of the plants' substeps in µs.
void run_block(benchmark::State& state, const LaneRunner& runner) {
  const MapParams params = tap(static_cast<double>(state.range(0)) * 1e-6);
  const LanePoint point = *make_point(params);
  const LanePlan plan = *make_plan(params);
  const std::vector<const LanePoint*> points(runner.lanes, &point);
  LaneMemory lines(lane_room(&point, 1, runner.lanes));
  std::vector<double> force_N(plan.longest() * runner.lanes);
  std::vector<LaneResult> results(runner.lanes);
  double ticks = 0.0;
  for (auto _ : state) {
    runner.run(points.data(), plan, lines.numbers(), force_N.data(), results.data());
    for (const LaneResult& result : results) ticks += static_cast<double>(result.ticks);
  }
  state.counters["loop_ticks_per_s"] = benchmark::Counter(ticks, benchmark::Counter::kIsRate);
}

/// `state.range(0)`: threads.
void run_map_on_threads(benchmark::State& state) {
  MapRequest request;
  request.base = tap(50e-6);
  request.axes = {*parse_axis("control.force_gain=0.5:30:64"),
                  *parse_axis("environment.stiffness_N_per_m=1e3:1e5:64[log]")};
  request.threads = static_cast<std::size_t>(state.range(0));
  double ticks = 0.0;
  for (auto _ : state) ticks += run_map(request, [](double) {})->ticks;
  state.counters["loop_ticks_per_s"] = benchmark::Counter(ticks, benchmark::Counter::kIsRate);
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
  benchmark::RegisterBenchmark("map_on_threads", run_map_on_threads)->Arg(1)->Arg(2)->UseRealTime();
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
