// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/lane_memory.hpp>
#include <tactus/analysis/stability/map_point.hpp>
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::stability {
namespace {

/// A short tap with everything that a map can vary drawn over its range, gentle to wild.
MapParams random_params(signal::Random& draw) {
  const auto between = [&draw](double lower, double upper) { return lower + (upper - lower) * draw.uniform(); };
  MapParams params;
  params.task.observation_s = 0.15;
  params.task.speed_m_per_s = 0.2;
  params.task.depth_m = between(0.002, 0.006);
  params.task.grip = std::exp(between(std::log(0.25), std::log(4.0)));
  params.task.mismatch.mass = between(0.7, 1.3);
  params.plant.longest_step_s = 50e-6;
  params.control.force_gain = between(0.5, 30.0);
  params.control.cancellation = draw.uniform() < 0.5 ? control::CancellationMode::on : control::CancellationMode::off;
  params.control.model.linkage.hysteretic_fraction = draw.uniform() < 0.5 ? 0.0 : between(0.1, 0.5);
  params.environment.stiffness_N_per_m = std::exp(between(std::log(1e3), std::log(1e5)));
  params.environment.damping_N_s_per_m = between(0.0, 5.0);
  params.channel.to_slave.delay_s = draw.uniform() < 0.5 ? 0.0 : between(0.0, 0.01);
  params.channel.to_master.delay_s = draw.uniform() < 0.5 ? 0.0 : between(0.0, 0.01);
  return params;
}

struct BlockRun {
  std::vector<LaneResult> results;
  std::vector<double> force_N;
};

BlockRun run(const LaneRunner& runner, const std::vector<LanePoint>& points, const LanePlan& plan) {
  std::vector<const LanePoint*> pointers;
  for (const LanePoint& point : points) pointers.push_back(&point);
  LaneMemory lines(lane_room(points.data(), points.size(), runner.lanes));
  BlockRun out{std::vector<LaneResult>(points.size()), std::vector<double>(plan.longest() * points.size())};
  runner.run(pointers.data(), plan, lines.numbers(), out.force_N.data(), out.results.data());
  return out;
}

TEST(Lanes, EveryLaneEqualsTheScalarLoopBitForBit) {
  signal::Random draw(1);
  const LaneRunners runners = lane_runners();
  for (const LaneRunner* runner : std::span(runners.all, runners.count)) {
    if (runner->single) continue;
    SCOPED_TRACE(runner->name);
    for (int round = 0; round < 3; ++round) {
      std::vector<LanePoint> points;
      std::vector<MapParams> params;
      for (std::size_t i = 0; i < runner->lanes; ++i) {
        params.push_back(random_params(draw));
        const auto point = make_point(params.back());
        ASSERT_TRUE(point) << describe(point.error());
        points.push_back(*point);
      }
      LanePlan plan = *make_plan(params.front());
      plan.approach_ticks = 1500;
      const BlockRun block = run(*runner, points, plan);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const BlockRun alone = run(scalar_runner(), {points[i]}, plan);
        const LaneResult &lane = block.results[i], &scalar = alone.results[0];
        ASSERT_EQ(lane.ticks, scalar.ticks);
        EXPECT_EQ(lane.first_touch, scalar.first_touch);
        EXPECT_EQ(lane.touched, scalar.touched);
        EXPECT_EQ(lane.diverged, scalar.diverged);
        EXPECT_EQ(lane.touches, scalar.touches);
        EXPECT_EQ(lane.peak_force_N, scalar.peak_force_N);
        std::size_t different = 0;
        for (std::size_t n = 0; n < lane.ticks; ++n) {
          const double a = block.force_N[n * points.size() + i], b = alone.force_N[n];
          if (!(a == b || (std::isnan(a) && std::isnan(b)))) ++different;
        }
        EXPECT_EQ(different, 0U);
      }
    }
  }
}

TEST(Lanes, TheScalarLoopEqualsTheTeleoperatorBitForBit) {
  signal::Random draw(2);
  int diverged = 0, touched = 0;
  for (int round = 0; round < 12; ++round) {
    const MapParams params = random_params(draw);
    const auto point = make_point(params);
    ASSERT_TRUE(point) << describe(point.error());
    const LanePlan plan = *make_plan(params);
    const BlockRun lane = run(scalar_runner(), {*point}, plan);

    const double wall_m = params.environment.position_m;
    const mechanics::MinimumJerk path{
        .start_m = wall_m - params.task.depth_m,
        .end_m = wall_m + params.task.depth_m,
        .duration_s = mechanics::MinimumJerk::duration_for(2.0 * params.task.depth_m, params.task.speed_m_per_s)};
    auto teleoperator = simulation::Teleoperator::make(teleoperator_params(params), path.start_m);
    ASSERT_TRUE(teleoperator) << describe(teleoperator.error());
    std::size_t different = 0;
    int contacts = 0;
    double peak_N = 0.0;
    for (std::size_t n = 0; n < lane.results[0].ticks; ++n) {
      const double time_s = static_cast<double>(n) * plan.clock.tick_s;
      const auto record = teleoperator->step(path.position_m(time_s), path.position_m(time_s + plan.clock.tick_s));
      if (record.contact_force_N != lane.force_N[n]) ++different;
      contacts += record.touched ? 1 : 0;
      peak_N = std::max(peak_N, record.peak_contact_force_N);
    }
    EXPECT_EQ(different, 0U) << "of " << lane.results[0].ticks;
    EXPECT_EQ(peak_N, lane.results[0].peak_force_N);
    EXPECT_LE(contacts, lane.results[0].touches);
    diverged += lane.results[0].diverged ? 1 : 0;
    touched += lane.results[0].touched ? 1 : 0;
  }
  EXPECT_EQ(touched, 12);
  EXPECT_EQ(diverged, 0);
}

TEST(Lanes, FloatFollowsDoubleUntilTheFirstTouchToMicrometresAndMilliseconds) {
  signal::Random draw(3);
  const LaneRunners runners = lane_runners();
  for (const LaneRunner* runner : std::span(runners.all, runners.count)) {
    if (!runner->single) continue;
    SCOPED_TRACE(runner->name);
    MapParams params = random_params(draw);
    params.control.force_gain = 1.0;
    params.environment.stiffness_N_per_m = 2e4;
    params.environment.damping_N_s_per_m = 3.0;
    const auto point = make_point(params);
    ASSERT_TRUE(point);
    const LanePlan plan = *make_plan(params);
    const BlockRun lanes = run(*runner, std::vector<LanePoint>(runner->lanes, *point), plan);
    const BlockRun scalar = run(scalar_runner(), {*point}, plan);
    EXPECT_NEAR(static_cast<double>(lanes.results[0].first_touch), static_cast<double>(scalar.results[0].first_touch),
                5.0);
    EXPECT_NEAR(lanes.results[0].peak_force_N, scalar.results[0].peak_force_N, 0.1 * scalar.results[0].peak_force_N);
  }
}

TEST(MapPoints, WhatTheLoopOfAMapDoesNotHaveIsRefusedByItsKey) {
  MapParams params;
  params.slave.force_sensor.noise_rms_N = 0.1;
  EXPECT_EQ(make_point(params).error().parameter, "slave.force_sensor.noise_rms_N");
  params = {};
  params.control.architecture = "four-channel";
  EXPECT_EQ(make_point(params).error().parameter, "control.architecture");
  params = {};
  params.environment.law = mechanics::ContactLaw::hunt_crossley;
  EXPECT_EQ(make_point(params).error().parameter, "environment.law");
  params = {};
  params.channel.to_slave.loss_fraction = 0.1;
  EXPECT_EQ(make_point(params).error().parameter, "channel.to_slave.loss_fraction");
}

}  // namespace
}  // namespace tactus::stability
