// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/map.hpp>
#include <tactus/data/report/heat_map.hpp>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

/// A map as a picture.
namespace tactus::stability {

/// A plane of the last two axes: what its other axes have, and where its points begin. Of a map with no such plane, one
/// for all points.
struct MapPlane {
  std::string title;
  std::size_t first = 0;
  std::size_t points = 0;
};

/// Whether the last two axes are numbers that can span a plane.
bool has_planes(const MapResult& map);
/// The planes in the order of their points.
std::vector<MapPlane> planes_of(const MapResult& map);

/// What an axis is called in a picture, for instance `environment stiffness`; its unit is apart.
std::string label_of(const MapAxis& axis);

struct MapPicture {
  report::HeatMap map;
  std::string caption;
};

/// One plane after the other with the verdicts, and the limit as a line. With three axes of numbers and more than four
/// planes, instead, the limit over the first and the last axis. Nothing for a map without planes.
std::optional<MapPicture> picture_of(const MapResult& map);

}  // namespace tactus::stability
