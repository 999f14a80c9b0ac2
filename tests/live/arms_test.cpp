// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/live/arm_loop.hpp>
#include <tactus/interfaces/live/live_view.hpp>
#include <tactus/kernel/arm/chain.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sample_view.hpp"
#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tests/allocation_counter.hpp>

/// Two pairs of arms under the visitor's hand.
namespace tactus::live::arms_test {

Settings arm_settings() {
  auto document =
      configuration::Document::load(std::filesystem::path(TACTUS_EXPERIMENT_FOLDER) / "arm-tapping.toml").value();
  EXPECT_FALSE(document.set("control.force_gain=8"));
  return Settings::make(document).value();
}

TEST(LiveArms, OfAHandleThatLeadsTheToolAreRefusedByTheirKey) {
  const std::filesystem::path folder = TACTUS_EXPERIMENT_FOLDER;
  auto document = configuration::Document::load(folder / "arm-tapping.toml").value();
  ASSERT_FALSE(document.merge(*configuration::Document::load(folder / "arms/inverse3-arm.toml")));
  EXPECT_EQ(Settings::make(document).error().parameter, "control.follower.coupling");
}

std::unique_ptr<LiveView> arm_view() {
  return LiveView::make(arm_settings(), {.allow_tuning = true, .experiment = "arms"}).value();
}

/// The newest tick after so long.
EngineTick run(Engine& engine, double duration_s) {
  auto ticks = engine.watch();
  EngineTick tick;
  for (auto i = std::lround(duration_s / engine.tick_s()); i > 0; --i) engine.step();
  while (ticks.next(tick)) {
  }
  return tick;
}

TEST(LiveArms, TheSameTapSettlesWithCancellationAndRingsWithout) {
  const auto view = arm_view();
  Engine& engine = view->engine();
  const ContactJudge made = ContactJudge::make(Seconds{engine.tick_s()}).value();
  std::array<ContactJudge, loops> judges{made, made};
  std::array<bool, loops> rang{}, settled{};
  ASSERT_FALSE(publish(*view, "/operator/command", R"({"command":"tap"})"));
  for (int i = 0; i < 1400; ++i) {
    engine.step();
    for (std::size_t loop = 0; loop < loops; ++loop) {
      judges[loop].step(engine.newest(loop).contact_force_N, engine.newest(loop).touched);
      rang[loop] = rang[loop] || judges[loop].verdict() == LiveVerdict::rings;
      settled[loop] = settled[loop] || judges[loop].verdict() == LiveVerdict::settled;
    }
  }
  EXPECT_TRUE(settled[0] && !rang[0]);
  EXPECT_TRUE(rang[1]);
}

TEST(LiveArms, AnArmThatIsToldCanBePutTogetherAgain) {
  const Settings settings = arm_settings();
  const auto told = nlohmann::json::parse(arms_as_json(*settings.arms()));
  const auto view = arm_view();
  EXPECT_EQ(view->metadata().at("tactus.arms"), told.dump());
  const EngineTick tick = run(view->engine(), 0.1);
  const ArmsTick& arms = tick.loop[0].arms;
  ASSERT_EQ(arms.joints, 7U);
  arm::Vector3 at = arm::Vector3::Zero();
  arm::Matrix3 turned = arm::Matrix3::Identity();
  const auto vector = [](const nlohmann::json& from) {
    return arm::Vector3(from[0].get<double>(), from[1].get<double>(), from[2].get<double>());
  };
  for (std::size_t i = 0; i < arms.joints; ++i) {
    const auto& joint = told["leader"]["joints"][i];
    at += turned * vector(joint["origin_m"]);
    arm::Matrix3 mounted;
    for (std::size_t entry = 0; entry < 9; ++entry) {
      mounted(static_cast<int>(entry / 3), static_cast<int>(entry % 3)) = joint["rotation"][entry].get<double>();
    }
    turned = turned * mounted *
             Eigen::AngleAxisd(static_cast<double>(arms.leader_rad[i]), vector(joint["axis"]).normalized()).matrix();
  }
  at += turned * vector(told["leader"]["tool_m"]);
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(at[i], static_cast<double>(arms.hand_m[static_cast<std::size_t>(i)]), 2e-3)
        << "at rest the tool is where the hand wants it";
  }
  EXPECT_EQ(told["directions"][0], nlohmann::json({0.0, 0.0, -1.0})) << "the wall lies below";
}

TEST(LiveArms, AHandMovesAcrossToo) {
  const auto view = arm_view();
  const ArmsTick before = run(view->engine(), 0.1).loop[0].arms;
  EXPECT_FALSE(publish(*view, "/operator/hand", R"({"position_m":[-0.02,0.03,-0.04],"engaged":true})"));
  const EngineTick tick = run(view->engine(), 2.0);
  // Down is toward the wall; across lie x of the base, and down × x.
  constexpr std::array wanted{0.03F, 0.04F, 0.02F};
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(tick.loop[0].arms.hand_m[i] - before.hand_m[i], wanted[i], 1e-4F);
  EXPECT_NEAR(tick.loop[0].record.master_position_m, -0.02, 2e-3);
  EXPECT_NEAR(tick.loop[0].record.slave_position_m, -0.02, 4e-3);
}

TEST(LiveArms, NonsenseOfAHandInSpaceIsAnsweredAndMovesNothing) {
  const auto view = arm_view();
  for (const char* text :
       {R"({"position_m":[],"engaged":true})", R"({"position_m":[0,0],"engaged":true})",
        R"({"position_m":[0,0,0,0],"engaged":true})", R"({"position_m":[0,"x",0],"engaged":true})",
        R"({"position_m":[0,null,0],"engaged":true})", R"({"position_m":[[0],0,0],"engaged":true})",
        R"({"position_m":[1e999,0,0],"engaged":true})", R"({"position_m":{"x":0},"engaged":true})"}) {
    const auto status = publish(*view, "/operator/hand", text);
    ASSERT_TRUE(status) << text;
    EXPECT_EQ(status->level, StatusLevel::error) << text;
  }
  EXPECT_EQ(run(view->engine(), 0.05).loop[0].hand_position_m, 0.0);
  const auto outside = publish(*view, "/operator/hand", R"({"position_m":[0,-9,0],"engaged":true})");
  ASSERT_TRUE(outside);
  EXPECT_EQ(outside->level, StatusLevel::warning);
  EXPECT_FALSE(run(view->engine(), 2.0).loop[0].stopped) << "it went as far as it may";
  const auto one_axis = sample_view();
  EXPECT_TRUE(publish(*one_axis, "/operator/hand", R"({"position_m":[0,0,0],"engaged":true})"));
}

TEST(LiveArms, AChangeLeavesTheArmsWhereTheyAre) {
  const auto view = arm_view();
  EXPECT_FALSE(publish(*view, "/operator/hand", R"({"position_m":[0.015,0.02,0],"engaged":true})"));
  const LoopTick before = run(view->engine(), 1.5).loop[0];
  ASSERT_GT(before.record.contact_force_N, 0.1);
  EXPECT_TRUE(view->set_parameters({{"control.force_gain", 2.0},
                                    {"left.method", std::string("position-position")},
                                    {"operator.grip", 2.0},
                                    {"wall.stiffness_N_per_m", 5000.0}})
                  .empty());
  const LoopTick after = run(view->engine(), 0.005).loop[0];
  EXPECT_EQ(after.run, before.run);
  EXPECT_EQ(after.changes, before.changes + 1);
  EXPECT_NEAR(after.record.master_position_m, before.record.master_position_m, 2e-3);
  const LoopTick later = run(view->engine(), 1.0).loop[0];
  EXPECT_FALSE(later.stopped);
  EXPECT_GT(later.record.tip_position_m, before.record.tip_position_m) << "the softer wall gives";
}

TEST(LiveArms, ATickAllocatesNothingNotEvenOneThatTakesAChange) {
  const auto view = arm_view();
  run(view->engine(), 0.05);
  EXPECT_FALSE(publish(*view, "/operator/hand", R"({"position_m":[0.01,0.01,0],"engaged":true})"));
  EXPECT_TRUE(view->set_parameters({{"control.force_gain", 5.0}}).empty());
  EXPECT_FALSE(publish(*view, "/operator/command", R"({"command":"reset"})"));
  const std::uint64_t before = laws::own_allocation_count();
  for (int i = 0; i < 100; ++i) view->engine().step();
  EXPECT_EQ(laws::own_allocation_count(), before);
}

TEST(LiveArms, EveryMethodCanBeServed) {
  Settings settings = arm_settings();
  for (const ParameterDescription& description : settings.descriptions()) {
    if (description.name != "left.method") continue;
    EXPECT_GE(description.choices.size(), 8U);
    for (const std::string& choice : description.choices) {
      ASSERT_FALSE(settings.set({"left.method", choice}));
      const auto params = settings.of_loop(0);
      ASSERT_TRUE(params) << choice << ": " << describe(params.error());
      EXPECT_TRUE(make_loop(*params, 0.0)) << choice;
    }
  }
}

TEST(LiveArms, WhatCannotBeServedIsRefusedByItsKind) {
  const auto document = configuration::Document::parse("task.kind = \"contest\"\n", "other.toml").value();
  const auto settings = Settings::make(document);
  ASSERT_FALSE(settings);
  EXPECT_EQ(describe(settings.error()),
            "other.toml:1:13: task.kind: 'contest' cannot be served: serve one of tapping, arm-tapping");
}

}  // namespace tactus::live::arms_test
