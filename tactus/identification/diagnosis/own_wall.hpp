// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/units.hpp>

#include <cstddef>
#include <optional>
#include <span>

namespace tactus::diagnosis {

/// A force that a controller computes from the position of the device that it drives, and from nothing else: a virtual
/// wall or spring. It needs no follower.
struct OwnWall {
  /// Share of the force's variance that the law explains: `switched`, one level beyond a position and another before
  /// it; else a spring that pushes back from a position on, up to the largest force, and nothing before it.
  double explained = 0.0;
  double delay_s = 0.0;  ///< of the position that explains it best
  double held_s = 0.0;   ///< for how long the force keeps one value while the device moves; 0 where that is not visible
  bool switched = false;
};

/// How well a wall explains the force that pushes the device back. The position may be late by 20 ms at most, and by no
/// more than a sixth of a period of `frequency_Hz`. A force that pulls is explained by 0, for a wall only pushes back.
/// None for a force that hardly changes. Not real-time safe.
std::optional<OwnWall> find_own_wall(std::span<const double> force, std::span<const double> position,
                                     double frequency_Hz, Seconds dt);

}  // namespace tactus::diagnosis
