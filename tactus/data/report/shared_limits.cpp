// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/shared_limits.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

namespace tactus::report {
namespace {

/// For each panel the first one with which it has its limits in common. `line_of(i)` is its column or row.
std::vector<std::size_t> groups(const Figure& figure, Axis Panel::*axis, Sharing sharing,
                                const std::function<std::size_t(std::size_t)>& line_of) {
  const auto together = [&](std::size_t a, std::size_t b) {
    const Axis& first = figure.panels[a].*axis;
    const Axis& second = figure.panels[b].*axis;
    if (first.scale != second.scale) return false;
    if (sharing == Sharing::in_line) return line_of(a) == line_of(b);
    return sharing == Sharing::by_quantity && first.label == second.label && first.unit == second.unit;
  };
  std::vector<std::size_t> group(figure.panels.size());
  for (std::size_t i = 0; i < group.size(); ++i) {
    while (group[i] < i && !together(group[i], i)) ++group[i];
  }
  return group;
}

/// Grows an interval by the values that an axis can show.
class Extent {
 public:
  explicit Extent(bool logarithmic) : logarithmic_(logarithmic) {}
  [[nodiscard]] bool shows(double value) const { return std::isfinite(value) && (!logarithmic_ || value > 0.0); }
  void add(double value) {
    if (!shows(value)) return;
    if (!limits_) limits_ = Limits{value, value};
    limits_->lower = std::min(limits_->lower, value);
    limits_->upper = std::max(limits_->upper, value);
  }
  [[nodiscard]] std::optional<Limits> limits() const { return limits_; }

 private:
  bool logarithmic_;
  std::optional<Limits> limits_;
};

/// Limits of one axis of all panels. `add(extent, panel index)` puts the panel's values in.
template <class Add>
std::vector<Limits> limits_of(const Figure& figure, Axis Panel::*axis, const std::vector<std::size_t>& group,
                              double air, Add&& add) {
  const std::size_t count = figure.panels.size();
  std::vector<Limits> limits(count);
  for (std::size_t first = 0; first < count; ++first) {
    if (group[first] != first) continue;
    const bool logarithmic = is_logarithmic(figure.panels[first].*axis);
    Extent extent(logarithmic);
    std::optional<double> lower;
    std::optional<double> upper;
    for (std::size_t i = first; i < count; ++i) {
      if (group[i] != first) continue;
      const Axis& own = figure.panels[i].*axis;
      if (own.lower) lower = std::min(lower.value_or(*own.lower), *own.lower);
      if (own.upper) upper = std::max(upper.value_or(*own.upper), *own.upper);
      add(extent, i);
    }
    const Limits shared = axis_limits(extent.limits(), lower, upper, logarithmic, air);
    for (std::size_t i = first; i < count; ++i) {
      if (group[i] == first) limits[i] = shared;
    }
  }
  return limits;
}

void add_rules(Extent& extent, const Panel& panel, Rule::Direction direction) {
  for (const Rule& rule : panel.rules) {
    if (rule.direction == direction) extent.add(rule.at);
  }
}

std::vector<Limits> x_limits(const Figure& figure, const std::vector<std::size_t>& group) {
  return limits_of(figure, &Panel::x, group, 0.0, [&](Extent& extent, std::size_t i) {
    const Panel& panel = figure.panels[i];
    const Extent other(is_logarithmic(panel.y));
    for (const Line& line : panel.lines) {
      for (std::size_t k = 0; k < std::min(line.x.size(), line.y.size()); ++k) {
        if (other.shows(line.y[k])) extent.add(line.x[k]);
      }
    }
    for (const Bars& bars : panel.bars) {
      extent.add(0.0);
      for (const double length : bars.lengths) extent.add(length);
    }
    add_rules(extent, panel, Rule::Direction::vertical);
  });
}

/// Only what lies within the limits of x counts.
std::vector<Limits> y_limits(const Figure& figure, const std::vector<std::size_t>& group,
                             const std::vector<Limits>& x) {
  return limits_of(figure, &Panel::y, group, 0.06, [&](Extent& extent, std::size_t i) {
    const Panel& panel = figure.panels[i];
    for (const Line& line : panel.lines) {
      for (std::size_t k = 0; k < std::min(line.x.size(), line.y.size()); ++k) {
        if (line.x[k] >= x[i].lower && line.x[k] <= x[i].upper) extent.add(line.y[k]);
      }
    }
    add_rules(extent, panel, Rule::Direction::horizontal);
  });
}

}  // namespace

bool is_logarithmic(const Axis& axis) { return axis.scale == Axis::Scale::logarithmic; }

SharedLimits shared_limits(const Figure& figure, std::size_t columns) {
  SharedLimits shared;
  shared.x_group = groups(figure, &Panel::x, figure.share_x, [&](std::size_t i) { return i % columns; });
  shared.y_group = groups(figure, &Panel::y, figure.share_y, [&](std::size_t i) { return i / columns; });
  shared.x = x_limits(figure, shared.x_group);
  shared.y = y_limits(figure, shared.y_group, shared.x);
  return shared;
}

}  // namespace tactus::report
