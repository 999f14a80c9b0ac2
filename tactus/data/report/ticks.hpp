// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tactus::report {

/// Where an axis is marked. A label reads in units of 10^`exponent` of the axis' own unit.
struct Ticks {
  std::vector<double> major;        ///< ascending, within the limits; lines of the grid
  std::vector<std::string> labels;  ///< one for each of `major`
  std::vector<double> minor;        ///< unlabelled subdivisions of a logarithmic axis, ascending
  int exponent = 0;
};

/// Multiples of 1, 2 or 5 times a power of ten within [`lower`, `upper`], `lower` < `upper`: the finest such step that
/// gives at most `most` (2 or more) of them. Labels have the decimals that the step needs and a typographic minus.
/// Beyond 1e5 and below 1e-3 a common power of ten, a multiple of three, is taken out of the labels.
Ticks linear_ticks(double lower, double upper, int most);

/// Powers of ten within [`lower`, `upper`], 0 < `lower` < `upper`, thinned to at most `most` (2 or more), with 2 to 9
/// times each as `minor`. Where fewer than two powers of ten lie within, 1-2-5 steps are labelled, and where even those
/// are too few, the ticks of a linear axis.
Ticks logarithmic_ticks(double lower, double upper, int most);

/// An interval of values.
struct Limits {
  double lower, upper;
};

/// Limits of an axis that shows `data`, or nothing without data: a set limit wins over the data; the free ends
/// get `margin` times the span of air. Equal or missing ends are spread, so that always `lower` < `upper`, both finite
/// and, on a logarithmic axis, positive. A set limit that is not finite, or not positive on a logarithmic axis, is
/// ignored; so are two that leave nothing between them. Magnitudes end at 1e300.
Limits axis_limits(std::optional<Limits> data, std::optional<double> lower, std::optional<double> upper,
                   bool logarithmic, double margin);

}  // namespace tactus::report
