// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/experiments/faults/fault_operator.hpp>
#include <tactus/simulation/experiments/faults/injection.hpp>
#include <tactus/simulation/teleoperator/site_plants.hpp>

#include <algorithm>
#include <vector>

namespace tactus::experiments {

/// What holds the master's handle from tick to tick, as the faults have it: the operator's hand, nobody, or a clamp.
class FaultHandle {
 public:
  explicit FaultHandle(const mechanics::LinearSpring::Params& grip) : grip_(grip) {}

  /// Holds the handle of `plant` as it is held at this tick, and leads it for `tick_s`. Once a tick, after what the
  /// plant is commanded and before its substeps.
  void lead(simulation::MasterPlant& plant, const FaultOperator& person, const std::vector<FaultInjection>& injections,
            double tick_s) {
    const double now_s = injections.front().moment().now_s;
    hold(plant, person, injections, now_s);
    if (hand_ == Hand::holds) {
      const auto meant_m = [&](double time_s) { return person.path_m(time_s) + returns_.position_m(time_s); };
      plant.begin_tick(meant_m(now_s), meant_m(now_s + tick_s));
    } else {
      // A hand that is away corrects nothing.
      plant.begin_tick(clamped(injections));
    }
  }

 private:
  using Hand = FaultyOperator::Hand;
  /// What a clamp holds a handle with.
  static constexpr mechanics::LinearSpring::Params clamp{.stiffness_N_per_m = 20000.0, .damping_N_s_per_m = 50.0};

  /// releases the handle, clamps it or takes it again.
  void hold(simulation::MasterPlant& plant, const FaultOperator& person, const std::vector<FaultInjection>& injections,
            double now_s) {
    Hand hand = Hand::holds;
    for (const FaultInjection& injection : injections) {
      hand = std::max(hand, injection.person.hand(injection.moment()));
    }
    if (hand == hand_) return;
    hand_ = hand;
    const double handle_m = plant.mechanism().tip_position_m();
    clamped_at_m_ = handle_m;
    if (hand == Hand::holds) {
      returns_ = FaultyOperator::returns_from(handle_m - person.path_m(now_s), now_s);
      plant.take_again(grip_);
    } else {
      plant.hold(hand == Hand::lets_go ? mechanics::nobody_holds : clamp);
    }
  }
  /// Where the clamp that holds the handle wants it.
  [[nodiscard]] mechanics::Operator::Output clamped(const std::vector<FaultInjection>& injections) const {
    for (const FaultInjection& injection : injections) {
      if (injection.person.hand(injection.moment()) != Hand::is_clamped) continue;
      const mechanics::Operator::Output pushed = injection.person.pushed(injection.moment());
      return {.position_m = clamped_at_m_ + pushed.position_m, .velocity_m_per_s = pushed.velocity_m_per_s};
    }
    return {.position_m = clamped_at_m_, .velocity_m_per_s = 0.0};
  }

  mechanics::LinearSpring::Params grip_;
  Hand hand_ = Hand::holds;
  double clamped_at_m_ = 0.0;
  mechanics::MinimumJerk returns_;  ///< how far off its path the hand still leads a handle that it took again
};

}  // namespace tactus::experiments
