// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/signal/random.hpp>
#include <tactus/simulation/teleoperator/fault_moment.hpp>

#include <cstdint>

namespace tactus::simulation {

/// What a faulty encoder reports of a true reading. Of a plan that is for another part or site it is a sound one.
///
/// One that counts the wrong way or with a wrong scale does so from where the fault began: x₀ + s·(x − x₀). One whose
/// shaft slips loses a share of the motion toward the environment, so the error grows with every stroke.
class FaultyEncoder {
 public:
  FaultyEncoder(const FaultPlan& plan, FaultSite site, double tick_s)
      : plan_(plan),
        here_(plan.site == site),
        tick_s_(tick_s),
        noise_(signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(4)) {}

  /// The reading in m that reaches the site, from the true one. Once a tick. Real-time safe but for the unbounded, on
  /// average 1.4, draws of the noise.
  double step(double position_m, const FaultMoment& moment) noexcept {
    const double moved_m = position_m - before_m_;
    before_m_ = position_m;
    if (moment.before || moment.begins) began_m_ = position_m;
    if (!here_) return position_m;
    if (plan_.kind == FaultKind::encoder_spike) return moment.begins ? position_m + plan_.size : position_m;
    if (!moment.during) return position_m;
    switch (plan_.kind) {
      case FaultKind::encoder_wrap:
        return position_m + plan_.size;
      case FaultKind::encoder_freeze:
        return began_m_;
      case FaultKind::encoder_reversed:
        return began_m_ - (position_m - began_m_);
      case FaultKind::encoder_scale:
        return began_m_ + plan_.size * (position_m - began_m_);
      case FaultKind::encoder_slip:
        if (moved_m > 0.0 && !moment.begins) lost_m_ += plan_.size * moved_m;
        return position_m - lost_m_;
      case FaultKind::encoder_drift:
        lost_m_ += plan_.size * tick_s_;
        return position_m + lost_m_;
      case FaultKind::encoder_noise:
        return position_m + plan_.size * noise_.normal();
      default:
        return position_m;
    }
  }

 private:
  FaultPlan plan_;
  bool here_;
  double tick_s_;
  signal::Random noise_;
  double began_m_ = 0.0;  ///< the reading when the fault began
  double before_m_ = 0.0;
  double lost_m_ = 0.0;  ///< by slip or drift, so far
};

}  // namespace tactus::simulation
