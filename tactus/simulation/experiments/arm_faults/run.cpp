// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/station/step.hpp>
#include <tactus/simulation/experiments/arm_faults/arm_faults.hpp>
#include <tactus/simulation/experiments/arm_faults/arm_operator.hpp>
#include <tactus/simulation/experiments/arm_faults/faulty_arm.hpp>
#include <tactus/simulation/experiments/arm_faults/injection.hpp>
#include <tactus/simulation/experiments/faults/judge.hpp>
#include <tactus/simulation/experiments/faults/schedule.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace tactus::experiments {

namespace {

/// A motor that pushes with less than this share of its site's torque limit has let go.
constexpr double released_torque_share = 0.05;
/// How far a joint may coast beyond where its gate latches a fault, as a factor.
constexpr double joint_coasting = 1.1;

}  // namespace

/// One plan, tick by tick.
class ArmFaultRun {
 public:
  ArmFaultRun(const ArmFaultBench& bench, const FaultPlan& plan, station::SupervisedArms first,
              station::SupervisedArms again)
      : rig_(bench.setup.params.rig),
        held_leader_(bench.held_leader()),
        follower_arm_(bench.setup.follower.arm),
        tries_motors_(is_wired_so(plan)),
        tick_s_(bench.tick_s()),
        steps_(static_cast<int>(std::lround(tick_s_ / bench.setup.leader.arm.step_s))),
        step_s_(bench.setup.leader.arm.step_s),
        injections_{ArmFaultInjection(plan, bench.leader_gates.size(), tick_s_)},
        person_(bench, plan),
        wall_(person_.wall()),
        leader_(FaultSite::master, std::move(first.leader), std::move(again.leader), bench.leader, bench.leader_gates,
                bench.setup.leader, bench.leader_watch, plan, rig_.supervision.packets, tick_s_),
        follower_(FaultSite::slave, std::move(first.follower), std::move(again.follower), bench.follower,
                  bench.follower_gates, bench.setup.follower, bench.follower_watch, plan, rig_.supervision.packets,
                  tick_s_),
        judge_({0.0, 0.0, released_torque_share * rig_.leader_gate.force_limit_N, tick_s_},
               {0.0, 0.0, released_torque_share * rig_.follower_gate.force_limit_N, tick_s_}, tick_s_),
        ticks_(std::lround((end_s() + fault_schedule::end_after_s) / tick_s_)) {
    outcome_.arms.emplace();
    leader_.sent.expect(leader_.restarted.size() + 1, ticks_);
    follower_.sent.expect(follower_.restarted.size() + 1, ticks_);
  }

  FaultOutcome run() {
    for (tick_ = 0; tick_ < ticks_; ++tick_) {
      injection().enter(tick_);
      step_site(leader_, follower_);
      step_site(follower_, leader_);
      judge();
      advance();
    }
    return outcome_;
  }

 private:
  using Leader = FaultyArm<control::JointSupervisedMaster>;
  using Follower = FaultyArm<control::JointSupervisedSlave>;

  [[nodiscard]] ArmFaultInjection& injection() { return injections_.front(); }
  [[nodiscard]] const ArmFaultInjection& injection() const { return injections_.front(); }
  [[nodiscard]] const FaultMoment& moment() const { return injection().moment(); }
  [[nodiscard]] double end_s() const { return injection().span().end_s(); }
  [[nodiscard]] bool nobody_holds() const { return injection().person.hand(moment()) == FaultyOperator::Hand::lets_go; }

  template <class Here, class There>
  void step_site(Here& here, There& there) {
    here.sensed = here.read(tick_);
    injection().misread(here.where, here.sensed);
    here.loses_power = injection().is_without_power(here.where);
    if (here.process.fare(injections_, false)) {
      here.site = std::move(here.restarted.back());
      here.restarted.pop_back();
      there.sent.restart();
    }
    here.process.collect(here.inbox, tick_, injections_);
    if (here.process.stands_still()) {
      here.goes_on(injection(), tick_s_);
    } else {
      const control::SiteRequests pressed = injection().person.presses(
          FaultOperator::presses(moment().now_s, end_s(), judge_.rearms()), here.where, moment());
      ArmFaultWay<Here, There> way{.here = here, .there = there, .injection = injection(), .tick_s = tick_s_};
      const station::Tick now{.number = tick_, .missed = here.process.elapsed_ticks() - 1};
      here.looks(here.process.elapsed_ticks());
      ArmDrives<Here> drives{.arm = here, .injection = injection()};
      const auto done = station::step(here.site, drives, way, now, pressed);
      there.sent.applied(done.output.record, tick_, outcome_);
    }
    here.witness(outcome_);
    here.is_carried(tick_s_, tries_motors_ ? rig_.support.raise_s : rig_.supervision.blend_s);
    // Who clears a fault has caught the arm before.
    if (!moment().before && moment().now_s > end_s() + fault_schedule::look_after_s) {
      here.is_caught(here.where == FaultSite::master ? held_leader_ : follower_arm_);
    }
  }

  /// What is true of an arm, for the judge.
  template <class Here>
  FaultJudge::SiteView view(Here& here, const ArmWay& way, double outside_N) {
    const arm_plants::ToolState tool = here.arm.plant().tool();
    const bool seen = !moment().before && moment().now_s <= end_s() + fault_schedule::look_after_s;
    const bool tried = tries_motors_ && here.site.state() == control::SiteState::armed;
    const auto sunk = here.sinks(tool.position_m.z(), !tried && (here.where == FaultSite::slave || nobody_holds()));
    ArmHarm& harm = *outcome_.arms;
    if (seen) {
      harm.fastest_joint_share = std::max(harm.fastest_joint_share, here.fastest_joint_share());
      harm.sank_m = std::max(harm.sank_m, sunk.carried_m);
      harm.fell_m = std::max(harm.fell_m, sunk.fell_m);
    }
    FaultJudge::SiteView view{.state = here.site.state(),
                              .gone = here.process.killed(),
                              .step_N = here.step_N(),
                              .left_workspace = here.is_beyond(joint_coasting * control::SafetyGate::fault_factor)};
    view.truth.outside_N = outside_N;
    view.truth.worked_J = here.has_power() ? here.worked_J : 0.0;
    here.worked_J = 0.0;
    if (!here.has_power()) return view;
    here.put_push(view.truth, (here.where == FaultSite::master ? rig_.leader_gate : rig_.follower_gate).force_limit_N);
    view.truth.tip_m = way.apart_m(tool.position_m);
    view.truth.tip_m_per_s = tool.velocity_m_per_s.norm();
    return view;
  }
  void judge() {
    const FaultJudge::SiteView leader = view(leader_, person_.leader_way(), person_.hand_N());
    const FaultJudge::SiteView follower = view(follower_, person_.follower_way(), contact_N_);
    judge_.see(leader, follower, moment(), end_s(), outcome_);
  }

  void advance() {
    person_.begin_tick(moment(), tick_s_, nobody_holds(), leader_.arm.plant().tool());
    contact_N_ = 0.0;
    for (int i = 0; i < steps_; ++i) {
      leader_.step(person_.force(leader_.arm.plant().tool(), i * step_s_));
      const arm_plants::ToolForce contact{.force_N = wall_.force_N(follower_.arm.plant().tool())};
      contact_N_ = std::max(contact_N_, contact.force_N.norm());
      follower_.step(contact);
    }
  }

  ArmRigParams rig_;
  arm_plants::ArmPlant::Params held_leader_, follower_arm_;
  bool tries_motors_;
  double tick_s_;
  int steps_;
  double step_s_;
  std::vector<ArmFaultInjection> injections_;  ///< one
  ArmFaultOperator person_;
  arm_plants::Wall wall_;
  Leader leader_;
  Follower follower_;
  FaultJudge judge_;
  FaultOutcome outcome_;
  double contact_N_ = 0.0;  ///< largest at the tick before
  std::int64_t tick_ = 0;
  std::int64_t ticks_;
};

FaultOutcome run_arm_fault(const ArmFaultBench& bench, const FaultPlan& plan) {
  const auto started = [&](std::int64_t session) {
    return *station::supervise_arms(bench.setup.params, bench.setup, bench.leader_limits, bench.follower_limits,
                                    {.leader_session = session,
                                     .follower_session = session + 1,
                                     .tries_motors = is_wired_so(plan),
                                     .judges_support = is_wired_so(plan)});
  };
  return ArmFaultRun(bench, plan, started(1), started(3)).run();
}

}  // namespace tactus::experiments
