// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/runtime/servo/rights.hpp>
#include <tactus/runtime/servo/site_loop.hpp>
#include <tactus/simulation/real_time/repeated_taps.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tests/link/pair.hpp>
#include <tests/scratch_path.hpp>

namespace tactus::runtime::site_loop_test {

using control::SiteRole;
using control::SiteState;

constexpr std::int64_t tick_ns = 200'000;
/// Armed at once, the slave stands pressed against the wall at this tick.
constexpr int pressing_tick = 6500;

/// Both sites in one program, over the loopback and in plain text, at a clock of the test's own: as fast as they can.
class Sites : public ::testing::Test {
 protected:
  struct Site {
    SiteExchange exchange;
    std::optional<SiteLog> log;
    std::optional<SiteLoop> loop;
    std::int64_t tick = 0;
    /// Where it stood at the end of the second that ended last.
    SiteSecond second;
    bool more = true;  ///< what its step said last

    void step(std::int64_t now_ns) noexcept {
      more = (*loop)({.number = tick++, .deadline_ns = now_ns, .began_ns = now_ns});
      while (exchange.seconds.try_pop(second)) {
      }
    }
  };

  Sites() { params.control.force_gain = 1.0; }
  ~Sites() override { std::filesystem::remove_all(folder); }

  void open(bool arm_at_once = false) {
    const link::testing::Ports ports;
    const auto make = [&](Site& site, SiteRole role, std::uint16_t own, std::uint16_t other) {
      auto made = SiteLoop::make(params,
                                 {.link = {.site = role,
                                           .peer = link::testing::loopback(other),
                                           .listen = link::testing::loopback(own),
                                           .key = std::nullopt},
                                  .arm_at_once = arm_at_once && role == SiteRole::master},
                                 site.exchange, real_time::simulated_device(params, role).value());
      ASSERT_TRUE(made) << describe(made.error());
      site.loop.emplace(*std::move(made));
      SiteStreams streams = SiteStreams::of_one(role);
      streams.origin_ns = 0;  // the test's clock
      auto log =
          SiteLog::create(folder / name_of(role), streams,
                          {{"tactus", {{"site", name_of(role)}, {"configuration", configuration::to_toml(params)}}},
                           {std::string("device_of_") + name_of(role), in_words(station::DeviceLimits{})}});
      ASSERT_TRUE(log) << describe(log.error());
      site.log.emplace(*std::move(log));
      site.loop->leave_in(streams);
    };
    make(master, SiteRole::master, ports.master, ports.slave);
    make(slave, SiteRole::slave, ports.slave, ports.master);
  }
  /// Ends both and reads a topic of a site's log.
  telemetry::LogTable close(Site& site, SiteRole role, const std::string& topic = "/site") {
    site.loop->finish();
    while (site.exchange.seconds.try_pop(site.second)) {
    }
    EXPECT_FALSE(site.log->close());
    EXPECT_EQ(site.log->dropped(), 0U);
    auto content = telemetry::read_log(folder / name_of(role), topic).value();
    EXPECT_TRUE(content.summary.complete);
    metadata = content.summary.metadata["tactus"];
    return content.tables.at(0);
  }
  static std::vector<double> column(const telemetry::LogTable& table, const std::string& name) {
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      if (table.columns[i].name == name) return table.values[i];
    }
    ADD_FAILURE() << "no column " << name;
    return {};
  }

  /// The streams of the log hold 4096 ticks, and who writes it wants time, the more so under a sanitizer.
  void run(int ticks, bool step_master = true, bool step_slave = true) {
    const FlushedDenormals as_a_servo_thread_does;
    for (int i = 0; i < ticks; ++i) {
      now_ns += tick_ns;
      if (step_master) master.step(now_ns);
      if (step_slave) slave.step(now_ns);
      if (i % 500 == 499) std::this_thread::sleep_for(std::chrono::milliseconds(25));
    }
  }
  /// One second in which this is asked first.
  void ask(Site& site, SiteWord word) {
    site.exchange.words.try_push(word);
    run(5000);
  }
  void expect(SiteState at_master, SiteState at_slave) const {
    EXPECT_STREQ(name_of(master.second.state), name_of(at_master));
    EXPECT_STREQ(name_of(slave.second.state), name_of(at_slave));
  }

  const std::filesystem::path folder = scratch_path();
  experiments::TappingParams params;
  Site master, slave;
  std::int64_t now_ns = 1'000'000'000;
  std::map<std::string, std::string> metadata;
};

}  // namespace tactus::runtime::site_loop_test
