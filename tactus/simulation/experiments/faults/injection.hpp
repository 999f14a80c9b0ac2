// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/faults/faulty_operator.hpp>
#include <tactus/simulation/experiments/faults/plan.hpp>
#include <tactus/simulation/experiments/faults/schedule.hpp>
#include <tactus/simulation/teleoperator/bad_number.hpp>
#include <tactus/simulation/teleoperator/fault_moment.hpp>
#include <tactus/simulation/teleoperator/faulty_actuator.hpp>
#include <tactus/simulation/teleoperator/faulty_clock.hpp>
#include <tactus/simulation/teleoperator/faulty_encoder.hpp>
#include <tactus/simulation/teleoperator/faulty_force_sensor.hpp>
#include <tactus/simulation/teleoperator/faulty_peer.hpp>
#include <tactus/simulation/teleoperator/faulty_wiring.hpp>

#include <algorithm>
#include <limits>

namespace tactus::experiments {

/// Everything that one plan does to a run: a sound part and a faulty one are the same type.
class FaultInjection {
 public:
  struct Site {
    simulation::FaultyClock clock;
    simulation::FaultyEncoder encoder;
    simulation::FaultyWiring wiring;
    simulation::FaultyActuator actuator;
    simulation::FaultyPeer peer;
    Site(const FaultPlan& plan, FaultSite site, double tick_s)
        : clock(plan, site),
          encoder(plan, site, tick_s),
          wiring(plan, site),
          actuator(plan, site, tick_s),
          peer(plan, site) {}
  };

  FaultInjection(const FaultPlan& plan, double tick_s)
      : master(plan, FaultSite::master, tick_s),
        slave(plan, FaultSite::slave, tick_s),
        force_sensor(plan, tick_s),
        person(plan),
        plan_(plan),
        bad_(simulation::BadNumber::of(plan.choice)),
        span_(start_s(plan, bad_), end_s(plan, bad_), tick_s) {}

  Site master, slave;
  simulation::FaultyForceSensor force_sensor;
  FaultyOperator person;

  [[nodiscard]] Site& at(FaultSite site) noexcept { return site == FaultSite::master ? master : slave; }
  [[nodiscard]] simulation::FaultSpan& span() noexcept { return span_; }
  [[nodiscard]] const simulation::FaultSpan& span() const noexcept { return span_; }
  [[nodiscard]] const FaultMoment& moment() const noexcept { return moment_; }
  void enter(std::int64_t tick) noexcept { moment_ = span_.at(tick); }

  /// A machine sleeps, and its network with it: what was on its way is lost.
  [[nodiscard]] bool sleeps() const noexcept {
    return plan_.kind == FaultKind::suspend && plan_.choice % 2 == 1 && simulation::misses_ticks(plan_, moment_);
  }
  /// No packet passes either way.
  [[nodiscard]] bool cuts() const noexcept {
    return sleeps() || (plan_.kind == FaultKind::cut && moment_.during) || is_prelude(control::SiteState::hold);
  }
  /// What share of its impairment of the network there is now on the link to `site`.
  [[nodiscard]] double impaired_share(FaultSite site) const noexcept {
    if (!moment_.during) return 0.0;
    if (plan_.kind == FaultKind::delay_asymmetric) {
      // A queue fills. A way that were slow at once would be silence, which the watchdog ends.
      return plan_.site == site ? std::min(moment_.since_s / slows_down_s, 1.0) : 0.0;
    }
    return plan_.kind == FaultKind::delay_creeping ? moment_.since_s / plan_.length_s : 1.0;
  }
  /// How wrong `site` is about the age of what comes. Clocks cannot determine a way that takes longer than the other
  /// from an offset between them; once the offset from before is forgotten, half of the difference is taken for one.
  [[nodiscard]] double age_error_s(FaultSite site) const noexcept {
    const bool errs =
        plan_.kind == FaultKind::delay_asymmetric && moment_.during && moment_.since_s > slows_down_s + clock_memory_s;
    return errs ? (plan_.site == site ? -0.5 : 0.5) * plan_.impairment.delay_s : 0.0;
  }
  /// Whether a site takes what the other reports of its agreement as its own would be: for a control, what compares
  /// them is gone.
  [[nodiscard]] bool hides_disagreement() const noexcept {
    const bool told = plan_.kind == FaultKind::configurations_differ || plan_.kind == FaultKind::peer_repeats;
    return told && plan_.size != 0.0;
  }
  /// Puts a bad number into what a site reads, where this is its tick; `input` is a packet or a reading.
  template <class Input>
  void spoil(FaultSite site, Input& input) const noexcept {
    const bool here = bad_.at_master == (site == FaultSite::master);
    if (plan_.kind != FaultKind::bad_number || !here) return;
    if (moment_.begins) bad_.spoil(input);
    if constexpr (requires { input.position_m; }) {
      if (is_prelude(control::SiteState::fault)) input.position_m = std::numeric_limits<double>::quiet_NaN();
    }
  }

 private:
  static constexpr double clock_memory_s = 2.0, slows_down_s = 1.0;

  static double start_s(const FaultPlan& plan, const simulation::BadNumber& bad) {
    return plan.kind == FaultKind::bad_number ? fault_schedule::bad_number_at_s(bad.state) : plan.start_s;
  }
  static double end_s(const FaultPlan& plan, const simulation::BadNumber& bad) {
    // What was inactive before is armed after the usual time of the start.
    if (plan.kind == FaultKind::bad_number) return std::max(start_s(plan, bad), 0.5);
    return plan.start_s + plan.length_s;
  }
  /// What brings a site into the state that a bad number is to meet there.
  [[nodiscard]] bool is_prelude(control::SiteState state) const noexcept {
    using namespace fault_schedule;
    return plan_.kind == FaultKind::bad_number && bad_.state == state && moment_.now_s >= prelude_s &&
           moment_.now_s < prelude_s + prelude_length_s;
  }

  FaultPlan plan_;
  simulation::BadNumber bad_;
  simulation::FaultSpan span_;
  FaultMoment moment_;
};

}  // namespace tactus::experiments
