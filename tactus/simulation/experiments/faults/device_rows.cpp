// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/faults/duty.hpp>
#include <tactus/simulation/experiments/faults/internal/families.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::experiments::fault_families {

namespace {

/// One of two ranges, each drawn evenly in its logarithm: well below what is right or well above.
double below_or_above(signal::Random& random, double lowest, double below, double above, double highest) {
  return random.uniform() < 0.5 ? between_logarithms(random, lowest, below)
                                : between_logarithms(random, above, highest);
}

/// What is wired wrongly is so from the start.
void from_the_start(FaultPlan& plan) {
  plan.start_s = 0.0;
  plan.length_s = 1.5;
}

bool seen_meanwhile(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams& params) {
  return outcome.detection_ticks >= 0 &&
         static_cast<double>(outcome.detection_ticks) < plan.length_s * params.servo.rate_Hz;
}

std::string_view seen(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams& params) {
  return seen_meanwhile(plan, outcome, params) ? std::string_view{} : unseen;
}
/// What the balance of forces at the plan's site surely does not let pass for long.
double surely_seen_N(const FaultPlan& plan, const FaultsParams& params) {
  const auto& checks = params.control.supervision;
  return 2.0 * (plan.site == FaultSite::master ? checks.hand_sensor : checks.force_sensor).residual_limit_N;
}
std::string_view wrong_force(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams& params) {
  return outcome.fault_N < surely_seen_N(plan, params) ? std::string_view{} : seen(plan, outcome, params);
}
/// The same, and the motor must not jump when it obeys again.
std::string_view comes_back(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams& params) {
  const double step_N = std::max(outcome.master.drive_step_N, outcome.slave.drive_step_N);
  return step_N <= surely_seen_N(plan, params) ? wrong_force(plan, outcome, params)
                                               : "the motor jumped when its supply came back";
}
/// Wired wrongly it must not be followed; gone wrong while it gave no force, it does no harm.
std::string_view wrong_sign(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams& params) {
  return plan.start_s == 0.0 ? seen(plan, outcome, params) : wrong_force(plan, outcome, params);
}
std::string_view cool(const FaultPlan&, const FaultOutcome& outcome, const FaultsParams&) {
  return outcome.winding_warmth <= 1.0 ? "" : "a winding was damaged";
}
/// A stop takes its stated time, whatever the rate limit is with which forces grow.
std::string_view stopped_in_time(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams& params) {
  if (const auto rule = broken_duty(plan, outcome, params); !rule.empty()) return rule;
  const SiteHarm& pressed = plan.site == FaultSite::master ? outcome.master : outcome.slave;
  const control::SafetyGate::Params& gate =
      plan.site == FaultSite::master ? params.control.gate : params.control.slave_gate;
  const double longest_s = gate.stop_time_s + grace_ticks / params.servo.rate_Hz;
  return pressed.release_s <= longest_s ? "" : "a motor pressed on after the stop";
}
void tries_motors(simulation::Teleoperator::Params& of) {
  of.control.supervision.probe = {.force_N = 0.5, .duration_s = 0.08, .least_m = 1.5e-4, .most_m = 0.005};
}

/// Forces at the tip as large as those on the hand, for what is only seen by a force.
void feels_as_it_is(simulation::Teleoperator::Params& of) { of.control.force_gain = 1.0; }

/// A workspace not much larger than the task.
void works_close(simulation::Teleoperator::Params& of) {
  of.control.gate.position_limit_m = of.control.slave_gate.position_limit_m = 0.06;
}

/// As a careful owner may choose it: from nothing to half a newton takes a second.
constexpr double slow_N_per_s = 0.5, grows_for_s = 3.0;
void grows_slowly(simulation::Teleoperator::Params& of) {
  of.control.gate.rate_limit_N_per_s = of.control.slave_gate.rate_limit_N_per_s = slow_N_per_s;
}

constexpr double out_of_reach_N = 200.0;

void without_balance(simulation::Teleoperator::Params& of, FaultPlan&) {
  of.control.supervision.force_sensor.residual_limit_N = out_of_reach_N;
  of.control.supervision.hand_sensor.residual_limit_N = out_of_reach_N;
  for (control::SafetyGate::Params* gate : {&of.control.gate, &of.control.slave_gate}) {
    gate->encoder.frozen_force_N = gate->encoder.unbalanced_force_N = out_of_reach_N;
  }
}
void without_probe(simulation::Teleoperator::Params& of, FaultPlan&) { of.control.supervision.probe.force_N = 0.0; }
/// All that could tell that a motor or an encoder goes the wrong way.
void without_signs(simulation::Teleoperator::Params& of, FaultPlan& plan) {
  without_balance(of, plan);
  without_probe(of, plan);
  for (control::SafetyGate::Params* gate : {&of.control.gate, &of.control.slave_gate}) {
    gate->reversal.force_N = out_of_reach_N;
    gate->velocity_limit_m_per_s = 100.0;
  }
}
void without_workspace(simulation::Teleoperator::Params& of, FaultPlan&) {
  of.control.gate.position_limit_m = of.control.slave_gate.position_limit_m = 10.0;
}
void without_thermal_limit(simulation::Teleoperator::Params& of, FaultPlan&) {
  of.control.gate.thermal.continuous_force_N = of.control.slave_gate.thermal.continuous_force_N = 100.0;
}
/// Every limit at its widest.
void without_limits(simulation::Teleoperator::Params& of, FaultPlan& plan) {
  without_signs(of, plan);
  for (control::SafetyGate::Params* gate : {&of.control.gate, &of.control.slave_gate}) {
    gate->force_limit_N = 100.0;
    gate->rate_limit_N_per_s = 1e6;
    gate->position_limit_m = 10.0;
    gate->encoder.fastest_m_per_s = 100.0;
    gate->energy = {.damp_above_J = 100.0, .hold_above_J = 200.0, .credit_J = 100.0, .drain_W = 50.0};
    gate->thermal.continuous_force_N = 100.0;
  }
  of.control.force_limit_N = 100.0;
  of.master.amplifier.limit_N = of.slave.amplifier.limit_N = 100.0;
}
void with_pedal(simulation::Teleoperator::Params&, FaultPlan& plan) { plan.size = 1.0; }
void falls_slowly(simulation::Teleoperator::Params&, FaultPlan& plan) { plan.size = slow_N_per_s; }
void without_button(simulation::Teleoperator::Params&, FaultPlan& plan) { plan.kind = FaultKind::none; }

constexpr FaultControl balance{"balance of forces, frozen-encoder check", without_balance},
    probe{"sign probe", without_probe},
    signs{"sign probe, reversal latch, balance of forces, frozen-encoder check, velocity limit", without_signs},
    limits{"every limit as wide as its bounds allow", without_limits};

}  // namespace

std::vector<FaultRow> device_rows() {
  return {
      {FaultKind::motor_reversed, "motor-reversed", "motor reversed", "from the start, or for 1 s while following",
       "refused on arming, or latched", wrong_sign, signs, tries_motors},
      {FaultKind::torque_constant, "torque-constant", "torque constant wrong",
       "0.2 to 0.5 times the force, at the master also 2 to 3 times, for 1.5 s", "hold where it matters", wrong_force,
       balance, feels_as_it_is},
      {FaultKind::actuator_dead, "actuator-dead", "actuator dead", "gives nothing for 1.5 s", "hold where it matters",
       wrong_force, signs, feels_as_it_is},
      {FaultKind::actuator_stuck, "actuator-stuck", "actuator stuck",
       "gives 1 to 5 N at the master, 0.2 to 0.5 N at the slave, either way, for 1 s", "hold, drive off", wrong_force,
       limits},
      {FaultKind::actuator_saturated, "actuator-saturated", "actuator saturated",
       "gives 0.1 to 0.5 N at most for 1.5 s", "hold where it matters", wrong_force, signs, feels_as_it_is},
      {FaultKind::actuator_hot,
       "actuator-hot",
       "actuator hot",
       "cooling is poor while the operator presses for 15 s",
       "less force before a winding is damaged",
       cool,
       {"thermal limit", without_thermal_limit}},
      {FaultKind::encoder_reversed, "encoder-reversed", "encoder reversed", "from the start", "refused on arming", seen,
       signs, tries_motors},
      {FaultKind::encoder_slip,
       "encoder-slip",
       "encoder slips",
       "the master's loses 60 to 95 % of the way forward for 20 s",
       "no farther than the workspace",
       nullptr,
       {"workspace limit", without_workspace},
       works_close,
       false},
      {FaultKind::encoder_scale, "encoder-scale", "encoder scale wrong",
       "from the start: 0.1 to 0.25 of the way at the master, 4 to 10 times at the slave", "refused on arming", seen,
       probe, tries_motors},
      {FaultKind::encoder_drift, "encoder-drift", "encoder drifts", "so that it presses on, by 50 to 150 mm/s for 1 s",
       "bounded", nullptr, limits},
      {FaultKind::encoder_noise, "encoder-noise", "encoder noisy", "0.3 to 3 mm RMS for 1 s", "latched", seen, limits},
      {FaultKind::force_sensor_stuck, "force-sensor-stuck", "force sensor stuck", "keeps its reading for 1.5 s",
       "hold where it matters", wrong_force, balance, feels_as_it_is},
      {FaultKind::force_sensor_gain, "force-sensor-gain", "force sensor gain wrong",
       "0.1 to 0.3 or 3 to 10 times the force for 1.5 s", "hold where it matters", wrong_force, balance,
       feels_as_it_is},
      {FaultKind::force_sensor_reversed, "force-sensor-reversed", "force sensor reversed", "for 1.5 s",
       "hold where it matters", wrong_force, limits, feels_as_it_is},
      {FaultKind::force_sensor_drift, "force-sensor-drift", "force sensor drifts", "by 1 to 10 N/s for 1.5 s", "hold",
       wrong_force, balance, feels_as_it_is},
      {FaultKind::force_sensor_late, "force-sensor-late", "force sensor late", "by 200 to 500 ms for 1.5 s",
       "hold where it matters", wrong_force, balance, feels_as_it_is},
      {FaultKind::channels_swapped, "channels-swapped", "channels swapped", "encoder and force sensor, from the start",
       "refused on arming, or latched", seen, limits, tries_motors},
      {FaultKind::hand_lets_go,
       "hand-lets-go",
       "hand releases the handle",
       "for 1 s, and of the dead-man switch in the handle",
       "no site active at once",
       broken_duty,
       {"the switch in the handle: it is on the floor", with_pedal}},
      {FaultKind::handle_clamped, "handle-clamped", "handle clamped", "held fast and pushed 20 to 60 mm on, for 1 s",
       "bounded force", nullptr, limits},
      {FaultKind::emergency_stop,
       "emergency-stop",
       "emergency stop",
       "pressed at one site for 0.5 s",
       "no site active at once, no force",
       broken_duty,
       {"the button's wire", without_button}},
      {FaultKind::slow_stop,
       "slow-stop",
       "stop at a low rate limit",
       "the emergency stop at one site where forces may grow by 0.5 N/s",
       "no force after stop_time_s",
       stopped_in_time,
       {"the limit of the fall: it falls as slowly as it grew", falls_slowly},
       grows_slowly},
      {FaultKind::power_lost, "power-lost", "power lost", "of a motor for 100 to 500 ms",
       "hold; no jump when it comes back", comes_back, signs, feels_as_it_is},
  };
}

void draw_device(FaultPlan& plan, signal::Random& random, double sign) {
  switch (plan.kind) {
    case FaultKind::motor_reversed:
      plan.length_s = 1.0;
      if (plan.choice % 2 == 0) from_the_start(plan);
      break;
    case FaultKind::encoder_reversed:
    case FaultKind::channels_swapped:
      from_the_start(plan);
      break;
    case FaultKind::encoder_scale:
      from_the_start(plan);
      plan.size = plan.site == FaultSite::master ? between_logarithms(random, 0.1, 0.25)
                                                 : between_logarithms(random, 4.0, 10.0);
      break;
    case FaultKind::torque_constant:
      plan.length_s = 1.5;
      plan.size = plan.site == FaultSite::master ? below_or_above(random, 0.2, 0.5, 2.0, 3.0)
                                                 : between_logarithms(random, 0.2, 0.5);
      break;
    case FaultKind::actuator_dead:
      plan.length_s = 1.5;
      break;
    case FaultKind::actuator_stuck:
      plan.length_s = 1.0;
      plan.size = sign * (plan.site == FaultSite::master ? random.uniform(1.0, 5.0) : random.uniform(0.2, 0.5));
      break;
    case FaultKind::actuator_saturated:
      plan.length_s = 1.5;
      plan.size = between_logarithms(random, 0.1, 0.5);
      break;
    case FaultKind::actuator_hot:
      plan.site = FaultSite::master;
      plan.length_s = 15.0;
      plan.size = random.uniform(2.05, 2.4);
      break;
    case FaultKind::encoder_slip:
      plan.site = FaultSite::master;
      plan.length_s = 20.0;
      plan.size = random.uniform(0.6, 0.95);
      break;
    case FaultKind::encoder_drift:
      plan.length_s = 1.0;
      plan.size = (plan.site == FaultSite::master ? 1.0 : -1.0) * random.uniform(0.05, 0.15);
      break;
    case FaultKind::encoder_noise:
      plan.length_s = 1.0;
      plan.size = between_logarithms(random, 0.0003, 0.003);
      break;
    case FaultKind::force_sensor_stuck:
    case FaultKind::force_sensor_reversed:
      plan.site = FaultSite::slave;
      plan.length_s = 1.5;
      break;
    case FaultKind::force_sensor_gain:
      plan.site = FaultSite::slave;
      plan.length_s = 1.5;
      plan.size = below_or_above(random, 0.1, 0.3, 3.0, 10.0);
      break;
    case FaultKind::force_sensor_drift:
      plan.site = FaultSite::slave;
      plan.length_s = 1.5;
      plan.size = sign * between_logarithms(random, 1.0, 10.0);
      break;
    case FaultKind::force_sensor_late:
      plan.site = FaultSite::slave;
      plan.length_s = 1.5;
      plan.size = random.uniform(0.2, 0.5);
      break;
    case FaultKind::hand_lets_go:
      plan.length_s = 1.0;
      break;
    case FaultKind::handle_clamped:
      plan.length_s = 1.0;
      plan.size = random.uniform(0.02, 0.06);
      break;
    case FaultKind::emergency_stop:
      plan.length_s = 0.5;
      break;
    case FaultKind::slow_stop:
      plan.start_s += grows_for_s;
      plan.length_s = 1.0;
      break;
    case FaultKind::power_lost:
      plan.length_s = between_logarithms(random, 0.1, 0.5);
      break;
    default:
      break;
  }
}

}  // namespace tactus::experiments::fault_families
