// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/map.hpp>
#include <tactus/analysis/stability/map_file.hpp>
#include <tactus/analysis/stability/map_hdf5.hpp>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <gtest/gtest.h>
#include <tests/scratch_path.hpp>

namespace tactus::stability {
namespace {

/// Gain by stiffness, 30 by 40 short contacts on a coarse clock.
MapRequest small_map(const std::string& folder = {}) {
  MapRequest request;
  request.base.task.observation_s = 0.15;
  request.base.task.speed_m_per_s = 0.3;
  request.base.task.depth_m = 0.003;
  request.base.plant.longest_step_s = 1e-4;
  request.base.servo.computation_delay_s = 0.0;
  request.base.servo.rate_Hz = 2000.0;
  request.base.person.correction.reaction_time_s = 0.01;
  request.base.control.cancellation = control::CancellationMode::off;
  request.axes = {*parse_axis("control.force_gain=0.5:30:30"),
                  *parse_axis("environment.stiffness_N_per_m=1e3:5e4:40[log]")};
  request.folder = folder;
  return request;
}

std::string csv_of(const MapRequest& request) {
  const auto map = run_map(request, [](double) {});
  return map ? to_csv(*map) : describe(map.error());
}

TEST(Maps, AnAxisIsReadWithUnitAndScale) {
  const auto axis = parse_axis("environment.stiffness_N_per_m=1e3:1e5:3[log]");
  ASSERT_TRUE(axis) << describe(axis.error());
  ASSERT_EQ(axis->values.size(), 3U);
  EXPECT_EQ(axis->values[0], 1e3);
  EXPECT_NEAR(axis->values[1], 1e4, 1e-8);
  EXPECT_EQ(axis->values[2], 1e5);
  EXPECT_EQ(axis->unit, "N/m");
  const auto words = parse_axis("control.cancellation=off,on");
  ASSERT_TRUE(words);
  EXPECT_EQ(words->words, (std::vector<std::string>{"off", "on"}));
}

TEST(Maps, AWrongAxisIsRefusedAndSaysWhatToWrite) {
  for (const char* text : {"", "=", "control.force_gain", "control.force_gain=", "control.force_gain=1:2",
                           "control.force_gain=2:1:5", "control.force_gain=1:2:1", "control.force_gain=1:2:1e9",
                           "control.force_gain=nan:2:5", "control.force_gain=0:2:5[log]", "control.force_gain=2,1"}) {
    const auto axis = parse_axis(text);
    ASSERT_FALSE(axis) << text;
    EXPECT_EQ(axis.error().code, ErrorCode::syntax) << text;
  }
  EXPECT_EQ(parse_axis("control.force_gian=1,2").error().code, ErrorCode::unknown_key);
  EXPECT_EQ(parse_axis("control.force_gain=1,2000").error().code, ErrorCode::out_of_bounds);
  EXPECT_EQ(parse_axis("control.cancellation=off,maybe").error().code, ErrorCode::out_of_bounds);
  EXPECT_EQ(parse_axis("servo.rate_Hz=1000,2000").error().code, ErrorCode::inconsistent);
  EXPECT_EQ(parse_axis("channel.to_slave.seed=1,2").error().code, ErrorCode::wrong_type);
}

TEST(Maps, ThreadsDoNotChangeABit) {
  MapRequest request = small_map();
  request.threads = 1;
  const std::string one = csv_of(request);
  request.threads = 3;
  EXPECT_EQ(one, csv_of(request));
  EXPECT_NE(one.find("settled"), std::string::npos) << one.substr(0, 300);
}

TEST(Maps, AKilledMapGoesOnFromItsLastWholeBlockToTheSameResult) {
  const std::string folder = scratch_path().string();
  const std::string whole = csv_of(small_map());
  std::filesystem::remove_all(folder);
  MapRequest request = small_map(folder);
  request.share = {.rank = 1, .ranks = 3};  // does block 1 of 0, 1, 2 and leaves
  ASSERT_TRUE(run_map(request, [](double) {}));
  const auto left = std::filesystem::path(folder) / "blocks-1.partial";
  ASSERT_TRUE(std::filesystem::exists(left));
  std::filesystem::rename(left, std::filesystem::path(folder) / "blocks-0.partial");
  {
    // What a process leaves that is killed within a write.
    std::ofstream half(std::filesystem::path(folder) / "blocks-0.partial", std::ios::app | std::ios::binary);
    half << std::string("\2\0\0\0\0\0\0\0\xb0\0\0\0\0\0\0\0half a block", 28);
  }
  request.share = {};
  const auto map = run_map(request, [](double) {});
  ASSERT_TRUE(map) << describe(map.error());
  EXPECT_EQ(map->resumed, block_points);
  EXPECT_EQ(to_csv(*map), whole);
  EXPECT_FALSE(std::filesystem::is_empty(folder)) << "the blocks must stay until the results are written";
  remove_partial(folder);
  EXPECT_TRUE(std::filesystem::is_empty(folder));
}

TEST(Maps, RanksThatShareAFolderGiveWhatOneGives) {
  const std::string folder = scratch_path().string();
  std::filesystem::remove_all(folder);
  const std::string whole = csv_of(small_map());
  MapRequest request = small_map(folder);
  request.share = {.rank = 1, .ranks = 2};
  ASSERT_TRUE(run_map(request, [](double) {}));
  request.share = {.rank = 0, .ranks = 2};
  EXPECT_EQ(csv_of(request), whole);
}

TEST(Maps, RanksThatShareAFloatMapAgreeOnWhatToRunAgain) {
  const std::string folder = scratch_path().string();
  std::filesystem::remove_all(folder);
  MapRequest request = small_map();
  request.precision = MapPrecision::lanes_of_float;
  const std::string whole = csv_of(request);
  request.folder = folder;
  request.share = {.rank = 1, .ranks = 2};
  std::jthread other([request] { EXPECT_TRUE(run_map(request, [](double) {})); });
  request.share = {.rank = 0, .ranks = 2};
  EXPECT_EQ(csv_of(request), whole);
  remove_partial(folder);  // the other may still be waiting, and must not wait for ever
}

TEST(Maps, APartOfAnotherMapIsRefused) {
  const std::string folder = scratch_path().string();
  std::filesystem::remove_all(folder);
  MapRequest request = small_map(folder);
  request.share = {.rank = 1, .ranks = 3};
  ASSERT_TRUE(run_map(request, [](double) {}));
  request.base.environment.damping_N_s_per_m = 4.0;
  const auto map = run_map(request, [](double) {});
  ASSERT_FALSE(map);
  EXPECT_EQ(map.error().code, ErrorCode::inconsistent);
}

TEST(Maps, WhereVerdictsOfAFloatMapMeetBothAreThoseOfDoubleBitForBit) {
  MapRequest request = small_map();
  const auto exact = run_map(request, [](double) {});
  request.precision = MapPrecision::lanes_of_float;
  const auto fast = run_map(request, [](double) {});
  ASSERT_TRUE(exact && fast);
  const std::size_t columns = request.axes[1].values.size(), points = exact->points.size();
  const auto same = [&](std::size_t i) {
    const PointResult &a = exact->points[i], &b = fast->points[i];
    return a.verdict == b.verdict && a.settling_time_s == b.settling_time_s && a.contacts == b.contacts &&
           a.peak_force_N == b.peak_force_N && a.residual_rms_N == b.residual_rms_N;
  };
  std::size_t meetings = 0, in_float = 0, other_verdicts = 0;
  for (std::size_t i = 0; i < points; ++i) {
    const auto meets = [&](std::size_t j) {
      if (fast->points[i].verdict == fast->points[j].verdict) return;
      ++meetings;
      EXPECT_TRUE(same(i) && same(j)) << i << ", " << j;
    };
    if (i % columns + 1 < columns) meets(i + 1);
    if (i + columns < points) meets(i + columns);
    in_float += same(i) ? 0U : 1U;
    other_verdicts += exact->points[i].verdict != fast->points[i].verdict ? 1U : 0U;
  }
  EXPECT_GT(meetings, 20U);
  EXPECT_GT(in_float, points / 2) << "most of the map was not run again";
  EXPECT_EQ(in_float + fast->redone, points) << "what differs from double is what was not run again";
  EXPECT_LE(other_verdicts, points / 50);
}

TEST(Maps, AMapIsWrittenAsHdf5AllOrNothing) {
  const auto map = run_map(small_map(), [](double) {});
  ASSERT_TRUE(map);
  const auto path = scratch_path();
  const auto error = write_hdf5(path, *map);
  EXPECT_FALSE(error) << describe(*error);
  EXPECT_GT(std::filesystem::file_size(path), map->points.size() * 5 * sizeof(double));
  std::ifstream file(path, std::ios::binary);
  std::string start(4, ' ');
  file.read(start.data(), 4);
  EXPECT_EQ(start, "\x89HDF");
  std::filesystem::remove(path);
  EXPECT_EQ(write_hdf5("/nowhere/map.h5", *map)->code, ErrorCode::unwritable);
}

TEST(Maps, ARequestThatCannotRunIsRefusedBeforeAnythingRuns) {
  MapRequest request = small_map();
  request.axes = {};
  EXPECT_EQ(run_map(request, [](double) {}).error().code, ErrorCode::inconsistent);
  request = small_map();
  request.axes = {*parse_axis("environment.stiffness_N_per_m=1e3:1e7:40[log]")};
  EXPECT_EQ(run_map(request, [](double) {}).error().parameter, "environment.stiffness_N_per_m");
}

}  // namespace
}  // namespace tactus::stability
