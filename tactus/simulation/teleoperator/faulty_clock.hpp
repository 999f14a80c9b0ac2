// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/signal/random.hpp>
#include <tactus/simulation/teleoperator/fault_moment.hpp>

#include <cmath>

namespace tactus::simulation {

/// Whether a site's process lives and is stepped at a tick. Of a plan that is for another part or site it always is.
class FaultyClock {
 public:
  FaultyClock(const FaultPlan& plan, FaultSite site)
      : plan_(plan),
        here_(plan.site == site || plan.kind == FaultKind::both_restarted),
        random_(signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(10)),
        go_s_(plan.size * random_.uniform(0.25, 1.0)) {}

  enum class Beat {
    steps,
    stands,  ///< not stepped: its motor keeps the last force
    sleeps,  ///< as above, and the site's own clock with it
    dead     ///< the process is gone; started again with the next beat
  };
  /// Once a tick. A clock that `sleeps` already counts nothing, so a second drift takes its share of what the first
  /// leaves. Real-time safe.
  Beat step(const FaultMoment& moment, bool sleeps) noexcept {
    if (!here_ || !moment.during) return Beat::steps;
    switch (plan_.kind) {
      case FaultKind::restart:
      case FaultKind::both_restarted:
        return Beat::dead;
      case FaultKind::stall:
        return Beat::stands;
      case FaultKind::overload:  // `size` is the share of ticks that are missed
        return misses_ticks(plan_, moment) && random_.uniform() < plan_.size ? Beat::stands : Beat::steps;
      case FaultKind::stop_and_go:  // `size` is how long each stall lasts, in s
        return misses_ticks(plan_, moment) && std::fmod(moment.since_s, plan_.size + go_s_) < plan_.size ? Beat::stands
                                                                                                         : Beat::steps;
      case FaultKind::suspend:  // one half of the plans stops the process, the other the machine
        if (!misses_ticks(plan_, moment)) return Beat::steps;
        return plan_.choice % 2 == 0 ? Beat::stands : Beat::sleeps;
      case FaultKind::rate_drift:  // `size` is by what share the clock is slow
        if (sleeps) return Beat::sleeps;
        behind_ticks_ += plan_.size;
        if (behind_ticks_ < 1.0) return Beat::steps;
        behind_ticks_ -= 1.0;
        return Beat::sleeps;
      default:
        return Beat::steps;
    }
  }

 private:
  FaultPlan plan_;
  bool here_;
  signal::Random random_;
  double go_s_;
  double behind_ticks_ = 0.0;
};

}  // namespace tactus::simulation
