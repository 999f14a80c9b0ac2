// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/faults/duty.hpp>
#include <tactus/simulation/experiments/faults/internal/families.hpp>
#include <tactus/simulation/experiments/faults/rows.hpp>

#include <algorithm>

namespace tactus::experiments {

using namespace fault_families;

namespace {

std::string_view clean(const FaultPlan&, const FaultOutcome& outcome, const FaultsParams&) {
  return tripped_on_clean_data(outcome);
}

std::vector<FaultRow> first_rows() {
  return {
      {FaultKind::none, "clean", "clean", "nothing", "no trip", clean},
      {FaultKind::loss_bursts, "loss-bursts", "loss in bursts", "Gilbert-Elliott, both ways",
       "extrapolation, decay, hold; nothing stale applied"},
      {FaultKind::disorder, "disorder", "delay, jitter, order, copies", "up to 30 ms, both ways", "the newest wins"},
      {FaultKind::cut, "cut", "link cut", "10 ms to the longest cut",
       "hold within the time-out, resume only after arming", broken_duty},
      {FaultKind::restart, "restart", "site killed and restarted", "dead for 20 ms to 1 s",
       "hold within the time-out, resume only after arming", broken_duty},
      {FaultKind::bad_number, "bad-number", "bad number", "NaN, infinity, huge: every input, every state",
       "refused, finite output"},
      {FaultKind::encoder_spike, "encoder-spike", "encoder spike", "one reading, 5 mm to 1 m",
       "latched in the control cycle", broken_duty},
      {FaultKind::encoder_freeze, "encoder-freeze", "encoder frozen", "for 1 s", "latched once the force works"},
      {FaultKind::encoder_wrap, "encoder-wrap", "encoder wrap", "16 bits of 10 um", "latched in the control cycle",
       broken_duty},
      {FaultKind::force_dropout, "force-dropout", "force sensor drops out", "reads 0 for 1 s",
       "hold once there is contact"},
      {FaultKind::force_bias, "force-bias", "force sensor biased", "by 0.2 to 20 N for 1 s", "hold where it matters",
       broken_duty},
      {FaultKind::stall, "stall", "site stalled", "1 to 100 ms, the motor holds its force",
       "no burst; hold after a long one", broken_duty},
      {FaultKind::delayed_wall, "delayed-wall", "wall, delay, light grip",
       "15 to 30 ms each way, little damping by the hand", "damped, then held"},
      {.kind = FaultKind::delayed_wall,
       .id = "delayed-wall-loose",
       .name = "the same, monitor loose",
       .injected = "the same plans",
       .expected = "diverges",
       .monitored = false},
  };
}

}  // namespace

std::string_view broken_rule_of_all(const FaultOutcome& outcome) {
  if (outcome.not_finite > 0) return "an output was not finite";
  if (outcome.stale_applied > 0) return "a stale packet was applied";
  if (outcome.steps_above_rate > 0) return "a force step above the rate limit";
  if (outcome.forces_above_limit > 0) return "a force above the limit";
  if (outcome.active_without_arming > 0) return "a site followed again without arming";
  if (outcome.left_workspace) return "a device left its workspace";
  return {};
}

std::string_view broken_bound(const FaultOutcome& outcome, const HarmBounds& bounds, double release_s) {
  const SiteHarm &master = outcome.master, &slave = outcome.slave;
  if (std::max(master.given_J, slave.given_J) > bounds.given_J) return "a motor gave too much energy";
  if (std::max(master.speed_m_per_s, slave.speed_m_per_s) > bounds.speed_m_per_s) return "handle or tool too fast";
  if (std::max(master.strayed_m, slave.strayed_m) > bounds.strayed_m) return "handle or tool strayed too far";
  if (master.peak_force_N > bounds.hand_force_N) return "too much force on the hand";
  if (slave.peak_force_N > bounds.tool_force_N) return "too much force at the tool";
  if (std::max(master.pressing_N, slave.pressing_N) > bounds.pressing_N) return "pressed too hard for long";
  if (outcome.release_s > release_s) return "not released in time";
  return {};
}

std::string_view tripped_on_clean_data(const FaultOutcome& outcome) {
  return outcome.stopped || outcome.detection_ticks >= 0 ? "tripped on clean data" : "";
}

std::vector<FaultRow> fault_rows(std::string_view only) {
  std::vector<FaultRow> rows = first_rows();
  for (const auto& family : {device_rows(), course_rows()}) rows.insert(rows.end(), family.begin(), family.end());
  if (!only.empty()) std::erase_if(rows, [only](const FaultRow& row) { return row.id != only; });
  return rows;
}

simulation::Teleoperator::Params params_of(const FaultRow& row, const FaultsParams& params) {
  simulation::Teleoperator::Params of = params;
  if (row.prepare != nullptr) row.prepare(of);
  // The wall with delay is for the monitor, and needs a controller that lets the hand be pushed about.
  if (row.kind == FaultKind::delayed_wall || row.kind == FaultKind::delay_asymmetric ||
      row.kind == FaultKind::delay_creeping) {
    of.control.cancellation = control::CancellationMode::off;
    of.person.grip.damping_N_s_per_m *= params.task.light_grip_fraction;
    // Else their checks could end what the monitor is to end.
    of.control.supervision.force_sensor.residual_limit_N = 100.0;
    of.control.supervision.hand_sensor.residual_limit_N = 100.0;
    of.control.gate.reversal.force_N = of.control.slave_gate.reversal.force_N = 100.0;
  }
  if (!row.monitored) loosen_monitor(of);
  return of;
}

std::string_view broken_rule(const FaultRow& row, const FaultPlan& plan, const FaultOutcome& outcome,
                             const FaultsParams& params) {
  if (const auto rule = broken_rule_of_all(outcome); !rule.empty()) return rule;
  if (row.resumes && !outcome.active_at_end) return not_resumed;
  if (outcome.given_J > params.task.diverged_above_J) return "diverged";
  if (const auto bound = broken_bound(outcome, params.task.bounds, release_allowed_s(plan, params)); !bound.empty()) {
    return bound;
  }
  return row.rule ? row.rule(plan, outcome, params) : std::string_view{};
}

}  // namespace tactus::experiments
