// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/ticks.hpp>

#include <cstddef>
#include <vector>

namespace tactus::report {

/// Limits of both axes of each panel, and with which panels it has them in common: equal numbers, equal limits.
struct SharedLimits {
  std::vector<Limits> x, y;
  std::vector<std::size_t> x_group, y_group;
};

/// Decides the limits of a figure with `columns` (1 or more) columns. Values that are not finite, or not positive on a
/// logarithmic axis, do not count, nor do values of y whose x lies outside the limits of x. Where panels share limits,
/// the widest of those that are set wins.
SharedLimits shared_limits(const Figure& figure, std::size_t columns);

bool is_logarithmic(const Axis& axis);

}  // namespace tactus::report
