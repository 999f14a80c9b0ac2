// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/lane_memory.hpp>
#include <tactus/analysis/stability/map.hpp>
#include <tactus/analysis/stability/map_block.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/simulation/tasks/work.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

namespace tactus::stability {

namespace {

constexpr std::size_t most_points = 10'000'000;

/// Everything besides the points of a block on which its results depend.
std::string description_of(const MapRequest& request) {
  std::string all = "stability map\n" + configuration::to_toml(request.base);
  all += request.precision == MapPrecision::lanes_of_float ? "float" : "double";
  for (const MapAxis& axis : request.axes) {
    all += "\n" + axis.key + "\n";
    all.append(reinterpret_cast<const char*>(axis.values.data()), axis.values.size() * sizeof(double));
  }
  return all;
}

/// Runs points of one map. Shared by the threads; holds nothing that changes.
struct PointRunner {
  const MapRequest& request;
  LanePlan plan;

  /// The points of the grid with these indices, as many lanes at once as there are.
  Result<MapBlock> run(const MapBlockKey& key) const {
    const LaneRunner& lanes = lane_runner(key.single);
    PointParams params(request.base, request.axes);
    const std::size_t width = lanes.lanes;
    std::vector<LanePoint> points;
    std::vector<const LanePoint*> pointers(width);
    std::vector<LaneResult> runs(width);
    std::vector<double> force_N(plan.longest() * width), one_N;
    MapBlock block;
    for (std::size_t first = 0; first < key.points.size(); first += width) {
      const std::size_t count = std::min(width, key.points.size() - first);
      points.clear();
      for (std::size_t i = 0; i < count; ++i) {
        auto point = make_point(params.at(key.points[first + i]));
        if (!point) return point.error();
        points.push_back(*std::move(point));
      }
      // Lanes without a point of their own repeat the last.
      for (std::size_t i = 0; i < width; ++i) pointers[i] = &points[std::min(i, count - 1)];
      LaneMemory lines(lane_room(points.data(), count, width));
      lanes.run(pointers.data(), plan, lines.numbers(), force_N.data(), runs.data());
      std::size_t longest = 0;
      for (std::size_t i = 0; i < count; ++i) {
        one_N.resize(runs[i].ticks);
        for (std::size_t n = 0; n < one_N.size(); ++n) one_N[n] = force_N[n * width + i];
        block.points.push_back(judge(runs[i], one_N, plan.clock.tick_s));
        block.ticks += static_cast<double>(runs[i].ticks);
        longest = std::max(longest, runs[i].ticks);
      }
      block.lane_ticks += static_cast<double>(longest * width);
    }
    return block;
  }
};

/// Runs some points of the grid in blocks: the point of each place below `count`.
Check run_points(tasks::Work& work, bool single, std::size_t count,
                 const std::function<std::size_t(std::size_t place)>& point, MapResult& result,
                 const std::function<void(double)>& progress) {
  const auto size_of = [&](std::size_t block) { return std::min(block_points, count - block * block_points); };
  return work.run(
      {.count = (count + block_points - 1) / block_points,
       .key =
           [&](std::size_t block) {
             MapBlockKey key{.single = single, .points = {}};
             for (std::size_t i = 0; i < size_of(block); ++i) key.points.push_back(point(block * block_points + i));
             return to_bytes(key);
           }},
      [&](std::size_t number, std::string_view value, tasks::Origin origin) -> Check {
        const auto block = map_block(value, size_of(number));
        if (!block) return block.error();
        for (std::size_t i = 0; i < block->points.size(); ++i) {
          result.points[point(number * block_points + i)] = block->points[i];
        }
        if (origin == tasks::Origin::stored) {
          result.resumed += block->points.size();
        } else {
          result.ticks += block->ticks;
          result.lane_ticks += block->lane_ticks;
        }
        return {};
      },
      progress);
}

/// Points with another verdict next to them along some axis, where rounding could matter, but for those that are
/// `exact`.
std::vector<std::size_t> near_boundary(const MapResult& map, const std::vector<char>& exact) {
  std::vector<char> near(map.points.size());
  std::size_t stride = 1;
  for (std::size_t axis = map.axes.size(); axis-- > 0;) {
    const std::size_t steps = map.axes[axis].values.size();
    for (std::size_t i = 0; i < map.points.size(); ++i) {
      if ((i / stride) % steps + 1 == steps || map.points[i].verdict == map.points[i + stride].verdict) continue;
      near[i] = near[i + stride] = 1;
    }
    stride *= steps;
  }
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (near[i] != 0 && exact[i] == 0) indices.push_back(i);
  }
  return indices;
}

/// Every corner of the grid must make a point, and a whole teleoperator. The axes of a grid are few.
Check check_corners(const MapRequest& request, std::size_t points) {
  PointParams params(request.base, request.axes);
  for (std::size_t corner = 0; corner < (std::size_t{1} << request.axes.size()); ++corner) {
    std::size_t index = 0;
    for (std::size_t axis = 0; axis < request.axes.size(); ++axis) {
      const std::size_t steps = request.axes[axis].values.size();
      index = index * steps + ((corner >> axis) & 1U) * (steps - 1);
    }
    const auto point = make_point(params.at(std::min(index, points - 1)));
    if (!point) return point.error();
    const auto whole = simulation::Teleoperator::make(teleoperator_params(params.at(index)), 0.0);
    if (!whole) return whole.error();
  }
  return {};
}

std::string exact(double value) {
  char text[32];
  const auto [end, error] = std::to_chars(text, text + sizeof text, value);
  return error == std::errc{} ? std::string(text, end) : std::string("nan");
}

}  // namespace

Result<std::size_t> count_points(const std::vector<MapAxis>& axes) {
  const auto refuse = [](const std::string& key, const char* why) {
    return Error{.code = ErrorCode::inconsistent, .parameter = key, .message = why, .place = "--vary"};
  };
  if (axes.empty() || axes.size() > 6) return refuse("", "a map has one to six axes: write --vary key=from:to:count");
  std::size_t points = 1;
  for (const MapAxis& axis : axes) {
    if (std::count_if(axes.begin(), axes.end(), [&](const MapAxis& other) { return other.key == axis.key; }) > 1) {
      return refuse(axis.key, "is varied twice: give all its values in one --vary");
    }
    points *= axis.values.size();
    if (points > most_points) return refuse(axis.key, "more than ten million points: vary fewer values");
  }
  return points;
}

Result<MapResult> run_map(const MapRequest& request, const std::function<void(double)>& progress) {
  const auto count = count_points(request.axes);
  if (!count) return count.error();
  const auto plan = make_plan(request.base);
  if (!plan) return plan.error();
  if (auto error = check_corners(request, *count)) return *std::move(error);
  const bool single = request.precision == MapPrecision::lanes_of_float;
  const PointRunner runner{request, *plan};
  auto work = tasks::Work::begin(
      request.place,
      {.description = description_of(request), .run = [&runner, count](std::string_view bytes) -> Result<std::string> {
         const auto key = map_block_key(bytes, *count);
         if (!key) return key.error();
         const auto block = runner.run(*key);
         if (!block) return block.error();
         return to_bytes(*block);
       }});
  if (!work) return work.error();
  MapResult result{.axes = request.axes, .points = {}, .instruction_set = lane_runner(single).name};
  if (!work->leads()) return result;
  result.points.resize(*count);
  if (auto error = run_points(
          *work, single, *count, [](std::size_t place) { return place; }, result, progress)) {
    return *std::move(error);
  }
  if (!single) return result;

  // A verdict that changes in double can put the boundary beside points that are still in float, so until none is left.
  std::vector<char> exact(*count);
  for (;;) {
    const std::vector<std::size_t> again = near_boundary(result, exact);
    if (again.empty()) return result;
    if (auto error = run_points(
            *work, false, again.size(), [&again](std::size_t place) { return again[place]; }, result, progress)) {
      return *std::move(error);
    }
    for (const std::size_t point : again) exact[point] = 1;
    result.redone += again.size();
  }
}

std::vector<double> settled_limit(const MapResult& map, std::size_t along) {
  std::size_t stride = 1;
  for (std::size_t axis = along + 1; axis < map.axes.size(); ++axis) stride *= map.axes[axis].values.size();
  const auto& values = map.axes[along].values;
  std::vector<double> limits;
  for (std::size_t slow = 0; slow < map.points.size(); slow += stride * values.size()) {
    for (std::size_t fast = 0; fast < stride; ++fast) {
      double limit = std::numeric_limits<double>::quiet_NaN();
      for (std::size_t i = 0; i < values.size(); ++i) {
        const auto verdict = map.points[slow + i * stride + fast].verdict;
        if (verdict != experiments::Verdict::settled && verdict != experiments::Verdict::ringing) break;
        limit = values[i];
      }
      limits.push_back(limit);
    }
  }
  return limits;
}

std::string to_csv(const MapResult& map) {
  std::string text;
  for (const MapAxis& axis : map.axes) text += axis.key + (axis.unit.empty() ? "" : " (" + axis.unit + ")") + ",";
  text += "verdict,settling_time_s,settling_time_s_censored,contacts,peak_force_N,residual_rms_N\n";
  for (std::size_t i = 0; i < map.points.size(); ++i) {
    std::size_t stride = map.points.size();
    for (const MapAxis& axis : map.axes) {
      stride /= axis.values.size();
      const std::size_t at = i / stride % axis.values.size();
      text += (axis.words.empty() ? exact(axis.values[at]) : axis.words[at]) + ",";
    }
    const PointResult& point = map.points[i];
    const bool came_to_rest =
        point.verdict == experiments::Verdict::settled || point.verdict == experiments::Verdict::ringing;
    text += std::string(name_of(point.verdict)) + "," + exact(point.settling_time_s) + "," +
            (came_to_rest ? "false" : "true") + "," + exact(point.contacts) + "," + exact(point.peak_force_N) + "," +
            exact(point.residual_rms_N) + "\n";
  }
  return text;
}

}  // namespace tactus::stability
