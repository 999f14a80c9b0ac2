// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/curve.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <optional>
#include <utility>

namespace tactus::report {
namespace {

bool finite(Point point) { return std::isfinite(point.x) && std::isfinite(point.y); }

/// Near enough for differences not to overflow, far enough for a line that leaves the frame to keep its slope.
Point bounded(Point point) { return {std::clamp(point.x, -1e9, 1e9), std::clamp(point.y, -1e9, 1e9)}; }

/// A position on the grid of 0.1 px that the file can hold.
struct GridPoint {
  long long x, y;
  bool operator==(const GridPoint&) const = default;
};

GridPoint on_grid(Point point) { return {std::llround(point.x * 10.0), std::llround(point.y * 10.0)}; }

/// Tenths of a pixel as text; a sign or point separates it from what stands before, else a blank does.
void append(std::string& text, long long tenths, bool separate) {
  const long long magnitude = std::llabs(tenths);
  if (tenths < 0) {
    text += '-';
  } else if (separate) {
    text += ' ';
  }
  if (magnitude >= 10 || magnitude == 0) text += std::to_string(magnitude / 10);
  if (magnitude % 10 != 0) text += '.' + std::to_string(magnitude % 10);
}

/// The part of a segment within the frame (Liang and Barsky 1984), or nothing.
std::optional<std::array<Point, 2>> clip(Point from, Point to, const Rectangle& frame) {
  const double dx = to.x - from.x;
  const double dy = to.y - from.y;
  double begin = 0.0;
  double end = 1.0;
  const std::array<std::array<double, 2>, 4> edges{{{-dx, from.x - frame.left},
                                                    {dx, frame.right() - from.x},
                                                    {-dy, from.y - frame.top},
                                                    {dy, frame.bottom() - from.y}}};
  for (const auto& [direction, room] : edges) {
    if (direction == 0.0) {
      if (room < 0.0) return std::nullopt;
    } else if (direction < 0.0) {
      begin = std::max(begin, room / direction);
    } else {
      end = std::min(end, room / direction);
    }
  }
  if (begin > end) return std::nullopt;
  return std::array<Point, 2>{Point{from.x + begin * dx, from.y + begin * dy},
                              Point{from.x + end * dx, from.y + end * dy}};
}

/// Collects the strokes of a path in relative coordinates, joining those that run on in the same direction.
class Pen {
 public:
  /// Draws from one point to another, lifting only where the last stroke ended elsewhere.
  void stroke(GridPoint from, GridPoint to) {
    if (!drawing_ || !(from == position_)) move(from);
    const long long dx = to.x - position_.x;
    const long long dy = to.y - position_.y;
    if (pending_ && dx * run_.y == dy * run_.x && dx * run_.x + dy * run_.y >= 0) {
      run_ = {run_.x + dx, run_.y + dy};
    } else {
      flush();
      run_ = {dx, dy};
      pending_ = true;
    }
    position_ = to;
  }

  void lift() {
    flush();
    drawing_ = false;
  }

  std::string finish() {
    lift();
    return std::move(path_);
  }

 private:
  void move(GridPoint to) {
    flush();
    path_ += 'M';
    append(path_, to.x, false);
    append(path_, to.y, true);
    position_ = to;
    drawing_ = true;
    relative_ = false;
  }

  void flush() {
    if (!pending_) return;
    if (!relative_) path_ += 'l';
    append(path_, run_.x, relative_);
    append(path_, run_.y, true);
    relative_ = true;
    pending_ = false;
  }

  std::string path_;
  GridPoint position_{};
  GridPoint run_{};
  bool drawing_ = false;
  bool relative_ = false;
  bool pending_ = false;
};

}  // namespace

std::string pixels(double length) {
  std::string text;
  append(text, on_grid({length, 0.0}).x, false);
  return text;
}

std::vector<Point> thin(const std::vector<Point>& points) {
  std::vector<Point> kept;
  for (std::size_t begin = 0; begin < points.size();) {
    std::size_t end = begin + 1;
    if (finite(points[begin])) {
      const double column = std::floor(points[begin].x);
      while (end < points.size() && finite(points[end]) && std::floor(points[end].x) == column) ++end;
    }
    const auto run = points.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto by_height = [](Point a, Point b) { return a.y < b.y; };
    const auto [low, high] = std::minmax_element(run, points.begin() + static_cast<std::ptrdiff_t>(end), by_height);
    std::array<std::size_t, 4> chosen{begin, static_cast<std::size_t>(low - points.begin()),
                                      static_cast<std::size_t>(high - points.begin()), end - 1};
    std::sort(chosen.begin(), chosen.end());
    const auto last = std::unique(chosen.begin(), chosen.end());
    for (auto i = chosen.begin(); i != last; ++i) kept.push_back(points[*i]);
    begin = end;
  }
  return kept;
}

std::string path_data(const std::vector<Point>& points, const Rectangle& frame) {
  Pen pen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!finite(points[i])) {
      pen.lift();
      continue;
    }
    const bool joined = i + 1 < points.size() && finite(points[i + 1]);
    const bool alone = !joined && (i == 0 || !finite(points[i - 1]));
    if (!joined && !alone) continue;
    const auto visible = clip(bounded(points[i]), bounded(points[joined ? i + 1 : i]), frame);
    if (visible) pen.stroke(on_grid((*visible)[0]), on_grid((*visible)[1]));
  }
  return pen.finish();
}

}  // namespace tactus::report
