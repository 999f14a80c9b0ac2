// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

/// From data to the path of a line in a picture. Lengths are in px, y grows downward.
namespace tactus::report {

struct Point {
  double x, y;
};

struct Rectangle {
  double left, top, width, height;
  [[nodiscard]] double right() const { return left + width; }
  [[nodiscard]] double bottom() const { return top + height; }
};

/// A length rounded to 0.1 px, as short as it can be written (`12.5`, `-.3`, `7`), the same in every locale.
std::string pixels(double length);

/// At most four points for each run of consecutive points within one pixel column: the first, the lowest, the highest
/// and the last, in their order, so that no peak is lost. A point that is not finite stays, as a break.
std::vector<Point> thin(const std::vector<Point>& points);

/// The path data (attribute `d`) of the polyline through `points`, cut off at the edges of `frame`. A point that is not
/// finite breaks the line; a point alone becomes a dot. Points on a straight run are joined.
std::string path_data(const std::vector<Point>& points, const Rectangle& frame);

}  // namespace tactus::report
