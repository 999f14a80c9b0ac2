// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/lane_memory.hpp>
#include <tactus/analysis/stability/map.hpp>
#include <tactus/analysis/stability/map_file.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/report/files.hpp>
#include <tactus/kernel/core/version.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
#include <span>
#include <thread>
#include <utility>

namespace tactus::stability {

namespace {

constexpr std::size_t most_points = 10'000'000;
/// Blocks of each further pass of a float map are numbered from a multiple of this.
constexpr std::uint64_t blocks_a_pass = std::uint64_t{1} << 40;

/// FNV-1a of everything that the results depend on.
std::uint64_t identity_of(const MapRequest& request) {
  std::string all = std::string(version()) + "\n" + configuration::to_toml(request.base);
  all += request.precision == MapPrecision::lanes_of_float ? "float" : "double";
  for (const MapAxis& axis : request.axes) {
    all += "\n" + axis.key;
    all.append(reinterpret_cast<const char*>(axis.values.data()), axis.values.size() * sizeof(double));
  }
  std::uint64_t hash = 14695981039346656037U;
  for (const char c : all) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211U;
  return hash;
}

/// Runs points of one map. Shared by the threads; holds nothing that changes.
struct PointRunner {
  const MapRequest& request;
  LanePlan plan;
  const LaneRunner& lanes;

  struct Effort {
    double ticks = 0.0;
    double lane_ticks = 0.0;
  };

  /// The points of the grid with these indices, as many lanes at once as there are.
  Result<Effort> run(std::span<const std::size_t> indices, PointResult* results) const {
    PointParams params(request.base, request.axes);
    const std::size_t width = lanes.lanes;
    std::vector<LanePoint> points;
    std::vector<const LanePoint*> pointers(width);
    std::vector<LaneResult> runs(width);
    std::vector<double> force_N(plan.longest() * width), one_N;
    Effort effort;
    for (std::size_t first = 0; first < indices.size(); first += width) {
      const std::size_t count = std::min(width, indices.size() - first);
      points.clear();
      for (std::size_t i = 0; i < count; ++i) {
        auto point = make_point(params.at(indices[first + i]));
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
        results[first + i] = judge(runs[i], one_N, plan.clock.tick_s);
        effort.ticks += static_cast<double>(runs[i].ticks);
        longest = std::max(longest, runs[i].ticks);
      }
      effort.lane_ticks += static_cast<double>(longest * width);
    }
    return effort;
  }
};

/// One pass over some points of the grid: which blocks are done, and their results.
struct Pass {
  std::vector<std::size_t> indices;
  std::uint64_t first_number = 0;
  std::vector<PointResult> results = {};
  std::vector<char> done = {};

  Pass(std::vector<std::size_t> which, std::uint64_t number)
      : indices(std::move(which)),
        first_number(number),
        results(indices.size()),
        done((indices.size() + block_points - 1) / block_points) {}

  [[nodiscard]] std::size_t size_of(std::size_t block) const {
    return std::min(block_points, indices.size() - block * block_points);
  }
  [[nodiscard]] bool complete() const { return std::find(done.begin(), done.end(), 0) == done.end(); }

  /// Takes over the blocks that are its own; returns how many points are new.
  std::size_t take(const std::vector<MapStore::Block>& blocks) {
    std::size_t taken = 0;
    for (const MapStore::Block& block : blocks) {
      if (block.number < first_number || block.number - first_number >= done.size()) continue;
      const auto at = static_cast<std::size_t>(block.number - first_number);
      if (done[at] != 0 || block.points.size() != size_of(at)) continue;
      std::copy(block.points.begin(), block.points.end(),
                results.begin() + static_cast<std::ptrdiff_t>(at * block_points));
      done[at] = 1;
      taken += block.points.size();
    }
    return taken;
  }
};

/// Runs what this rank has to do of a pass, then waits for the others where `wait` says so; but not once rank 0 has the
/// whole map and has removed the files.
Check run_pass(Pass& pass, const MapRequest& request, const PointRunner& runner, std::optional<MapStore>& store,
               bool wait, MapResult& result, const std::function<void(double)>& progress) {
  if (store) {
    const auto blocks = store->read_all();
    if (!blocks) return blocks.error();
    result.resumed += pass.take(*blocks);
  }
  std::vector<std::size_t> mine;
  for (std::size_t block = 0; block < pass.done.size(); ++block) {
    if (pass.done[block] == 0 && block % request.share.ranks == request.share.rank) mine.push_back(block);
  }
  std::mutex guard;
  Check failure;
  std::atomic<bool> failed = false;
  simulation::for_each_in_parallel(
      mine.size(),
      [&](std::size_t i) {
        if (failed) return;
        const std::size_t block = mine[i], first = block * block_points, count = pass.size_of(block);
        const auto effort = runner.run(std::span(pass.indices).subspan(first, count), pass.results.data() + first);
        const std::lock_guard lock(guard);
        if (!effort) {
          if (!failed.exchange(true)) failure = effort.error();
          return;
        }
        result.ticks += effort->ticks;
        result.lane_ticks += effort->lane_ticks;
        pass.done[block] = 1;
        if (!store) return;
        if (auto error = store->append(pass.first_number + block, pass.results.data() + first, count)) {
          if (!failed.exchange(true)) failure = std::move(error);
        }
      },
      progress, request.threads);
  if (failure) return failure;
  while (wait && !pass.complete() && store->is_there()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    const auto blocks = store->read_all();
    if (!blocks) return blocks.error();
    pass.take(*blocks);
  }
  return {};
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
  std::optional<MapStore> store;
  if (!request.folder.empty()) {
    if (auto error = report::prepare_directory(request.folder)) return *std::move(error);
    auto opened = MapStore::open(request.folder, identity_of(request), request.share.rank);
    if (!opened) return opened.error();
    store.emplace(*std::move(opened));
  }

  const bool single = request.precision == MapPrecision::lanes_of_float;
  const bool several = store && request.share.ranks > 1;
  // In float every rank must know all verdicts, to tell which points to run again.
  const bool waits = several && (single || request.share.rank == 0);
  const PointRunner first_runner{request, *plan, lane_runner(single)};
  MapResult result{.axes = request.axes, .points = {}, .instruction_set = first_runner.lanes.name};
  std::vector<std::size_t> all(*count);
  std::iota(all.begin(), all.end(), std::size_t{0});
  Pass pass(std::move(all), 0);
  if (auto error = run_pass(pass, request, first_runner, store, waits, result, progress)) return *std::move(error);
  result.points = std::move(pass.results);
  if (!single) return result;

  // A verdict that changes in double can put the boundary beside points that are still in float, so until none is left.
  const PointRunner exact_runner{request, *plan, lane_runner(false)};
  std::vector<char> exact(*count);
  for (std::uint64_t number = blocks_a_pass;; number += blocks_a_pass) {
    Pass again(near_boundary(result, exact), number);
    if (again.indices.empty()) return result;
    if (auto error = run_pass(again, request, exact_runner, store, waits, result, progress)) return *std::move(error);
    if (!again.complete()) return result;  // a rank above 0 whose work is no longer wanted
    for (std::size_t i = 0; i < again.indices.size(); ++i) {
      result.points[again.indices[i]] = again.results[i];
      exact[again.indices[i]] = 1;
    }
    result.redone += again.indices.size();
  }
}

void remove_partial(const std::filesystem::path& folder) { MapStore::remove_all(folder); }

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
