// SPDX-License-Identifier: Apache-2.0
// virtual_day [HOURS [ARCHITECTURE]]: two supervised sites at 5 kHz for 24 h of virtual time, or so many, over the
// link's codec, without a fault: a person taps and presses all the time. Every hour and at the end the run must be what
// it was in the first. Prints what came out; status 1 where anything differs.
#include <tactus/simulation/experiments/faults/table.hpp>

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include <tests/soak/day.hpp>

int main(int count, char** arguments) {
  using namespace tactus;
  const double hours = count > 1 ? std::atof(arguments[1]) : 24.0;
  if (!(hours > 0.0)) {
    std::fprintf(stderr, "use: virtual_day [HOURS [ARCHITECTURE]]\n");
    return 2;
  }
  experiments::FaultsParams params;
  // A fifth of the substeps that the experiments take: what is looked at is the sites, not the plants.
  params.plant.longest_step_s = 1e-4;
  if (count > 2) params.control.architecture = arguments[2];
  const auto began = std::chrono::steady_clock::now();
  // What is shorter than a day is cut into six.
  const int cuts = hours >= 24.0 ? static_cast<int>(hours) : 6;
  const auto report = soak::run_day(params, {}, 3600.0 * hours, cuts, [&](const soak::DayProgress& progress) {
    const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    const double share = progress.virtual_s / progress.all_s;
    std::fprintf(stderr, "%7.2f h of %g h in %.0f s, %.2f us a tick, %.0f s to go\n", progress.virtual_s / 3600.0,
                 hours, took_s, 1e6 * took_s / (progress.virtual_s * params.servo.rate_Hz), took_s / share - took_s);
  });
  std::printf("%g h of virtual time, %lld ticks, %s\n", hours, static_cast<long long>(report.ticks),
              params.control.architecture.c_str());
  std::printf("%-24s %12s %12s %12s %12s %12s\n", "a period of 5 s", "least", "most", "first hour", "last hour",
              "farthest");
  const auto row = [&](const char* name, double scale, double soak::Period::*of) {
    std::printf("%-24s", name);
    for (const auto& period : {report.least, report.most, report.first, report.last, report.farthest_mean}) {
      std::printf(" %12.6f", scale * (period.*of));
    }
    std::printf("\n");
  };
  row("master's peak force, N", 1.0, &soak::Period::peak_master_N);
  row("tip's peak force, N", 1.0, &soak::Period::peak_tip_N);
  row("slave farthest, mm", 1e3, &soak::Period::farthest_m);
  row("slave nearest, mm", 1e3, &soak::Period::nearest_m);
  row("master's motor gave, mJ", 1e3, &soak::Period::master_gave_J);
  row("slave's motor gave, mJ", 1e3, &soak::Period::slave_gave_J);
  std::printf("in all: master's motor gave %.6f J, slave's %.6f J; told energy %.6f J\n", report.master_gave_J,
              report.slave_gave_J, report.told_energy_J);
  std::printf("a monitor's account is wrong by at most %.3g J; heap grew by %lld bytes, resident memory by %lld\n",
              report.account_error_J, static_cast<long long>(report.heap_growth),
              static_cast<long long>(report.resident_growth));
  for (const auto& broken : report.broken) std::printf("BROKEN: %s\n", broken.c_str());
  std::printf(report.passed ? "ended as it began\n" : "DID NOT end as it began\n");
  return report.passed ? 0 : 1;
}
