// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/episodes.hpp>
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/kernel/station/joined_devices.hpp>
#include <tactus/runtime/servo/joint_streams.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/runtime/servo/site_log.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <examples/own-device/spring_carriage.hpp>
#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>
#include <tests/sanitizers.hpp>
#include <tests/scratch_path.hpp>

namespace tactus::runtime {
namespace {

using control::SiteRole;
using control::SiteState;

constexpr std::size_t joints = 8;

/// One device of eight carriages, each with a hand or a wall of its own.
std::unique_ptr<station::JoinedDevices> carriages(SiteRole role) {
  std::vector<std::unique_ptr<station::Device>> owned;
  for (std::size_t joint = 0; joint < joints; ++joint) {
    owned.push_back(std::make_unique<SpringCarriage>(role == SiteRole::master, 1e-3));
  }
  return station::JoinedDevices::make(std::move(owned)).value();
}

std::vector<double> column(const telemetry::LogTable& table, const std::string& name) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].name == name) return table.values[i];
  }
  ADD_FAILURE() << "no column " << name;
  return {};
}

/// An instant of CLOCK_MONOTONIC by the wall clock: of several readings the one that nothing held up.
std::int64_t by_wall_clock_ns(std::int64_t monotonic) {
  std::int64_t found_ns = 0, least_ns = 1'000'000'000;
  for (int i = 0; i < 50; ++i) {
    const std::int64_t before_ns = monotonic_ns();
    const auto wall = std::chrono::system_clock::now().time_since_epoch();
    const std::int64_t took_ns = monotonic_ns() - before_ns;
    if (took_ns >= least_ns) continue;
    least_ns = took_ns;
    found_ns = std::chrono::duration_cast<std::chrono::nanoseconds>(wall).count() - (before_ns - monotonic);
  }
  return found_ns;
}

TEST(SeveralJoints, EightRunAtOneKilohertzInRealTimeAndLeaveEveryTickInALog) {
  control::ControlParams of_joint;
  of_joint.force_gain = 1.0;
  of_joint.supervision.overload.missed_share = 0.9;
  of_joint.supervision.longest_stall_s = 1.0;
  of_joint.supervision.watchdog.timeout_s = 1.0;
  const auto master = carriages(SiteRole::master), slave = carriages(SiteRole::slave);
  auto made = station::JointLocalTeleoperator::make(Joints<control::ControlParams>(joints, of_joint), {}, Seconds{1e-3},
                                                    Joints<double>(joints, 0.0), *master, *slave);
  ASSERT_TRUE(made) << describe(made.error());
  station::JointLocalTeleoperator& sites = *made;

  const std::filesystem::path folder = scratch_path();
  std::vector<StreamedJoint> of_rig(joints);
  for (std::size_t joint = 0; joint < joints; ++joint) {
    of_rig[joint] = {.name = "turns_" + std::to_string(joint), .turns = joint % 2 == 1};
  }
  JointStreams streams(of_rig);
  auto log = SiteLog::create(folder, streams, {});
  ASSERT_TRUE(log) << describe(log.error());

  std::int64_t steps = 0;
  std::uint64_t allocations = 0;
  std::int64_t deadline_by_wall_clock_ns = 0;
  const auto report = run_servo({.rate_Hz = 1000.0, .priority = 10}, [&](const station::Tick& tick) noexcept {
    const std::uint64_t before = laws::own_allocation_count();
    const control::SiteRequests pressed{
        .align = steps > 100, .arm = steps > 200, .dead_man = steps > 400 && steps < 2600};
    const auto done = sites.step(tick, pressed);
    streams.push(tick, pressed, sites, done);
    if (steps == 1500) streams.push(tick, EpisodeMark::keep);
    if (steps == 1500) deadline_by_wall_clock_ns = by_wall_clock_ns(tick.deadline_ns);
    allocations += laws::own_allocation_count() - before;
    return ++steps < 3000;
  });
  ASSERT_TRUE(report) << describe(report.error());
  ASSERT_FALSE(log->close());
  EXPECT_EQ(log->dropped(), 0U);
  EXPECT_EQ(allocations, 0U);
  EXPECT_EQ(report->ticks, 3000);
#if !TACTUS_UNDER_ADDRESS_SANITIZER && !TACTUS_UNDER_THREAD_SANITIZER
  EXPECT_LT(report->duration.quantile_ns(0.5), 500'000) << "half of a tick";
#endif

  for (const std::string site : {"/master/", "/slave/"}) {
    const auto ticks = telemetry::read_log(folder, site + "site").value().tables.at(0);
    const auto states = column(ticks, "state");
    EXPECT_EQ(states.size(), 3000U);
    EXPECT_EQ(std::count(states.begin(), states.end(), static_cast<double>(SiteState::fault)), 0);
    EXPECT_GT(std::count(states.begin(), states.end(), static_cast<double>(SiteState::active)), 1000);
    for (std::size_t joint = 1; joint <= joints; ++joint) {
      const auto table = telemetry::read_log(folder, site + "joint_" + std::to_string(joint)).value().tables.at(0);
      EXPECT_EQ(column(table, "tick"), column(ticks, "tick"));
      const bool turns = of_rig[joint - 1].turns;
      EXPECT_EQ(table.about.at("joint"), of_rig[joint - 1].name);
      EXPECT_EQ(table.type_name, turns ? "tactus_msgs/msg/TurningJointRecord" : "tactus_msgs/msg/JointRecord");
      const auto position_m = column(table, turns ? "position_rad" : "position_m");
      const auto [least_m, most_m] = std::minmax_element(position_m.begin(), position_m.end());
      EXPECT_GT(*most_m - *least_m, 0.005) << site << joint << " never moved";
      const auto force_N = column(table, turns ? "motor_torque_N_m" : "motor_force_N");
      EXPECT_GT(std::fabs(*std::min_element(force_N.begin(), force_N.end())), 0.01) << site << joint << " felt nothing";
    }
  }
  // Within a millisecond of the wall clock.
  const auto marked = telemetry::read_log(folder, telemetry::episodes_topic).value();
  ASSERT_EQ(marked.tables.size(), 1U);
  ASSERT_TRUE(marked.start_unix_ns);
  const auto logged_ns = static_cast<std::int64_t>(*marked.start_unix_ns + marked.tables[0].times_ns.at(0));
  EXPECT_NEAR(static_cast<double>(logged_ns - deadline_by_wall_clock_ns), 0.0, 1e6);
  EXPECT_FALSE(telemetry::episodes_of(telemetry::read_log(folder).value()).empty());
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace tactus::runtime
