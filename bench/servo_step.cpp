// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/real_time/real_time_tap.hpp>

#include <filesystem>
#include <system_error>

#include <bench/sections.hpp>
#include <unistd.h>

namespace tactus::bench {

namespace {

/// One tap in real time.
runtime::ServoReport run_tap(const experiments::TappingEnsemble& ensemble, std::size_t tap,
                             const runtime::RealTimeStreams& streams) {
  auto made = real_time::RealTimeTap::make(ensemble.tap(tap), 0.35, streams);
  if (!made) return {};
  real_time::RealTimeTap& running = **made;
  auto report = runtime::run_servo({.rate_Hz = ensemble.tap(tap).params.servo.rate_Hz},
                                   [&running](const station::Tick& tick) noexcept { return running.step(tick); });
  return report ? *report : runtime::ServoReport{};
}

}  // namespace

Findings servo_step(bool quick) {
  experiments::TappingParams params;
  params.task.supervised = false;
  params.task.taps = quick ? 3 : 12;
  const auto ensemble = experiments::TappingEnsemble::make(params);
  const auto file = std::filesystem::temp_directory_path() / ("bench_servo_" + std::to_string(getpid()) + ".mcap");
  auto recorder = telemetry::Recorder::create(file);
  if (!ensemble || !recorder) return {};
  const runtime::RealTimeStreams streams{
      .teleoperator =
          &recorder->add<simulation::Teleoperator::Record>("/teleoperator", "tactus_msgs/msg/TeleoperatorRecord"),
      .servo = &recorder->add<runtime::ServoRecord>("/servo", "tactus_msgs/msg/ServoRecord"),
      .origin_ns = runtime::monotonic_ns()};
  recorder->start();
  runtime::ServoReport with;
  runtime::ServoReport without;
  for (std::size_t tap = 0; tap < ensemble->size(); ++tap) {
    without.add(run_tap(*ensemble, tap, {}));
    with.add(run_tap(*ensemble, tap, streams));
  }
  const Check lost = recorder->stop();
  std::error_code ignored;
  std::filesystem::remove(file, ignored);

  using Goal = Finding::Goal;
  const std::string section = "The servo thread: both sites, simulated devices and log, at 5 kHz";
  const auto ratio = [&](double q) { return with.duration.quantile_ns(q) / without.duration.quantile_ns(q); };
  return {{section, "median step without log", 1e-3 * without.duration.quantile_ns(0.5), "us"},
          {section, "median step, with log over without", ratio(0.5), "", Goal::at_most, 1.05},
          {section, "p99 of the step, with log over without", ratio(0.99), ""},
          {section, "records that the log lost", lost ? 1.0 : static_cast<double>(recorder->dropped()[0]), "",
           Goal::at_most, 0.0},
          {section, "late ticks of our own making", static_cast<double>(with.late_ours() + without.late_ours()), "",
           Goal::at_most, 0.0},
          {section, "late ticks of the machine's making",
           static_cast<double>(with.late_machine() + without.late_machine()), ""}};
}

}  // namespace tactus::bench
