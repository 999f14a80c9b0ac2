// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/teleoperator/fault_plan.hpp>

#include <cmath>
#include <cstdint>

namespace tactus::simulation {

/// Where a run is at a tick, as a fault sees it.
struct FaultMoment {
  std::int64_t tick = 0;
  double now_s = 0.0;
  double since_s = 0.0;  ///< the fault began; negative before
  bool before = true;    ///< the fault's first tick is still to come
  bool begins = false;   ///< this is it
  bool during = false;   ///< from the first tick to the end
};

/// A site that missed too many ticks is not armed until that is forgotten: the end of such a fault is left to it.
inline constexpr double forgotten_s = 1.0;
inline bool misses_ticks(const FaultPlan& plan, const FaultMoment& moment) noexcept {
  return moment.during && moment.since_s < plan.length_s - forgotten_s;
}

/// When a fault is there, on a clock of ticks.
class FaultSpan {
 public:
  FaultSpan(double start_s, double end_s, double tick_s)
      : tick_s_(tick_s),
        first_tick_(std::lround(start_s / tick_s)),
        start_s_(static_cast<double>(first_tick_) * tick_s),
        end_s_(end_s) {}

  /// The moment of `tick`. Real-time safe.
  [[nodiscard]] FaultMoment at(std::int64_t tick) const noexcept {
    const double now_s = static_cast<double>(tick) * tick_s_;
    return {.tick = tick,
            .now_s = now_s,
            .since_s = now_s - start_s_,
            .before = tick < first_tick_,
            .begins = tick == first_tick_,
            .during = now_s >= start_s_ && now_s < end_s_};
  }
  /// Everything a tick later.
  void postpone() noexcept {
    start_s_ = static_cast<double>(++first_tick_) * tick_s_;
    end_s_ += tick_s_;
  }
  [[nodiscard]] std::int64_t first_tick() const noexcept { return first_tick_; }
  [[nodiscard]] double end_s() const noexcept { return end_s_; }

 private:
  double tick_s_;
  std::int64_t first_tick_;
  double start_s_;
  double end_s_;
};

}  // namespace tactus::simulation
