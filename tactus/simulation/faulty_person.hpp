#pragma once

#include <tactus/control/site_supervisor.hpp>
#include <tactus/simulation/fault_moment.hpp>

namespace tactus::simulation {

/// What becomes of the person's hand and buttons. Of a plan that is for something else they do as they are meant to.
class FaultyPerson {
 public:
  enum class Hand { holds, lets_go, is_clamped };

  explicit FaultyPerson(const FaultPlan& plan) : plan_(plan) {}

  /// What holds the handle. Once a tick. Real-time safe.
  [[nodiscard]] Hand hand(const FaultMoment& moment) const noexcept {
    if (!moment.during) return Hand::holds;
    if (plan_.kind == FaultKind::hand_lets_go) return Hand::lets_go;
    return plan_.kind == FaultKind::handle_clamped ? Hand::is_clamped : Hand::holds;
  }
  /// What reaches the sites of what is `pressed`. Once a tick. Real-time safe.
  [[nodiscard]] control::SiteRequests presses(control::SiteRequests pressed, const FaultMoment&) const noexcept {
    return pressed;
  }

 private:
  FaultPlan plan_;
};

}  // namespace tactus::simulation
