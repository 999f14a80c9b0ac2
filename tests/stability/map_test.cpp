// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/map.hpp>
#include <tactus/analysis/stability/map_block.hpp>
#include <tactus/analysis/stability/map_hdf5.hpp>
#include <tactus/simulation/tasks/engine.hpp>
#include <tactus/simulation/tasks/work.hpp>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>

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
  request.place.folder = folder;
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
  tasks::Threads one_thread(1), three_threads(3);
  request.place.engine = &one_thread;
  const std::string one = csv_of(request);
  request.place.engine = &three_threads;
  EXPECT_EQ(one, csv_of(request));
  EXPECT_NE(one.find("settled"), std::string::npos) << one.substr(0, 300);
}

Error failure(std::string message) {
  return {.code = ErrorCode::failed, .parameter = {}, .message = std::move(message), .place = {}};
}

/// Runs a map, and ends it as an error would once so many blocks are done.
class EndedEarly final : public tasks::Engine {
 public:
  explicit EndedEarly(std::size_t blocks) : left_(blocks) {}
  Check run(const tasks::Job& job, const tasks::TaskList& list, const tasks::Take& take,
            const tasks::Progress& progress) override {
    return threads_.run(
        job, list,
        [&](std::size_t task, std::string_view value) -> Check {
          if (left_ == 0) return failure("ended early");
          --left_;
          return take(task, value);
        },
        progress);
  }

 private:
  tasks::Threads threads_{1};
  std::size_t left_;
};

TEST(Maps, AKilledMapContinuesFromItsLastWholeBlockToTheSameResult) {
  for (const MapPrecision precision : {MapPrecision::lanes_of_double, MapPrecision::lanes_of_float}) {
    const std::string folder = scratch_path().string();
    std::filesystem::remove_all(folder);
    MapRequest request = small_map();
    request.precision = precision;
    const std::string whole = csv_of(request);
    request.place.folder = folder;
    const bool single = precision == MapPrecision::lanes_of_float;
    EndedEarly early(single ? 3 : 2);  // of three blocks; in float, some points are run again
    request.place.engine = &early;
    EXPECT_TRUE(csv_of(request) == "ended early");
    {
      // What a process leaves that is killed within a write.
      std::ofstream half(std::filesystem::path(folder) / "tasks.partial", std::ios::app | std::ios::binary);
      half << std::string("\5\0\0\0\x20\0\0\0half a block", 20);
    }
    request.place.engine = nullptr;
    const auto map = run_map(request, [](double) {});
    ASSERT_TRUE(map) << describe(map.error());
    EXPECT_GE(map->resumed, single ? 1200U : 2 * 176U);
    EXPECT_TRUE(to_csv(*map) == whole);
    EXPECT_FALSE(std::filesystem::is_empty(folder)) << "the blocks must stay until the results are written";
    tasks::remove_finished_tasks(folder);
    EXPECT_TRUE(std::filesystem::is_empty(folder));
  }
}

TEST(Maps, AFinishedMapIsPutTogetherWithoutRunningAPoint) {
  const std::string folder = scratch_path().string();
  std::filesystem::remove_all(folder);
  const auto first = run_map(small_map(folder), [](double) {});
  const auto second = run_map(small_map(folder), [](double) {});
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->resumed, 0U);
  EXPECT_GT(first->ticks, 0.0);
  EXPECT_EQ(second->resumed, 1200U);
  EXPECT_EQ(second->ticks, 0.0);
  EXPECT_EQ(to_csv(*first), to_csv(*second));
  std::filesystem::remove_all(folder);
}

TEST(Maps, APartOfAnotherMapIsRefused) {
  const std::string folder = scratch_path().string();
  std::filesystem::remove_all(folder);
  MapRequest request = small_map(folder);
  ASSERT_TRUE(run_map(request, [](double) {}));
  request.base.environment.damping_N_s_per_m = 4.0;
  EXPECT_EQ(run_map(request, [](double) {}).error().code, ErrorCode::inconsistent);
  request = small_map(folder);
  request.precision = MapPrecision::lanes_of_float;
  EXPECT_EQ(run_map(request, [](double) {}).error().code, ErrorCode::inconsistent);
  request = small_map(folder);
  request.axes[0] = *parse_axis("control.force_gain=0.5:31:30");
  EXPECT_EQ(run_map(request, [](double) {}).error().code, ErrorCode::inconsistent);
  std::filesystem::remove_all(folder);
}

TEST(Maps, ABlockComesBackFromItsBytes) {
  const MapBlockKey key{.single = true, .points = {3, 4, 5, 9, 11, 12}};
  const auto read = map_block_key(to_bytes(key), 13);
  ASSERT_TRUE(read);
  EXPECT_EQ(read->points, key.points);
  EXPECT_TRUE(read->single);
  EXPECT_FALSE(map_block_key(to_bytes(key), 12)) << "point 12 is outside of the grid";
  EXPECT_FALSE(map_block_key(to_bytes(key).substr(0, 7), 13));
  EXPECT_FALSE(map_block_key("", 13));
  const MapBlock block{.ticks = 7.0, .lane_ticks = 8.0, .points = {{.contacts = 1.0}, {.peak_force_N = 0.1}}};
  EXPECT_EQ(map_block(to_bytes(block), 2)->points[1].peak_force_N, 0.1);
  EXPECT_FALSE(map_block(to_bytes(block), 1));
  EXPECT_FALSE(map_block(to_bytes(block), 3));
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
