// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/quantile.hpp>

#include <array>
#include <utility>

#include <bench/harness.hpp>
#include <benchmark/benchmark.h>

namespace tactus::bench {

namespace {

/// Keeps the time of each repetition instead of printing it.
class Collector : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.run_type != Run::RT_Iteration || run.error_occurred) continue;
      times_s_[run.run_name.function_name].push_back(run.cpu_accumulated_time / static_cast<double>(run.iterations));
    }
  }

  [[nodiscard]] Times medians() const {
    Times medians;
    for (const auto& [name, times] : times_s_) medians[name] = simulation::quantile(times, 0.5);
    return medians;
  }

 private:
  std::map<std::string, std::vector<double>> times_s_;
};

}  // namespace

void add_case(const std::string& name, std::function<void()> pass) {
  benchmark::RegisterBenchmark(name.c_str(), [pass = std::move(pass)](benchmark::State& state) {
    for (auto _ : state) pass();
  });
}

Times run_cases(int repetitions, double least_time_s) {
  std::string program = "bench_tactus", interleaving = "--benchmark_enable_random_interleaving=true",
              repeat = "--benchmark_repetitions=" + std::to_string(repetitions),
              time = "--benchmark_min_time=" + std::to_string(least_time_s);
  std::array<char*, 4> arguments{program.data(), interleaving.data(), repeat.data(), time.data()};
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  Collector collector;
  benchmark::RunSpecifiedBenchmarks(&collector);
  benchmark::Shutdown();
  return collector.medians();
}

}  // namespace tactus::bench
