// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/units.hpp>

#include <optional>
#include <span>
#include <string>

namespace tactus::diagnosis {

/// A velocity that was recorded alongside a position, as a drive or its host reports it.
struct ReportedVelocity {
  std::string name = {};  ///< of its column
  double scale = 1.0;     ///< the reported velocity over that with which the position moves, without sign
  /// The reported one differs by a tenth or more: whoever reads or commands it has a wrong range for it.
  [[nodiscard]] bool wrong() const { return scale > 1.1 || scale < 1.0 / 1.1; }
};

/// What the integral of the velocity over stretches of 50 ms is over the way that the position went in them, by least
/// squares, whatever the signal's frequency. None where the position hardly moves or the two do not go together (a
/// tenth of the velocity's power is left). Position in m or rad, velocity in m/s or rad/s. Not real-time safe.
std::optional<double> reported_scale(std::span<const double> position, std::span<const double> velocity, Seconds dt);

}  // namespace tactus::diagnosis
