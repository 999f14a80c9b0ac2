// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/stability/map.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <optional>
#include <string>

namespace tactus::stability {

/// What `tactus stability map` prints and writes alongside CSV and HDF5.
struct MapReport {
  std::string text;                ///< for a terminal
  std::string json;                ///< one document: axes with units, shares of the verdicts, limits
  std::string html;                ///< a self-contained page
  std::optional<std::string> svg;  ///< where the last two axes span a plane
};

/// `elapsed_s`: what the map took in this process. `request` names the experiment and the command.
MapReport report_map(const MapResult& map, const MapParams& base, double elapsed_s,
                     const experiments::Request& request);

}  // namespace tactus::stability
