// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/faults/duty.hpp>
#include <tactus/simulation/experiments/faults/internal/families.hpp>
#include <tactus/simulation/experiments/faults/pairs.hpp>
#include <tactus/simulation/experiments/faults/schedule.hpp>
#include <tactus/simulation/teleoperator/fault_moment.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::experiments {

namespace {

using namespace fault_families;
using Kind = FaultDuty::Kind;
using Seen = FaultDuty::Seen;

constexpr std::string_view stopped_by_drift = "a small drift stopped the sites";

/// A loop that misses the share `missed` passes the limit after so long, and half as long again, for what is drawn at
/// random scatters. No duty where it does not miss enough for that.
FaultDuty duty_of_overload(double missed, const FaultPlan& plan, const control::OverloadCheck::Params& overload) {
  if (missed < 1.5 * overload.missed_share) return {};
  const double passes_s = -overload.window_s * std::log(1.0 - overload.missed_share / missed);
  return {.kind = Kind::latches,
          .within_s = 1.5 * passes_s,
          .lasts_s = plan.length_s - simulation::forgotten_s,
          .needs_s = 1.5 * passes_s};
}

/// Where the clock is grossly slow: when `PaceCheck` must have seen it, and a little more.
FaultDuty duty_of_drift(const FaultPlan& plan, const control::SupervisionParams& supervision) {
  if (plan.size <= tolerable_drift) return {.kind = Kind::goes_on};
  const double slack_s = supervision.packets.longest_age_s + supervision.watchdog.timeout_s;
  const double untolerated = plan.size - supervision.pace_share;
  if (untolerated < 0.15) return {};
  return {.kind = Kind::latches,
          .within_s = 1.2 * slack_s / untolerated,
          .lasts_s = plan.length_s,
          .needs_s = 1.2 * slack_s / untolerated,
          .seen = Seen::from_one_to_the_other};
}

/// What a fault takes from the sites to see another one.
struct Hindrance {
  double late_s = 0.0;    ///< a packet comes so much later
  double slow = 1.0;      ///< times are counted so much longer
  double stands_s = 0.0;  ///< a site is not stepped
  bool silences = false;  ///< a packet may not come at all
  bool forgets = false;   ///< what a site read before it stood is no measure for what it reads then
};

Hindrance hindrance(const FaultPlan& plan, const FaultsParams& params) {
  switch (plan.kind) {
    case FaultKind::disorder:
    case FaultKind::delay_creeping: {
      // What is older is refused, and silence.
      const double way_s = plan.impairment.delay_s + plan.impairment.jitter_s;
      return {.late_s = std::min(way_s, params.control.supervision.packets.longest_age_s)};
    }
    case FaultKind::rate_drift:
      if (plan.size <= tolerable_drift) return {};
      // The next step may be as far away as one of its ticks lasts, and falls on a whole tick, up to one later.
      return {.slow = 1.0 / (1.0 - plan.size), .stands_s = (1.0 / (1.0 - plan.size) + 1.0) / params.servo.rate_Hz};
    case FaultKind::stall:
      return {.stands_s = plan.length_s};
    case FaultKind::stop_and_go:
      return {.stands_s = plan.size};
    case FaultKind::overload:  // so many ticks in a row are missed once in a million times
      return {.stands_s = std::log(1e-6) / std::log(plan.size) / params.servo.rate_Hz};
    case FaultKind::cut:
    case FaultKind::loss_bursts:
      return {.silences = true};
    case FaultKind::suspend:
      return {.stands_s = plan.length_s - simulation::forgotten_s, .silences = true, .forgets = true};
    case FaultKind::restart:
      return {.silences = true, .forgets = true};
    default:
      return {};
  }
}

FaultSite site_of(const FaultPlan& plan) {
  const bool at_tip = plan.kind == FaultKind::force_bias || plan.kind == FaultKind::force_dropout;
  return at_tip ? FaultSite::slave : plan.site;
}

bool is_reading(FaultKind kind) { return kind == FaultKind::encoder_spike || kind == FaultKind::encoder_wrap; }

double silence_s(const control::SupervisionParams& supervision, double rate_Hz) {
  return supervision.watchdog.timeout_s + grace_ticks / rate_Hz;
}

/// Until when, after `plan` began, the site `at` must have done the duty beside `other`; negative where the other
/// leaves nothing to see.
double allowed_s(const FaultDuty& duty, const FaultPlan& plan, const FaultPlan& other, FaultSite at,
                 const FaultsParams& params) {
  const bool over = other.start_s + other.length_s < plan.start_s;
  const bool comes_after = plan.start_s + duty.within_s < other.start_s;
  if (over || comes_after) return duty.within_s;
  Hindrance by = hindrance(other, params);
  const bool handed_on = duty.seen == Seen::from_one_to_the_other, there = handed_on || other.site == at;
  // What one site tells the other may be late as well, or lost, and then it is silence that the other hears.
  by.late_s *= !duty.by_packets ? 0.0 : handed_on ? 2.0 : 1.0;
  if (duty.by_packets && handed_on && by.silences)
    by.late_s = silence_s(params.control.supervision, params.servo.rate_Hz);
  if (!there) by = {.late_s = by.late_s};
  const bool unread = other.start_s <= plan.start_s && (by.slow > 1.0 || by.stands_s > 0.0);
  // What waits before a site that stands is read when it steps again, and that is when silence begins.
  if (duty.by_packets && !by.forgets) by.late_s += by.stands_s;
  if (is_reading(plan.kind) && (by.forgets || (plan.kind == FaultKind::encoder_spike && unread))) return -1.0;
  if (duty.lasts_s - by.late_s < duty.needs_s * by.slow) return -1.0;
  return (duty.within_s + by.late_s) * by.slow + by.stands_s;
}

bool within(double value_s, double allowed_s, double rate_Hz) { return value_s <= allowed_s + 0.5 / rate_Hz; }
double detected_s(const FaultOutcome& outcome, double rate_Hz) {
  return outcome.detection_ticks < 0 ? std::numeric_limits<double>::infinity()
                                     : static_cast<double>(outcome.detection_ticks) / rate_Hz;
}

/// Whether the duty of `plan`, which began `since_s` after the first, was done beside `other`.
std::string_view broken_beside(const FaultPlan& plan, const FaultPlan& other, double since_s,
                               const FaultOutcome& outcome, const FaultsParams& params) {
  const FaultDuty duty = duty_of(plan, params);
  const FaultSite own = site_of(plan), across = own == FaultSite::master ? FaultSite::slave : FaultSite::master;
  if (duty.kind == Kind::none) return {};
  if (duty.kind == Kind::goes_on) {
    return duty_of(other, params).kind == Kind::goes_on && outcome.stopped ? stopped_by_drift : "";
  }
  if (duty.kind == Kind::latches) {
    const double by_s = allowed_s(duty, plan, other, duty.seen == Seen::at_the_other ? across : own, params);
    // Who has stopped already has nothing left to stop for.
    const double ended_s = std::min(detected_s(outcome, params.servo.rate_Hz),
                                    std::max(outcome.master_followed_s, outcome.slave_followed_s));
    return by_s < 0.0 || within(ended_s, since_s + by_s, params.servo.rate_Hz) ? "" : unseen;
  }
  for (const FaultSite at : {FaultSite::master, FaultSite::slave}) {
    const double by_s = allowed_s(duty, plan, other, at, params);
    const double followed_s = at == FaultSite::master ? outcome.master_followed_s : outcome.slave_followed_s;
    if (by_s >= 0.0 && !within(followed_s, since_s + by_s, params.servo.rate_Hz)) return late;
  }
  return {};
}

}  // namespace

FaultDuty duty_of(const FaultPlan& plan, const control::SupervisionParams& supervision, double rate_Hz) {
  const double grace_s = grace_ticks / rate_Hz, silent_s = silence_s(supervision, rate_Hz);
  switch (plan.kind) {
    case FaultKind::cut:
      if (plan.length_s <= silent_s) return {};
      return {.kind = Kind::stops,
              .within_s = silent_s,
              .lasts_s = plan.length_s,
              .needs_s = silent_s,
              .seen = Seen::at_each,
              .by_packets = true};
    case FaultKind::restart:
    case FaultKind::both_restarted:
      return {.kind = Kind::stops, .within_s = silent_s, .seen = Seen::at_each, .by_packets = true};
    case FaultKind::peer_repeats:
      return {.kind = Kind::stops,
              .within_s = silent_s,
              .lasts_s = plan.length_s,
              .needs_s = silent_s,
              .seen = Seen::from_one_to_the_other,
              .by_packets = true};
    case FaultKind::suspend:
      return {.kind = Kind::latches,
              .within_s = silent_s,
              .lasts_s = plan.length_s - simulation::forgotten_s,
              .needs_s = silent_s,
              .seen = Seen::at_the_other,
              .by_packets = true};
    case FaultKind::hand_lets_go:
    case FaultKind::dead_man_released:
    case FaultKind::emergency_stop:
    case FaultKind::slow_stop:
      return {.kind = Kind::stops, .within_s = grace_s, .seen = Seen::from_one_to_the_other, .by_packets = true};
    case FaultKind::encoder_spike:
    case FaultKind::encoder_wrap:
      return {.kind = Kind::latches, .within_s = 1.0 / rate_Hz};
    case FaultKind::force_bias:
      if (std::fabs(plan.size) < 2.0 * supervision.force_sensor.residual_limit_N) return {};
      return {.kind = Kind::latches, .within_s = plan.length_s};
    case FaultKind::stall:
      if (plan.length_s <= supervision.longest_stall_s) return {};
      return {.kind = Kind::latches,
              .within_s = plan.length_s + grace_s,
              .lasts_s = plan.length_s,
              .needs_s = supervision.longest_stall_s};
    case FaultKind::overload:
      return duty_of_overload(plan.size, plan, supervision.overload);
    case FaultKind::stop_and_go:  // it goes for no longer than it stands
      return duty_of_overload(0.45, plan, supervision.overload);
    case FaultKind::rate_drift:
      return duty_of_drift(plan, supervision);
    default:
      return {};
  }
}

std::string_view broken_duty(const FaultDuty& duty, const FaultPlan& plan, const FaultOutcome& outcome,
                             double rate_Hz) {
  switch (duty.kind) {
    case Kind::none:
      return {};
    case Kind::goes_on:
      return outcome.stopped ? stopped_by_drift : "";
    case Kind::latches:
      if (within(detected_s(outcome, rate_Hz), duty.within_s, rate_Hz)) return {};
      return plan.kind == FaultKind::suspend ? late : unseen;
    case Kind::stops:
      return outcome.stopped && within(outcome.time_to_stop_s, duty.within_s, rate_Hz) ? "" : late;
  }
  return {};
}

std::string_view broken_duty(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams& params) {
  return broken_duty(duty_of(plan, params), plan, outcome, params.servo.rate_Hz);
}

std::string_view broken_duty_of_two(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams& params) {
  if (!outcome.became_active) return "did not follow before";
  const auto plans = plans_of(plan);
  const std::string_view first = broken_beside(plans[0], plans[1], 0.0, outcome, params);
  if (!first.empty()) return first;
  const double rate_Hz = params.servo.rate_Hz;
  const auto apart = std::lround(plans[1].start_s * rate_Hz) - std::lround(plans[0].start_s * rate_Hz);
  return broken_beside(plans[1], plans[0], static_cast<double>(apart) / rate_Hz, outcome, params);
}

double release_allowed_s(const FaultPlan& plan, const FaultsParams& params) {
  double allowed_s = params.task.bounds.release_s;
  if (plan.kind != FaultKind::two_faults) return allowed_s;
  for (const FaultPlan& part : plans_of(plan)) {
    const Hindrance by = hindrance(part, params);
    allowed_s += (by.slow - 1.0) * params.control.supervision.hold.release_s + by.stands_s;
  }
  return allowed_s;
}

std::string_view broken_duty_while_arming(const FaultPlan& plan, const FaultOutcome& outcome,
                                          const FaultsParams& params) {
  const FaultPlan part = plans_of(plan).front();
  const FaultDuty duty = duty_of(part, params);
  const double allowed_s = std::max(fault_schedule::press_s - part.start_s, 0.0) + duty.within_s;
  const auto [sooner_s, later_s] = std::minmax(outcome.master_followed_s, outcome.slave_followed_s);
  switch (duty.kind) {
    case Kind::none:
      return {};
    case Kind::goes_on:
      return outcome.active_in_fault ? "" : "a small drift kept the sites from following";
    case Kind::latches:
      return within(sooner_s, allowed_s, params.servo.rate_Hz) ? "" : unseen;
    case Kind::stops:
      return within(later_s, allowed_s, params.servo.rate_Hz) ? "" : late;
  }
  return {};
}

}  // namespace tactus::experiments
