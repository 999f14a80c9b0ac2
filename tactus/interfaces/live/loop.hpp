// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/messages.hpp>

#include <array>

namespace tactus::live {

/// Where a hand is, in m from rest: toward the wall first, then along the two directions across.
using HandPoint = std::array<double, 3>;

/// What runs under the visitor's hand: a pair of devices with their sites, operator and wall, in virtual time. The
/// loop's thread alone calls it, between `make` and destruction.
class Loop {
 public:
  Loop() = default;
  Loop(const Loop&) = delete;
  Loop& operator=(const Loop&) = delete;
  virtual ~Loop() = default;

  /// One tick, while the operator means to be at `path` now and at `path_at_next_tick` then. Writes what it did into
  /// `tick`: the record, along the wall's normal, and what arms are about where there are any. `share` is that of the
  /// controllers' forces. Does not allocate.
  virtual void step(const HandPoint& path, const HandPoint& path_at_next_tick, double share,
                    LoopTick& tick) noexcept = 0;
  /// False once a safety gate latched, a number was none, or a device left its workspace.
  [[nodiscard]] virtual bool good() const noexcept = 0;
  /// No site commands a force.
  [[nodiscard]] virtual bool at_rest() const noexcept = 0;
  [[nodiscard]] virtual double tick_s() const noexcept = 0;
  /// Continues with those parts of `made` for which that was made, which gets the own ones. Of the same kind. Does not
  /// allocate; may take as long as a thousand ticks.
  virtual void exchange(Loop& made) noexcept = 0;
};

}  // namespace tactus::live
