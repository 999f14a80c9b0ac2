// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/kernel/mechanics/operator.hpp>
#include <tactus/simulation/experiments/faults/plan.hpp>
#include <tactus/simulation/experiments/faults/schedule.hpp>
#include <tactus/simulation/teleoperator/fault_moment.hpp>

namespace tactus::experiments {

/// What becomes of the operator's hand and buttons. Of a plan that is for something else they do as they are meant to.
class FaultyOperator {
 public:
  enum class Hand { holds, lets_go, is_clamped };

  explicit FaultyOperator(const FaultPlan& plan) : plan_(plan) {}

  /// What holds the handle. Once a tick. Real-time safe.
  [[nodiscard]] Hand hand(const FaultMoment& moment) const noexcept {
    if (!moment.during) return Hand::holds;
    // Nobody touches an arm that is armed for the first time: a hand would bear what its model has too much.
    const bool away = plan_.kind == FaultKind::hand_lets_go || plan_.kind == FaultKind::model_wrong || stuck_in_use();
    if (away) return Hand::lets_go;
    return plan_.kind == FaultKind::handle_clamped ? Hand::is_clamped : Hand::holds;
  }
  /// A handle that moved while the hand was away is taken where it is and led back to the path: what is left, at a
  /// time, of the `away_m` at `now_s`. A hand does not jump there, and an operator does not grip as if it had.
  [[nodiscard]] static constexpr mechanics::MinimumJerk returns_from(double away_m, double now_s) noexcept {
    return {.start_m = away_m, .end_m = 0.0, .start_time_s = now_s, .duration_s = return_s};
  }
  /// How far a clamp has pushed the handle from where it was, and how fast: by `size`, in the time below.
  [[nodiscard]] mechanics::Operator::Output pushed(const FaultMoment& moment) const noexcept {
    const double share = moment.since_s / push_s;
    if (share >= 1.0) return {.position_m = plan_.size, .velocity_m_per_s = 0.0};
    return {.position_m = share * plan_.size, .velocity_m_per_s = plan_.size / push_s};
  }
  /// What reaches a site of what is `pressed`. Once a tick. Real-time safe.
  [[nodiscard]] control::SiteRequests presses(control::SiteRequests pressed, FaultSite site,
                                              const FaultMoment& moment) const noexcept {
    // A dead-man switch in the handle goes with the hand, and is not pressed again by itself; of size 1 it is a pedal.
    const bool in_handle =
        plan_.kind == FaultKind::dead_man_released || (plan_.kind == FaultKind::hand_lets_go && plan_.size == 0.0);
    const bool cleared = moment.since_s > plan_.length_s + fault_schedule::clear_after_s;
    if (in_handle && !moment.before && !cleared) pressed.dead_man = false;
    const bool is_stopped = plan_.kind == FaultKind::emergency_stop || plan_.kind == FaultKind::slow_stop;
    if (is_stopped && moment.during && plan_.site == site) pressed.emergency_stop = true;
    switch (plan_.kind) {
      case FaultKind::dead_man_stuck:
        if (moment.during && plan_.size == 0.0) pressed.dead_man = true;
        break;
      case FaultKind::console_lost:  // its end is a release of all that was pressed
        if (plan_.size == 0.0 && is_noticed(moment, 0.0)) pressed = {};
        break;
      case FaultKind::both_restarted:
        return presses_while_restarted(pressed, moment);
      case FaultKind::stale_commands:  // the operator notices
        if (is_noticed(moment, notices_s)) pressed.dead_man = false;
        break;
      default:
        break;
    }
    return pressed;
  }

 private:
  static constexpr double push_s = 0.3;
  /// How long the return takes: a reach without haste.
  static constexpr double return_s = 0.4;
  static constexpr double notices_s = 0.3;

  /// The dead-man switch sticks while the sites follow, and the operator goes away; else from the start of the session.
  [[nodiscard]] bool stuck_in_use() const noexcept {
    return plan_.kind == FaultKind::dead_man_stuck && plan_.start_s > 0.0;
  }
  /// From so long after the fault began until the operator sets out to arm again.
  [[nodiscard]] bool is_noticed(const FaultMoment& moment, double after_s) const noexcept {
    return !moment.before && moment.since_s >= after_s &&
           moment.since_s <= plan_.length_s + fault_schedule::look_after_s + fault_schedule::button_s;
  }
  /// Everything is pressed when the sites come back, and stays so. Where `size` is not 0 it is pressed in its turn,
  /// after they are back.
  [[nodiscard]] control::SiteRequests presses_while_restarted(control::SiteRequests pressed,
                                                              const FaultMoment& moment) const noexcept {
    const double back_s = moment.since_s - plan_.length_s;
    if (moment.before || back_s > fault_schedule::look_after_s) return pressed;
    if (plan_.size == 0.0) return {.align = true, .arm = true, .clear = true, .dead_man = true};
    return {.align = back_s > 0.02, .arm = back_s > 0.06, .dead_man = back_s > 0.1};
  }

  FaultPlan plan_;
};

}  // namespace tactus::experiments
