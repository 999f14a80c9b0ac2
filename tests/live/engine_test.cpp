// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/contact_judge.hpp>
#include <tactus/simulation/experiments/contact_metrics.hpp>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "sample_view.hpp"
#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>
#include <tests/scratch_path.hpp>

namespace tactus::live {
namespace {

/// Steps the loops and takes every tick of one.
std::vector<LoopTick> run(Engine& engine, std::size_t loop, double duration_s) {
  std::vector<LoopTick> all;
  auto ticks = engine.watch();
  EngineTick tick;
  for (auto i = std::lround(duration_s / engine.tick_s()); i > 0; --i) {
    engine.step();
    while (ticks.next(tick)) {
      if (tick.ran[loop]) all.push_back(tick.loop[loop]);
    }
  }
  return all;
}

bool are_equal(const Engine::Record& one, const Engine::Record& other) {
  return one.master_position_m == other.master_position_m && one.induced_position_m == other.induced_position_m &&
         one.command_m == other.command_m && one.slave_position_m == other.slave_position_m &&
         one.tip_position_m == other.tip_position_m && one.displayed_force_N == other.displayed_force_N &&
         one.hand_force_N == other.hand_force_N && one.contact_force_N == other.contact_force_N &&
         one.touched == other.touched;
}

/// A scripted tap of one loop, from the command on.
std::vector<LoopTick> tap(LiveView& view, std::size_t loop, double duration_s) {
  EXPECT_FALSE(publish(view, "/operator/command", R"({"command":"tap"})"));
  return run(view.engine(), loop, duration_s);
}

TEST(Engine, AScriptedTapIsBitForBitThatOfATeleoperatorOnTheSamePath) {
  const auto view = sample_view();
  run(view->engine(), 0, 0.1);
  const ScriptedTap script{.wall_m = Settings::wall_m};
  for (std::size_t loop = 0; loop < loops; ++loop) {
    const std::vector<LoopTick> ticks = tap(*view, loop, 0.8);
    auto alone = simulation::Teleoperator::make(sample_params(loop), script.start_m()).value();
    const double loop_tick_s = alone.tick_s();
    bool touched = false;
    double time_s = 0.0;
    for (const LoopTick& tick : ticks) {
      const auto record = alone.step(script.position_m(time_s), script.position_m(time_s + loop_tick_s));
      ASSERT_TRUE(are_equal(tick.record, record)) << loop << " at " << record.time_s;
      touched = touched || record.touched;
      time_s += loop_tick_s;
    }
    EXPECT_TRUE(touched);
  }
}

TEST(Engine, AtGainTenATapRingsWithoutCancellationAndSettlesWithIt) {
  const auto view = sample_view();
  for (std::size_t loop = 0; loop < loops; ++loop) {
    ContactJudge judge = ContactJudge::make(Seconds{view->engine().tick_s()}).value();
    std::vector<double> force_N;
    std::optional<std::size_t> begin;
    for (const LoopTick& tick : tap(*view, loop, 0.8)) {
      judge.step(tick.record.contact_force_N, tick.record.touched);
      if (judge.has_begun()) begin = force_N.size();
      force_N.push_back(tick.record.contact_force_N);
    }
    ASSERT_TRUE(begin.has_value());
    const auto metrics = experiments::judge_contact(force_N, *begin, view->engine().tick_s());
    EXPECT_EQ(metrics.settled && metrics.settling_time_s < 0.1, loop == 0) << metrics.settling_time_s;
    EXPECT_EQ(judge.verdict(), loop == 0 ? LiveVerdict::settled : LiveVerdict::rings) << judge.cause();
  }
}

TEST(Engine, AViewThatIsStuckLosesTicksAndTheLoopIsAsItWas) {
  const auto watched = sample_view();
  const auto stuck = sample_view();
  EXPECT_FALSE(publish(*watched, "/operator/command", R"({"command":"tap"})"));
  EXPECT_FALSE(publish(*stuck, "/operator/command", R"({"command":"tap"})"));
  std::uint64_t shown = 0;
  // Until a call shows nothing more: one shows so many ticks at the most.
  const auto collect = [&shown](LiveView& view) {
    for (std::uint64_t before = shown + 1; before != shown;) {
      before = shown;
      view.collect([](std::size_t topic) { return topic == 3; },
                   [&shown](std::size_t topic, std::uint64_t, const Payload&) { shown += topic == 3 ? 1 : 0; });
    }
  };
  collect(*stuck);
  run(watched->engine(), 0, 1.0);
  for (int i = 0; i < 5000; ++i) stuck->engine().step();
  collect(*stuck);
  EXPECT_EQ(stuck->lost_ticks(), 5000U - 4096U);
  EXPECT_EQ(shown, 4096U);
  const auto one = run(watched->engine(), 0, 0.1);
  const auto other = run(stuck->engine(), 0, 0.1);
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_TRUE(are_equal(one[i].record, other[i].record));
}

TEST(Engine, ALogThatIsStuckLosesTicksCountsThemAndThePageSeesAllOfThem) {
  const auto file = scratch_path().concat(".mcap");
  const auto view = sample_view();
  auto log = telemetry::Recorder::create(file).value();
  view->engine().log_to(log);
  EXPECT_EQ(run(view->engine(), 0, 1.0).size(), 5000U);
  log.start();
  EXPECT_FALSE(log.stop());
  EXPECT_EQ(log.dropped(), (std::vector<std::uint64_t>{5000 - 4096, 5000 - 4096}));
  EXPECT_EQ(log.log().counts()[0].written, 4096U);
  EXPECT_EQ(log.log().counts()[1].written, 4096U);
  std::filesystem::remove(file);
}

TEST(Engine, ATickAllocatesNothingNotEvenOneThatTakesAChange) {
  const auto view = sample_view();
  run(view->engine(), 0, 0.01);
  EXPECT_FALSE(publish(*view, "/operator/hand", R"({"position_m":0.01,"engaged":true})"));
  EXPECT_TRUE(view->set_parameters({{"control.force_gain", 5.0}, {"operator.grip", 2.0}}).empty());
  EXPECT_TRUE(view->set_parameters({{"right.method", std::string("wave-variables")}}).empty());
  EXPECT_FALSE(publish(*view, "/operator/command", R"({"command":"reset"})"));
  const std::uint64_t before = laws::allocation_count();
  for (int i = 0; i < 100; ++i) view->engine().step();
  EXPECT_EQ(laws::allocation_count(), before);
}

TEST(Engine, TheGainChangesUnderAPressingHandWithoutABumpInTheCommand) {
  const auto view = sample_view();
  EXPECT_FALSE(publish(*view, "/operator/hand", R"({"position_m":0.02,"engaged":true})"));
  const auto before = run(view->engine(), 0, 2.0);
  ASSERT_GT(before.back().record.displayed_force_N, 0.5) << "the hand presses";
  ASSERT_GT(std::fabs(before.back().record.induced_position_m), 2e-4) << "there is something to lose";
  EXPECT_TRUE(view->set_parameters({{"control.force_gain", 9.0}}).empty());
  auto after = run(view->engine(), 0, 0.2);
  double farthest_m = 0.0;
  for (const LoopTick& tick : after) {
    farthest_m = std::max(farthest_m, std::fabs(tick.record.command_m - before.back().record.command_m));
  }
  EXPECT_LT(farthest_m, 0.2 * std::fabs(before.back().record.induced_position_m));
}

TEST(Engine, AStifferWallAndALongerDelayHoldFromTheNextTick) {
  const auto view = sample_view();
  EXPECT_FALSE(publish(*view, "/operator/hand", R"({"position_m":0.02,"engaged":true})"));
  run(view->engine(), 0, 1.0);
  const auto depth_m = [&] {
    const LoopTick tick = run(view->engine(), 0, 0.5).back();
    return tick.record.tip_position_m - Settings::wall_m;
  };
  const double soft_m = depth_m();
  EXPECT_TRUE(view->set_parameters({{"environment.stiffness_N_per_m", 1000.0}}).empty());
  EXPECT_GT(depth_m(), 10.0 * soft_m) << "40 times softer: the tip sinks in";
  EXPECT_TRUE(view->set_parameters({{"channel.delay_s", 0.1}}).empty());
  EXPECT_FALSE(publish(*view, "/operator/hand", R"({"position_m":-0.02,"engaged":true})"));
  const auto ticks = run(view->engine(), 0, 0.5);
  const auto moved = [&](auto&& position) {
    std::size_t i = 0;
    while (i < ticks.size() && std::fabs(position(ticks[i].record) - position(ticks[0].record)) < 0.002) ++i;
    return static_cast<double>(i) * view->engine().tick_s();
  };
  const double master_s = moved([](const Engine::Record& record) { return record.master_position_m; });
  const double slave_s = moved([](const Engine::Record& record) { return record.slave_position_m; });
  EXPECT_GT(slave_s - master_s, 0.08);
}

TEST(Engine, EveryMethodOfTheContestCanBeServed) {
  Settings settings = sample_settings();
  for (const ParameterDescription& description : settings.descriptions()) {
    if (description.name != "left.method") continue;
    EXPECT_GT(description.choices.size(), 20U);
    for (const std::string& choice : description.choices) {
      ASSERT_FALSE(settings.set({"left.method", choice}));
      const auto params = settings.of_loop(0);
      ASSERT_TRUE(params) << choice << ": " << describe(params.error());
      const auto made = make_loop(*params, 0.0);
      EXPECT_TRUE(made) << choice << ": " << describe(made.error());
    }
  }
}

}  // namespace
}  // namespace tactus::live
