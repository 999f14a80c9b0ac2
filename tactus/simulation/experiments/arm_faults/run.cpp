// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/kernel/core/binding.hpp>
#include <tactus/kernel/station/step.hpp>
#include <tactus/kernel/station/watched_arm.hpp>
#include <tactus/simulation/experiments/arm_faults/arm_faults.hpp>
#include <tactus/simulation/experiments/arm_faults/arm_operator.hpp>
#include <tactus/simulation/experiments/arm_faults/faulty_arm.hpp>
#include <tactus/simulation/experiments/arm_faults/faulty_configuration.hpp>
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

/// The arm on a rest that bears it where it is: no joint gives way to its weight.
arm_plants::ArmDevice on_a_rest(const arm_plants::ArmDevice& arm, arm_plants::ArmPlant::Params made) {
  const arm::JointVector at = arm.plant().link_position(), bearing = arm.plant().bearing_torque();
  for (std::size_t i = 0; i < made.chain.joints.size(); ++i) {
    const auto joint = static_cast<Eigen::Index>(i);
    auto& limits = made.chain.joints[i].limits;
    (bearing[joint] > 0.0 ? limits.lower_rad : limits.upper_rad) = at[joint];
  }
  return {*arm_plants::ArmPlant::make(made, at), arm.limits()};
}

/// Where an arm is before anybody arms it. What a wrong model makes of one is seen only where it can go up.
arm_plants::ArmDevice lies(const arm_plants::ArmDevice& arm, const arm_plants::ArmPlant::Params& made,
                           const FaultPlan& plan) {
  return plan.kind == FaultKind::model_wrong ? on_a_rest(arm, made) : arm;
}

/// What the programs of both sites have, and both starts of their sites.
struct Programs {
  FaultyArmConfiguration leader, follower;
  arm_control::MotorWatch leader_watch, follower_watch;
  station::SupervisedArms first, again;
};

control::Agreement agreement_of(station::AgreedArms agreed) {
  std::vector<Binding> values;
  append_bindings(agreed, {}, values);
  return control::agreement_of(values);
}

/// Errors: those of the sites, which no program starts then.
Result<Programs> programs_of(const ArmFaultBench& bench, const FaultPlan& plan) {
  const FaultyArmConfiguration leader(bench.setup, plan, FaultSite::master),
      follower(bench.setup, plan, FaultSite::slave);
  const auto starts = [&](std::int64_t session) -> Result<station::SupervisedArms> {
    station::ArmSiteStart start{.session = session,
                                .agreement = agreement_of(leader.agreed()),
                                .tries_motors = is_wired_so(plan),
                                .judges_support = is_wired_so(plan)};
    auto leads = station::arm_leader_site(leader.params, leader.arms, bench.leader_limits, start);
    if (!leads) return leads.error();
    start.session = session + 1;
    start.agreement = agreement_of(follower.agreed());
    auto follows = station::arm_follower_site(follower.params, follower.arms, bench.follower_limits, start);
    if (!follows) return follows.error();
    return station::SupervisedArms{*std::move(leads), *std::move(follows)};
  };
  auto first = starts(1), again = starts(3);
  if (!first) return first.error();
  const auto leader_watch = station::motor_watch(leader.params, leader.arms.leader),
             follower_watch = station::motor_watch(follower.params, follower.arms.follower);
  if (!leader_watch) return leader_watch.error();
  if (!follower_watch) return follower_watch.error();
  return Programs{leader, follower, *leader_watch, *follower_watch, *std::move(first), *std::move(again)};
}

/// Whether what a site received of the other's parameters names the key in which the plan makes them differ.
template <class Site>
bool names_key(const Site& site, const FaultyArmConfiguration& own, const FaultPlan& plan) {
  station::AgreedArms agreed = own.agreed();
  std::vector<Binding> values;
  append_bindings(agreed, {}, values);
  const auto named = control::first_disagreement(site.agreement(), values);
  return named && named->key == FaultyArmConfiguration::keys[FaultyArmConfiguration::key_of(plan)] &&
         named->own != named->other;
}

}  // namespace

/// One plan, tick by tick.
class ArmFaultRun {
 public:
  ArmFaultRun(const ArmFaultBench& bench, const FaultPlan& plan, Programs programs)
      : plan_(plan),
        of_leader_(programs.leader),
        of_follower_(programs.follower),
        rig_(bench.setup.params.rig),
        held_leader_(bench.held_leader()),
        follower_arm_(bench.setup.follower.arm),
        tries_motors_(is_wired_so(plan)),
        tick_s_(bench.tick_s()),
        steps_(static_cast<int>(std::lround(tick_s_ / bench.setup.leader.arm.step_s))),
        step_s_(bench.setup.leader.arm.step_s),
        injections_{ArmFaultInjection(plan, bench.leader_gates.size(), tick_s_)},
        person_(bench, plan),
        wall_(person_.wall()),
        leader_(FaultSite::master, std::move(programs.first.leader), std::move(programs.again.leader),
                lies(bench.leader, held_leader_, plan), bench.leader_gates, bench.setup.leader, programs.leader_watch,
                plan, rig_.supervision.packets, tick_s_),
        follower_(FaultSite::slave, std::move(programs.first.follower), std::move(programs.again.follower),
                  lies(bench.follower, follower_arm_, plan), bench.follower_gates, bench.setup.follower,
                  programs.follower_watch, plan, rig_.supervision.packets, tick_s_),
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
    if (plan_.kind == FaultKind::configurations_differ) {
      outcome_.arms->named =
          names_key(leader_.site, of_leader_, plan_) && names_key(follower_.site, of_follower_, plan_);
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
    if (plan_.kind == FaultKind::model_wrong) here.leaps(harm);
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

  FaultPlan plan_;
  FaultyArmConfiguration of_leader_, of_follower_;
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
  auto programs = programs_of(bench, plan);
  if (programs) return ArmFaultRun(bench, plan, *std::move(programs)).run();
  FaultOutcome refused;
  refused.arms.emplace();
  return refused;
}

}  // namespace tactus::experiments
