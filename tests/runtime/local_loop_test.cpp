// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/runtime/servo/local_loop.hpp>
#include <tactus/runtime/servo/rights.hpp>
#include <tactus/simulation/real_time/repeated_taps.hpp>
#include <tactus/simulation/real_time/replay.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>
#include <tests/scratch_path.hpp>

namespace tactus::runtime {
namespace local_loop_test {

using control::SiteCause;
using control::SiteRole;
using control::SiteState;

constexpr std::int64_t tick_ns = 200'000;

/// Both sites of the experiment's simulated devices, at a clock of the test's own.
class LocalSites : public ::testing::Test {
 protected:
  LocalSites() { params.control.force_gain = 1.0; }
  ~LocalSites() override { std::filesystem::remove_all(folder); }

  void open(const LocalLoop::Settings& settings = {}) {
    auto made =
        LocalLoop::make(params, settings, exchange, real_time::simulated_device(params, SiteRole::master).value(),
                        real_time::simulated_device(params, SiteRole::slave).value());
    ASSERT_TRUE(made) << describe(made.error());
    loop.emplace(*std::move(made));
    SiteStreams streams = SiteStreams::of_both();
    streams.origin_ns = 0;
    auto opened = SiteLog::create(folder, streams, {{"tactus", {{"configuration", configuration::to_toml(params)}}}});
    ASSERT_TRUE(opened) << describe(opened.error());
    log.emplace(*std::move(opened));
    loop->leave_in(streams);
  }
  /// The streams of the log hold 4096 ticks, and who writes it wants time, the more so under a sanitizer.
  void run(int ticks) {
    const FlushedDenormals as_a_servo_thread_does;
    for (int i = 0; i < ticks && more; ++i) {
      now_ns += tick_ns;
      more = (*loop)({.number = tick++, .deadline_ns = now_ns, .began_ns = now_ns});
      SiteSecond second;
      while (exchange.seconds.try_pop(second)) seconds[static_cast<std::size_t>(second.role)] = second;
      if (i % 500 == 499) std::this_thread::sleep_for(std::chrono::milliseconds(25));
    }
  }
  void ask(SiteWord word) {
    exchange.words.try_push(word);
    run(5000);
  }
  void expect(SiteState at_master, SiteState at_slave) const {
    EXPECT_STREQ(name_of(seconds[0].state), name_of(at_master));
    EXPECT_STREQ(name_of(seconds[1].state), name_of(at_slave));
  }
  std::vector<double> column(const std::string& topic, const std::string& name) const {
    const auto content = telemetry::read_log(folder, topic).value();
    const telemetry::LogTable& table = content.tables.at(0);
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      if (table.columns[i].name == name) return table.values[i];
    }
    ADD_FAILURE() << "no column " << name;
    return {};
  }

  const std::filesystem::path folder = scratch_path();
  experiments::TappingParams params;
  SiteExchange exchange;
  std::optional<SiteLog> log;
  std::optional<LocalLoop> loop;
  std::array<SiteSecond, 2> seconds;
  std::int64_t tick = 0;
  std::int64_t now_ns = 1'000'000'000;
  bool more = true;
};

TEST_F(LocalSites, DoNothingUntilAPersonArmsThemAndStopAtTheWords) {
  open();
  run(5005);
  expect(SiteState::align, SiteState::align);
  EXPECT_EQ(seconds[0].peak_force_N, 0.0);
  ask(SiteWord::arm);
  expect(SiteState::active, SiteState::active);
  EXPECT_GT(seconds[1].peak_force_N, 0.01) << "the slave follows the taps";
  ask(SiteWord::release);
  expect(SiteState::armed, SiteState::armed);
  EXPECT_EQ(seconds[0].cause, SiteCause::dead_man);
  ask(SiteWord::press);
  expect(SiteState::active, SiteState::active);
  ask(SiteWord::stop);
  expect(SiteState::fault, SiteState::fault);
  ask(SiteWord::clear);
  expect(SiteState::align, SiteState::align);
  EXPECT_EQ(loop->totals(SiteRole::master).armings, 1);
  EXPECT_EQ(loop->totals(SiteRole::slave).steps_above_limit, 0);
}

TEST_F(LocalSites, WithoutThePersonBothStandAtTheNextTick) {
  open({.arm_at_once = true});
  run(5005);
  expect(SiteState::active, SiteState::active);
  exchange.person_lost = true;
  run(5000);
  expect(SiteState::armed, SiteState::armed);
}

TEST_F(LocalSites, EndWithoutForceThatFallsAtTheRateLimitAndLeaveEveryTickInTheLog) {
  constexpr double rate_limit_N_per_s = 500.0;
  params.control.gate.rate_limit_N_per_s = params.control.slave_gate.rate_limit_N_per_s = rate_limit_N_per_s;
  open({.arm_at_once = true});
  run(6500);
  exchange.end.ask();
  run(2500);
  EXPECT_FALSE(more);
  EXPECT_LT(tick, 6500 + 750) << "it took more than 0.15 s";
  loop->finish();
  ASSERT_FALSE(log->close());
  EXPECT_EQ(log->dropped(), 0U);
  for (const char* site : {"/master/site", "/slave/site"}) {
    const auto force_N = column(site, "motor_force_N"), state = column(site, "state"), number = column(site, "tick");
    ASSERT_EQ(force_N.size(), static_cast<std::size_t>(tick));
    EXPECT_EQ(number.back(), static_cast<double>(tick - 1));
    EXPECT_EQ(state.back(), static_cast<double>(SiteState::configure));
    EXPECT_EQ(force_N.back(), 0.0);
    double largest_step_N = 0.0, peak_N = 0.0;
    for (std::size_t i = 6500; i < force_N.size(); ++i) {
      largest_step_N = std::max(largest_step_N, std::fabs(force_N[i] - force_N[i - 1]));
      peak_N = std::max(peak_N, std::fabs(force_N[i]));
    }
    EXPECT_GT(peak_N, 0.05) << site << ": there was nothing to lose";
    EXPECT_LE(largest_step_N, rate_limit_N_per_s * 200e-6 * (1.0 + 1e-9)) << site;
  }
  // What the one told is what the other heard, in the same tick or at the next.
  const auto told = column("/master/site", "sent_position_m"), heard = column("/slave/site", "received_position_m");
  EXPECT_EQ(told[6000], heard[6000]);
  EXPECT_EQ(column("/servo", "tick").size(), static_cast<std::size_t>(tick));
}

TEST_F(LocalSites, ReplayBitForBitFromTheirLog) {
  params.channel.to_slave = {.delay_s = 0.002, .jitter_s = 0.001, .loss_fraction = 0.1};
  open({.arm_at_once = true});
  run(6000);
  for (const SiteWord word : {SiteWord::release, SiteWord::arm, SiteWord::stop, SiteWord::clear}) {
    exchange.words.try_push(word);
    run(800);
  }
  exchange.end.ask();
  run(1000);
  loop->finish();
  ASSERT_FALSE(log->close());
  const auto replayed = real_time::replay(folder);
  ASSERT_TRUE(replayed) << describe(replayed.error());
  EXPECT_EQ(replayed->of, "both sites");
  EXPECT_EQ(replayed->ticks, tick);
  EXPECT_FALSE(replayed->difference) << replayed->difference->topic << " " << replayed->difference->signal << " at "
                                     << replayed->difference->tick;
}

TEST_F(LocalSites, EndByTheirDuration) {
  open({.duration_s = 0.5, .arm_at_once = true});
  run(5000);
  EXPECT_FALSE(more);
  // What is left of the force then goes within the time that a force takes to go.
  const double ran_s = static_cast<double>(tick) * 200e-6;
  EXPECT_GE(ran_s, 0.5);
  EXPECT_LE(ran_s, 0.5 + params.control.supervision.blend_s + 2.0 * 200e-6);
}

TEST_F(LocalSites, ATickWithItsLogDoesNotAllocate) {
  open({.arm_at_once = true});
  run(5005);
  const std::uint64_t before = laws::own_allocation_count();
  run(3000);
  EXPECT_EQ(laws::own_allocation_count(), before);
}

/// A device that is not simulated, at rest.
class Hardware final : public station::Device {
 public:
  explicit Hardware(const station::DeviceLimits& limits) : limits_(limits) {}
  [[nodiscard]] station::DeviceLimits limits() const override { return limits_; }
  station::DeviceReading read(const station::Tick&) noexcept override { return {}; }
  void write(const station::DeviceCommand&) noexcept override {}
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return station::DeviceHealth::good; }

 private:
  station::DeviceLimits limits_;
};

TEST_F(LocalSites, HardwareIsRefusedWithoutLimitsThatSomebodyChose) {
  const auto with = [this](const station::DeviceLimits& limits) {
    SiteDevice master{.device = std::make_unique<Hardware>(limits), .person = nullptr};
    return LocalLoop::make(params, {}, exchange, std::move(master),
                           real_time::simulated_device(params, SiteRole::slave).value());
  };
  const auto without_rate = with({.force_N = 2.0, .velocity_m_per_s = 1.0, .position_m = 0.1});
  ASSERT_FALSE(without_rate);
  EXPECT_EQ(without_rate.error().parameter, "master.rate_N_per_s");
  const auto with_default_gates =
      with({.force_N = 2.0, .rate_N_per_s = 1000.0, .velocity_m_per_s = 1.0, .position_m = 0.1});
  ASSERT_FALSE(with_default_gates);
  EXPECT_NE(describe(with_default_gates.error()).find("control.gate"), std::string::npos)
      << describe(with_default_gates.error());
}

}  // namespace local_loop_test
}  // namespace tactus::runtime
