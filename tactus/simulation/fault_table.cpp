#include <tactus/simulation/fault_table.hpp>
#include <tactus/simulation/parallel.hpp>
#include <tactus/simulation/quantile.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::simulation {

namespace {

/// Ticks that a message may wait at a tick boundary on its way, and a state for its packet.
constexpr double grace_ticks = 6.0;

std::string_view broken_rule_of_all(const FaultOutcome& outcome) {
  if (outcome.not_finite > 0) return "an output was not finite";
  if (outcome.stale_applied > 0) return "a stale packet was applied";
  if (outcome.steps_above_rate > 0) return "a force step above the rate limit";
  if (outcome.forces_above_limit > 0) return "a force above the limit";
  if (outcome.active_without_arming > 0) return "a site followed again without arming";
  if (outcome.left_workspace) return "a device left its workspace";
  if (!outcome.active_at_end) return "not active again after clearing and arming";
  return {};
}

void add(FaultOutcome& worst, const FaultOutcome& one) {
  worst.not_finite += one.not_finite;
  worst.stale_applied += one.stale_applied;
  worst.steps_above_rate += one.steps_above_rate;
  worst.forces_above_limit += one.forces_above_limit;
  worst.active_without_arming += one.active_without_arming;
  worst.peak_force_N = std::max(worst.peak_force_N, one.peak_force_N);
  worst.given_J = std::max(worst.given_J, one.given_J);
  worst.resume_step_N = std::max(worst.resume_step_N, one.resume_step_N);
}

}  // namespace

FaultsParams::FaultsParams() {
  environment.stiffness_N_per_m = 40000.0;
  environment.damping_N_s_per_m = 3.0;
  slave.force_sensor.noise_rms_N = 0.002;
  plant.longest_step_s = 50e-6;
  control.force_gain = 5.0;
  control.force_limit_N = 3.0;
  control.slave.proportional_N_per_m = 100.0;
  control.slave.derivative_N_s_per_m = 0.65;
  for (control::SafetyGate::Params* gate : {&control.gate, &control.slave_gate}) {
    gate->force_limit_N = 5.0;
    gate->rate_limit_N_per_s = 2000.0;
    gate->velocity_limit_m_per_s = 2.0;
    gate->position_limit_m = 0.2;
    gate->encoder.fastest_m_per_s = 5.0;
    gate->encoder.frozen_force_N = 0.3;
    gate->energy = {
        .damp_above_J = 0.02, .hold_above_J = 0.05, .credit_J = 0.02, .drain_W = 0.05, .damping_N_s_per_m = 3.0};
  }
  // A hand that turns around dwells within a count for up to 40 ms: docs/theory/safety.md.
  control.gate.encoder.frozen_after_s = 0.05;
  // More than twice the friction of the slave, and by then 12 counts away.
  control.slave_gate.encoder.unbalanced_force_N = 0.06;
  control.slave_gate.encoder.frozen_after_s = 0.015;
  control.handle_gate.rate_limit_N_per_s = 2000.0;
  control.supervision.force_sensor.residual_limit_N = 0.5;
}

std::vector<FaultRow> fault_rows() {
  return {
      {FaultKind::none, "clean", "nothing", "no trip"},
      {FaultKind::loss_bursts, "loss in bursts", "Gilbert-Elliott, both ways",
       "extrapolation, decay, hold; nothing stale applied"},
      {FaultKind::disorder, "delay, jitter, order, copies", "up to 30 ms, both ways", "the newest wins"},
      {FaultKind::cut, "link cut", "10 ms to the longest cut", "hold within the time-out, resume only after arming"},
      {FaultKind::restart, "site killed and restarted", "dead for 20 ms to 1 s",
       "hold within the time-out, resume only after arming"},
      {FaultKind::bad_number, "bad number", "NaN, infinity, huge: every input, every state", "refused, finite output"},
      {FaultKind::encoder_spike, "encoder spike", "one reading, 5 mm to 1 m", "latched in the tick"},
      {FaultKind::encoder_freeze, "encoder frozen", "for 1 s", "latched once the force works"},
      {FaultKind::encoder_wrap, "encoder wrap", "16 bits of 10 um", "latched in the tick"},
      {FaultKind::force_dropout, "force sensor drops out", "reads 0 for 1 s", "hold once there is contact"},
      {FaultKind::force_bias, "force sensor biased", "by 0.2 to 20 N for 1 s", "hold where it matters"},
      {FaultKind::stall, "site stalled", "1 to 100 ms, the motor holds its force", "no burst; hold after a long one"},
      {FaultKind::delayed_wall, "wall, delay, light grip", "15 to 30 ms each way, little damping by the hand",
       "damped, then held"},
      {FaultKind::delayed_wall, "the same, monitor loose", "the same plans", "diverges", false},
  };
}

Teleoperator::Params params_of(const FaultRow& row, const FaultsParams& params) {
  Teleoperator::Params of = params;
  // The wall with delay is for the monitor, and needs a controller that lets the hand be pushed about.
  if (row.kind == FaultKind::delayed_wall) {
    of.control.cancellation = control::CancellationMode::off;
    of.person.grip.damping_N_s_per_m *= params.task.light_grip_fraction;
    // Else its check could end what the monitor is to end.
    of.control.supervision.force_sensor.residual_limit_N = 100.0;
  }
  if (!row.monitored) {
    for (control::SafetyGate::Params* gate : {&of.control.gate, &of.control.slave_gate}) {
      gate->energy.damp_above_J = 100.0;
      gate->energy.hold_above_J = 200.0;
      gate->energy.credit_J = 100.0;
      gate->energy.drain_W = 50.0;
    }
  }
  return of;
}

std::string_view broken_rule(const FaultRow& row, const FaultPlan& plan, const FaultOutcome& outcome,
                             const FaultsParams& params) {
  if (const auto rule = broken_rule_of_all(outcome); !rule.empty()) return rule;
  if (outcome.given_J > params.task.diverged_above_J) return "diverged";
  const double tick_s = 1.0 / params.servo.rate_Hz;
  const control::SupervisionParams& supervision = params.control.supervision;
  const double timeout_s = supervision.watchdog.timeout_s;
  const bool detected = outcome.detection_ticks >= 0;
  const bool in_time = outcome.stopped && outcome.time_to_stop_s <= timeout_s + grace_ticks * tick_s;
  constexpr std::string_view late = "not stopped within the time-out", unseen = "not detected";
  switch (row.kind) {
    case FaultKind::none:
      return outcome.stopped || detected ? "tripped on clean data" : "";
    case FaultKind::cut:
      return plan.length_s <= timeout_s + grace_ticks * tick_s || in_time ? "" : late;
    case FaultKind::restart:
      return in_time ? "" : late;
    case FaultKind::encoder_spike:
    case FaultKind::encoder_wrap:
      return detected && outcome.detection_ticks <= 1 ? "" : unseen;
    case FaultKind::force_bias:
      return detected || std::fabs(plan.size) < 2.0 * supervision.force_sensor.residual_limit_N ? "" : unseen;
    case FaultKind::stall:
      return plan.length_s <= supervision.longest_stall_s || detected ? "" : unseen;
    case FaultKind::loss_bursts:
    case FaultKind::disorder:
    case FaultKind::bad_number:
    case FaultKind::encoder_freeze:
    case FaultKind::force_dropout:
    case FaultKind::delayed_wall:
      break;
  }
  return {};
}

std::vector<FaultPlan> draw_plans(const FaultRow& row, const FaultsParams& params) {
  std::vector<FaultPlan> plans;
  for (std::int64_t i = 0; i < params.task.seeds; ++i) {
    plans.push_back(draw_plan(row.kind, i, params.task.seed, params.task.longest_cut_s));
  }
  return plans;
}

FaultTally tally(const FaultRow& row, const FaultsParams& params, const std::vector<FaultPlan>& plans,
                 const std::vector<FaultOutcome>& outcomes) {
  FaultTally sum{.row = row, .failures = {}, .worst = {}};
  std::vector<double> stop_s, detection;
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    const FaultOutcome& one = outcomes[i];
    ++sum.tried;
    if (const auto rule = broken_rule(row, plans[i], one, params); rule.empty()) {
      ++sum.survived;
    } else {
      sum.failures.push_back({static_cast<std::int64_t>(i), rule});
    }
    sum.diverged += one.given_J > params.task.diverged_above_J;
    sum.simulated_s += plans[i].start_s + plans[i].length_s;
    if (one.stopped) stop_s.push_back(one.time_to_stop_s);
    if (one.detection_ticks >= 0) detection.push_back(static_cast<double>(one.detection_ticks));
    add(sum.worst, one);
  }
  sum.stopped = static_cast<std::int64_t>(stop_s.size());
  sum.detected = static_cast<std::int64_t>(detection.size());
  if (!stop_s.empty()) {
    sum.time_to_stop_median_s = quantile(stop_s, 0.5);
    sum.time_to_stop_most_s = quantile(stop_s, 1.0);
  }
  if (!detection.empty()) {
    sum.detection_ticks_median = quantile(detection, 0.5);
    sum.detection_ticks_most = quantile(detection, 1.0);
  }
  return sum;
}

Result<std::vector<FaultTally>> run_faults(const FaultsParams& params, const std::function<void(double)>& progress) {
  if (auto error = validate(params)) return *std::move(error);
  const auto rows = fault_rows();
  const auto seeds = static_cast<std::size_t>(params.task.seeds);
  std::vector<Teleoperator::Params> of;
  std::vector<std::vector<FaultPlan>> plans(rows.size());
  for (std::size_t row = 0; row < rows.size(); ++row) {
    of.push_back(params_of(rows[row], params));
    plans[row] = draw_plans(rows[row], params);
    // What can be made once can be made always: a plan changes no parameter of the parts.
    if (const auto tried = run_fault(of.back(), {.start_s = 0.0, .impairment = {}}); !tried) return tried.error();
  }
  std::vector<std::vector<FaultOutcome>> outcomes(rows.size(), std::vector<FaultOutcome>(seeds));
  for_each_in_parallel(
      rows.size() * seeds,
      [&](std::size_t index) {
        const std::size_t row = index / seeds, i = index % seeds;
        outcomes[row][i] = run_fault(of[row], plans[row][i]).value();
      },
      progress);
  std::vector<FaultTally> tallies;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    tallies.push_back(tally(rows[row], params, plans[row], outcomes[row]));
  }
  return tallies;
}

}  // namespace tactus::simulation
