// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/real_time/real_time_tap.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::real_time {
namespace {

using experiments::TappingEnsemble;
using experiments::TappingParams;
using Record = simulation::Teleoperator::Record;

/// The tapping experiment of the repository in short: a firm tap on a stiff wall, with noise, tremor and cancellation.
TappingParams short_taps(double force_gain) {
  TappingParams params;
  params.task.supervised = false;
  params.task.taps = 2;
  params.task.observation_s = 0.15;
  params.task.slowest_m_per_s = 0.07;
  params.control.force_gain = force_gain;
  params.control.force_limit_N = 1.0;
  params.slave.force_sensor.noise_rms_N = 0.002;
  return params;
}

/// A tick at its deadline, as a clock that is never late gives it.
station::Tick tick(std::int64_t number, std::int64_t missed = 0) {
  const std::int64_t deadline_ns = 200'000 * number;
  return {.number = number, .missed = missed, .deadline_ns = deadline_ns, .began_ns = deadline_ns};
}

/// Member by member: there may be holes between them.
std::vector<std::uint64_t> bits(const Record& record) {
  std::vector<std::uint64_t> all;
  for_each_signal<Record>([&](const auto& signal) {
    if constexpr (sizeof(record.*signal.member) == sizeof(std::uint64_t)) {
      all.push_back(std::bit_cast<std::uint64_t>(record.*signal.member));
    } else {
      all.push_back(record.*signal.member ? 1 : 0);
    }
  });
  return all;
}

TEST(RealTimeTap, WithoutAMissedTickItIsBitForBitTheTapInVirtualTime) {
  for (const double gain : {1.0, 10.0}) {
    const auto ensemble = TappingEnsemble::make(short_taps(gain));
    ASSERT_TRUE(ensemble);
    for (std::size_t tap = 0; tap < ensemble->size(); ++tap) {
      std::vector<Record> virtual_time;
      const auto expected = ensemble->run(tap, &virtual_time);
      auto real_time = RealTimeTap::make(ensemble->tap(tap), 0.15);
      ASSERT_TRUE(real_time);
      // The thread would count from anywhere.
      for (std::int64_t number = 17; (*real_time)->step(tick(number)); ++number) {
      }
      const auto& trace = (*real_time)->trace();
      ASSERT_EQ(trace.size(), virtual_time.size());
      for (std::size_t i = 0; i < trace.size(); ++i) ASSERT_EQ(bits(trace[i]), bits(virtual_time[i])) << "tick " << i;
      const auto result = (*real_time)->result();
      EXPECT_TRUE(result.touched);
      EXPECT_EQ(result.metrics.settling_time_s, expected.metrics.settling_time_s);
      EXPECT_EQ(result.metrics.peak_force_N, expected.metrics.peak_force_N);
      EXPECT_EQ(result.metrics.contacts, expected.metrics.contacts);
    }
  }
}

TEST(RealTimeTap, WhileTicksAreMissedThePlantsGoOnUnderTheCommandThatHolds) {
  const auto ensemble = TappingEnsemble::make(short_taps(1.0));
  ASSERT_TRUE(ensemble);
  std::vector<Record> virtual_time;
  (void)ensemble->run(0, &virtual_time);
  auto tap = RealTimeTap::make(ensemble->tap(0), 0.15);
  ASSERT_TRUE(tap);
  constexpr std::int64_t before = 500;
  constexpr std::int64_t missed = 25;
  for (std::int64_t number = 0; number < before; ++number) ASSERT_TRUE((*tap)->step(tick(number)));
  ASSERT_TRUE((*tap)->step(tick(before + missed, missed)));
  const auto& trace = (*tap)->trace();
  ASSERT_EQ(trace.size(), static_cast<std::size_t>(before + missed));
  for (std::int64_t i = 0; i < before; ++i) {
    ASSERT_EQ(bits(trace[static_cast<std::size_t>(i)]), bits(virtual_time[static_cast<std::size_t>(i)]));
  }
  const Record& last = trace[before - 1];
  for (std::size_t i = before; i < trace.size(); ++i) {
    EXPECT_DOUBLE_EQ(trace[i].time_s, 200e-6 * static_cast<double>(i));
    EXPECT_EQ(trace[i].displayed_force_N, last.displayed_force_N) << "no site has stepped";
    EXPECT_EQ(trace[i].master_position_m, last.master_position_m) << "no sensor was read";
  }
  EXPECT_NE(trace.back().tip_position_m, last.tip_position_m) << "the slave stood still";
}

TEST(RealTimeTap, OnAServoThreadItRunsToItsEndAndIsLoggedToTheLastTick) {
  const auto ensemble = TappingEnsemble::make(short_taps(1.0));
  ASSERT_TRUE(ensemble);
  const auto file = scratch_path().concat(".mcap");
  std::vector<Record> trace;
  runtime::ServoReport report;
  {
    auto recorder = telemetry::Recorder::create(file);
    ASSERT_TRUE(recorder);
    runtime::RealTimeStreams streams{
        .teleoperator = &recorder->add<Record>("/teleoperator", "tactus_msgs/msg/TeleoperatorRecord"),
        .servo = &recorder->add<runtime::ServoRecord>("/servo", "tactus_msgs/msg/ServoRecord"),
        .origin_ns = runtime::monotonic_ns()};
    recorder->start();
    auto tap = RealTimeTap::make(ensemble->tap(0), 0.15, streams);
    ASSERT_TRUE(tap);
    RealTimeTap& running = **tap;
    const auto ran = runtime::run_servo({.rate_Hz = 5000.0, .priority = 10},
                                        [&running](const station::Tick& now) noexcept { return running.step(now); });
    ASSERT_TRUE(ran);
    report = *ran;
    trace = running.trace();
    ASSERT_FALSE(recorder->stop());
    EXPECT_EQ(recorder->dropped(), (std::vector<std::uint64_t>{0, 0}));
  }
  const auto log = telemetry::read_log(file);
  std::filesystem::remove(file);
  ASSERT_TRUE(log);
  ASSERT_EQ(log->tables.size(), 2U);
  EXPECT_EQ(log->tables[0].times_ns.size(), trace.size());
  // The last step of the thread finds the tap over and has no record.
  EXPECT_EQ(log->tables[1].times_ns.size(), static_cast<std::size_t>(report.ticks - 1));
  std::vector<Record> virtual_time;
  (void)ensemble->run(0, &virtual_time);
  const std::vector<double>& missed = log->tables[1].values[1];
  const auto agreed = static_cast<std::size_t>(
      std::find_if(missed.begin() + 1, missed.end(), [](double n) { return n > 0.0; }) - missed.begin());
  ASSERT_LE(agreed, std::min(trace.size(), virtual_time.size()));
  for (std::size_t i = 0; i + 1 < agreed; ++i) {
    ASSERT_EQ(bits(trace[i]), bits(virtual_time[i])) << "tick " << i << ", denormals flushed and none missed";
  }
  for (std::size_t i = 1; i < log->tables[0].times_ns.size(); ++i) {
    ASSERT_NEAR(static_cast<double>(log->tables[0].times_ns[i] - log->tables[0].times_ns[i - 1]), 200'000.0, 1.0);
  }
}

/// Passes everything on and remembers what was commanded.
class WatchedDevice final : public station::Device {
 public:
  explicit WatchedDevice(station::Device& device) : device_(&device) {}
  [[nodiscard]] station::DeviceLimits limits() const override { return device_->limits(); }
  [[nodiscard]] bool simulated() const noexcept override { return device_->simulated(); }
  station::DeviceReading read(const station::Tick& now) noexcept override { return device_->read(now); }
  void write(const station::DeviceCommand& given) noexcept override {
    commands_N.push_back(given.force_N);
    device_->write(given);
  }
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return device_->health(); }

  std::vector<double> commands_N;

 private:
  station::Device* device_;
};

class WatchedPlant final : public TapPlant {
 public:
  explicit WatchedPlant(const experiments::Tap& tap)
      : plant_(SimulatedPlant::make(tap).value()), master_(plant_.master()), slave_(plant_.slave()) {}
  WatchedDevice& master() noexcept override { return master_; }
  WatchedDevice& slave() noexcept override { return slave_; }
  std::optional<SimulatedTruth> next(const station::Tick& now) noexcept override { return plant_.next(now); }
  [[nodiscard]] double tip_position_m() const noexcept override { return plant_.tip_position_m(); }
  [[nodiscard]] bool lost() const noexcept override { return false; }

 private:
  SimulatedPlant plant_;
  WatchedDevice master_;
  WatchedDevice slave_;
};

/// From the tick `over` on the force falls by no more than `largest_step_N` a tick, to nothing.
void expect_ramp(const std::vector<double>& commands_N, std::size_t over, double largest_step_N) {
  ASSERT_GT(commands_N.size(), over + 2) << "it was let go at once";
  EXPECT_GT(std::fabs(commands_N[over - 1]), 3.0 * largest_step_N) << "there was nothing to let go";
  for (std::size_t i = over; i < commands_N.size(); ++i) {
    EXPECT_LE(std::fabs(commands_N[i] - commands_N[i - 1]), largest_step_N * (1.0 + 1e-9)) << "tick " << i;
    EXPECT_LE(std::fabs(commands_N[i]), std::fabs(commands_N[i - 1])) << "tick " << i;
  }
  EXPECT_EQ(commands_N.back(), 0.0);
}

TappingParams taps_with_tight_gates() {
  TappingParams params = short_taps(1.0);
  params.control.gate.rate_limit_N_per_s = params.control.slave_gate.rate_limit_N_per_s = 50.0;
  return params;
}
constexpr double tight_step_N = 50.0 * 200e-6;

TEST(RealTimeTap, AtItsEndTheForcesFallAtTheRateLimitAndTheTapHasNoTickMore) {
  const auto ensemble = TappingEnsemble::make(taps_with_tight_gates());
  ASSERT_TRUE(ensemble);
  std::vector<Record> virtual_time;
  (void)ensemble->run(0, &virtual_time);
  WatchedPlant plant(ensemble->tap(0));
  auto tap = RealTimeTap::make(ensemble->tap(0), 0.15, plant);
  ASSERT_TRUE(tap);
  for (std::int64_t number = 0; (*tap)->step(tick(number)); ++number) {
  }
  const auto& trace = (*tap)->trace();
  ASSERT_EQ(trace.size(), virtual_time.size());
  for (std::size_t i = 0; i < trace.size(); ++i) ASSERT_EQ(bits(trace[i]), bits(virtual_time[i])) << "tick " << i;
  // The slave presses on the wall to the end.
  expect_ramp(plant.slave().commands_N, trace.size(), tight_step_N);
  expect_ramp(plant.master().commands_N, trace.size(), tight_step_N);
}

TEST(RealTimeTap, EndedFromOutsideItLetsGoTheSameWay) {
  const auto ensemble = TappingEnsemble::make(taps_with_tight_gates());
  ASSERT_TRUE(ensemble);
  std::vector<Record> virtual_time;
  const auto whole = ensemble->run(0, &virtual_time);
  ASSERT_TRUE(whole.touched);
  WatchedPlant plant(ensemble->tap(0));
  auto tap = RealTimeTap::make(ensemble->tap(0), 0.15, plant);
  ASSERT_TRUE(tap);
  // Well into the contact.
  const auto pressing = static_cast<std::size_t>((whole.first_touch_s + 0.1) / 200e-6);
  bool more = true;
  for (std::int64_t number = 0; more; ++number) {
    if (number == static_cast<std::int64_t>(pressing)) (*tap)->end();
    more = (*tap)->step(tick(number));
  }
  EXPECT_LT((*tap)->trace().size(), virtual_time.size());
  expect_ramp(plant.slave().commands_N, pressing, tight_step_N);
}

}  // namespace
}  // namespace tactus::real_time
