// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/faults/duty.hpp>
#include <tactus/simulation/experiments/faults/fault_operator.hpp>
#include <tactus/simulation/experiments/faults/faulty_configuration.hpp>
#include <tactus/simulation/experiments/faults/internal/families.hpp>
#include <tactus/simulation/experiments/faults/pairs.hpp>

namespace tactus::experiments::fault_families {

namespace {

constexpr double longest_to_notice_s = 0.1;

std::string_view configurations_differ(const FaultPlan&, const FaultOutcome& outcome, const FaultsParams&) {
  return outcome.active_in_fault ? "armed although the sites differ" : "";
}
std::string_view dead_man_stuck(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams&) {
  return plan.start_s == 0.0 && outcome.active_in_fault ? "followed on a switch that was pressed before" : "";
}
std::string_view console_lost(const FaultPlan&, const FaultOutcome& outcome, const FaultsParams&) {
  return outcome.stopped && outcome.time_to_stop_s <= longest_to_notice_s ? "" : "followed on without a console";
}
std::string_view stale_commands(const FaultPlan&, const FaultOutcome& outcome, const FaultsParams& params) {
  const double longest_s = params.control.supervision.blend_s + longest_to_notice_s;
  return outcome.stopped && outcome.master.release_s <= longest_s ? "" : "a motor kept an old command";
}

void loose_overload(simulation::Teleoperator::Params& params, FaultPlan&) {
  params.control.supervision.overload = {.missed_share = 0.9, .window_s = 10.0};
}
void for_ever(simulation::Teleoperator::Params& params) {
  params.control.supervision.watchdog.timeout_s = 10.0;
  params.control.supervision.longest_stall_s = 1.0;
}
void loose_watchdogs(simulation::Teleoperator::Params& params, FaultPlan& plan) {
  for_ever(params);
  plan.size = 1e9;
}
void loose_pace(simulation::Teleoperator::Params& params, FaultPlan&) { params.control.supervision.pace_share = 0.9; }
void loose_monitor(simulation::Teleoperator::Params& params, FaultPlan&) { loosen_monitor(params); }
/// Everything that a file can loosen.
void loose_limits(simulation::Teleoperator::Params& params, FaultPlan& plan) {
  loosen_monitor(params);
  for (control::SafetyGate::Params* gate : {&params.control.gate, &params.control.slave_gate}) {
    gate->force_limit_N = 100.0;
    gate->rate_limit_N_per_s = 1e6;
    gate->velocity_limit_m_per_s = 100.0;
    gate->position_limit_m = 10.0;
    gate->reversal.force_N = 200.0;
    gate->thermal.continuous_force_N = 100.0;
    gate->encoder = {.fastest_m_per_s = 100.0, .frozen_force_N = 200.0, .frozen_after_s = 1.0};
  }
  params.control.force_limit_N = 100.0;
  params.control.supervision.force_sensor.residual_limit_N = 200.0;
  params.control.supervision.hand_sensor.residual_limit_N = 200.0;
  params.control.supervision.packets.longest_age_s = 10.0;
  loose_overload(params, plan);
  loose_pace(params, plan);
  for_ever(params);
}
/// So that there is a force to keep.
void holds_firmly(simulation::Teleoperator::Params& params) { params.person.grip.stiffness_N_per_m *= 5.0; }
/// Whether a limit or time-out can see it: a new session, a jump of an encoder and a switch that is let go are seen
/// however wide the limits are, and end what else is there.
bool limits_see(const FaultPlan& plan, const FaultsParams& params) {
  bool seen = false;
  for (const FaultPlan& part : plans_of(plan)) {
    switch (part.kind) {
      case FaultKind::restart:
      case FaultKind::encoder_spike:
      case FaultKind::encoder_wrap:
      case FaultKind::hand_lets_go:
        return false;
      default:
        const FaultDuty::Kind duty = duty_of(part, params).kind;
        seen = seen || duty == FaultDuty::Kind::latches || duty == FaultDuty::Kind::stops;
    }
  }
  return seen;
}
/// A plan's other self, in which the defence is not asked: what that is, its element says.
void unasked(simulation::Teleoperator::Params&, FaultPlan& plan) { plan.size = 1.0; }

}  // namespace

std::vector<FaultRow> course_rows() {
  return {
      {FaultKind::overload,
       "overload",
       "control cycles missed",
       "a share of 5 to 90 %, at random, for 1.5 s",
       "hold above the share, soon",
       broken_duty,
       {"the share of missed control cycles", loose_overload}},
      {FaultKind::stop_and_go,
       "stop-and-go",
       "stop and go",
       "stalls of 4 to 19 ms, again and again for 1.5 s",
       "hold, as for missed control cycles",
       broken_duty,
       {"the share of missed control cycles", loose_overload}},
      {FaultKind::suspend,
       "suspend",
       "suspended",
       "the process, or the machine and its clock, for 1 s to the longest cut",
       "the other site holds within the timeout, the drive releases its force",
       broken_duty,
       {"watchdogs, and the drive's own", loose_watchdogs}},
      {FaultKind::rate_drift,
       "rate-drift",
       "clock too slow",
       "by 1e-6 to 1e-3, or by 25 to 90 %, for 3 s",
       "a small drift stops nothing, a large one ends in hold",
       broken_duty,
       {"all limits", loose_limits}},
      {FaultKind::configurations_differ,
       "configurations-differ",
       "configurations differ",
       "architecture, rate, scale, limits, time-out",
       "never armed",
       configurations_differ,
       {"the comparison", unasked},
       nullptr,
       false},
      {FaultKind::delay_asymmetric,
       "delay-asymmetric",
       "one way slow",
       "30 to 380 ms more within 1 s, the other way none",
       "damped, then held; nothing applied that is older than twice the longest age",
       nullptr,
       {"passivity monitors", loose_monitor}},
      {FaultKind::delay_creeping,
       "delay-creeping",
       "delay creeps up",
       "to 50 to 500 ms in 3 s, both ways",
       "damped, then held",
       nullptr,
       {"passivity monitors", loose_monitor}},
      {FaultKind::peer_repeats,
       "peer-repeats",
       "the other site repeats itself",
       "the same packet under fresh numbers, for 0.3 to 2 s",
       "hold within the time-out",
       broken_duty,
       {"the contents of a packet", unasked}},
      {FaultKind::peer_wrong,
       "peer-wrong",
       "the other site is wrong",
       "sign, sign and scale of 1.5 to 4, frozen, noise of 5 mm and 2 N, for 1.5 s",
       "within the limits",
       nullptr,
       {"all limits", loose_limits}},
      {FaultKind::both_restarted,
       "both-restarted",
       "both sites restarted",
       "dead for 20 ms to 1 s, every button pressed when they come back",
       "nothing follows until it is armed",
       broken_duty,
       {"what is pressed is pressed after the start", unasked}},
      {FaultKind::dead_man_stuck,
       "dead-man-stuck",
       "dead-man stuck",
       "pressed from the start; or in use, after the operator has left",
       "arms nothing; within the limits",
       dead_man_stuck,
       {"the switch does not stick", unasked}},
      {FaultKind::console_lost,
       "console-lost",
       "console lost",
       "for 1 s",
       "no site follows within 100 ms",
       console_lost,
       {"its end is no release", unasked}},
      {FaultKind::two_faults,
       "two-faults",
       "two faults at once",
       "every pair of kinds that strike",
       "within the limits; what either asks for, in the time that the other leaves",
       broken_duty_of_two,
       {"every limit and time-out, where they alone see it", loose_limits, limits_see}},
      {FaultKind::fault_while_arming,
       "fault-while-arming",
       "fault while arming",
       "every kind that strikes",
       "within the limits; nothing follows that would be stopped",
       broken_duty_while_arming,
       {"every limit and time-out, where they alone see it", loose_limits, limits_see}},
      {FaultKind::stale_commands,
       "stale-commands",
       "old commands",
       "a live controller's drive receives the same command for 1.5 s",
       "the drive releases its force",
       stale_commands,
       {"the drive's time-out", unasked},
       holds_firmly},
  };
}

void draw_course(FaultPlan& plan, signal::Random& random, double) {
  switch (plan.kind) {
    case FaultKind::overload:
      plan.length_s = 2.5;
      plan.size = random.uniform(0.05, 0.9);
      break;
    case FaultKind::stop_and_go:
      plan.length_s = 2.5;
      plan.size = random.uniform(0.004, 0.019);
      break;
    case FaultKind::rate_drift:
      plan.length_s = 3.0;
      plan.size =
          random.uniform() < 0.25 ? between_logarithms(random, 1e-6, tolerable_drift) : random.uniform(0.25, 0.9);
      break;
    case FaultKind::configurations_differ:
      plan.start_s = 0.0;
      plan.length_s = 1.0;
      break;
    case FaultKind::delay_asymmetric:
      plan.length_s = 5.0;
      break;
    case FaultKind::delay_creeping:
      plan.length_s = 3.0;
      break;
    case FaultKind::peer_repeats:
      plan.length_s = between_logarithms(random, 0.3, 2.0);
      break;
    case FaultKind::peer_wrong:
      plan.length_s = 1.5;
      plan.size = random.uniform(1.5, 4.0);
      break;
    case FaultKind::both_restarted:
      plan.length_s = between_logarithms(random, 0.02, 1.0);
      break;
    case FaultKind::dead_man_stuck:
      plan.length_s = 1.5;
      if (plan.choice % 3 != 2) plan.start_s = 0.0;
      break;
    case FaultKind::console_lost:
    case FaultKind::two_faults:
    case FaultKind::fault_while_arming:
      plan.length_s = 1.0;
      break;
    case FaultKind::stale_commands:
      plan.site = FaultSite::master;
      plan.start_s = FaultOperator(plan, 0.0, false).deepest_after_s(plan.start_s);
      plan.length_s = 1.5;
      plan.size = drive_timeout_s;
      break;
    default:
      break;
  }
}

}  // namespace tactus::experiments::fault_families
