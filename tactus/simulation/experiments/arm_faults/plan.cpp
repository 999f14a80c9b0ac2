// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/arm_faults/plan.hpp>
#include <tactus/simulation/experiments/faults/fault_operator.hpp>
#include <tactus/simulation/experiments/faults/internal/families.hpp>
#include <tactus/simulation/experiments/faults/schedule.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::experiments {

namespace {

constexpr double longest_arm_cut_s = 1.0;
constexpr double most_spike_rad = 3.0;
/// How long arms are watched to which nothing happens.
constexpr double clean_s = 3.0;
/// By which the lengths of a URDF are too large: centimetres and millimetres in half of the plans.
double drawn_length_factor(std::int64_t index, signal::Random& random) {
  const double drawn = fault_families::between_logarithms(random, 2.0, 1000.0);
  return index % 8 == 1 ? 100.0 : index % 8 == 3 ? 1000.0 : drawn;
}

}  // namespace

FaultPlan draw_arm_plan(FaultKind kind, std::int64_t index, std::int64_t seed, const control::SafetyGate::Params& gate,
                        double rate_Hz, double wired_s) {
  FaultPlan plan = draw_plan(kind, index, seed, longest_arm_cut_s);
  signal::Random random = signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(20);
  const double sign = random.uniform() < 0.5 ? -1.0 : 1.0;
  // On one axis some wiring is always wrong from the start.
  if (is_there_at_start(plan)) plan.start_s = random.uniform(0.7, 1.7);
  // Half of all faults begin where the person presses most.
  if (random.uniform() < 0.5) {
    const double moving_s = plan.start_s - fault_schedule::still_until_s;
    plan.start_s = fault_schedule::still_until_s + FaultOperator(plan, 0.0, true).deepest_after_s(moving_s);
  }
  const double least_rad = std::min(2.0 * gate.encoder.fastest_m_per_s / rate_Hz, most_spike_rad);
  switch (kind) {
    case FaultKind::none:
      plan.length_s = clean_s;
      break;
    case FaultKind::encoder_spike:
      plan.size = sign * fault_families::between_logarithms(random, least_rad, most_spike_rad);
      break;
    case FaultKind::encoder_wrap:  // of one turn of the joint
      plan.size = sign * 2.0 * std::numbers::pi;
      break;
    case FaultKind::torque_constant:
      plan.size = sign < 0.0 ? fault_families::between_logarithms(random, 0.2, 0.5)
                             : fault_families::between_logarithms(random, 2.0, 3.0);
      break;
    case FaultKind::dead_man_released:
      plan.length_s = 1.0;
      break;
    case FaultKind::motor_reversed:
    case FaultKind::encoder_reversed:
      plan.start_s = index % 2 == 0 ? 0.0 : plan.start_s;
      plan.length_s = is_wired_so(plan) ? wired_s : 1.0;
      break;
    case FaultKind::configurations_differ:
      plan.start_s = 0.0;
      break;
    case FaultKind::model_wrong:
      plan.start_s = 0.0;
      plan.length_s = wired_s;
      plan.size = is_of_lengths(plan) ? drawn_length_factor(index, random)
                                      : fault_families::between_logarithms(random, 1.5, 10.0);
      break;
    default:
      break;
  }
  return plan;
}

std::size_t joint_of_plan(const FaultPlan& plan, std::size_t joints) {
  return static_cast<std::size_t>(signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(21).bits() % joints);
}

FaultDuty arm_duty_of(const FaultPlan& plan, const control::SupervisionParams& supervision, double rate_Hz) {
  const double grace_s = fault_families::grace_ticks / rate_Hz;
  if (plan.kind == FaultKind::power_lost) {
    return {.kind = FaultDuty::Kind::stops,
            .within_s = grace_s,
            .seen = FaultDuty::Seen::from_one_to_the_other,
            .by_packets = true};
  }
  return duty_of(plan, supervision, rate_Hz);
}

std::vector<FaultRow> arm_fault_rows(std::string_view only) {
  std::vector<FaultRow> rows{
      {FaultKind::none, "clean", "clean", "nothing", "no trip"},
      {FaultKind::loss_bursts, "loss-bursts", "loss in bursts", "Gilbert-Elliott, both ways",
       "extrapolation, decay, hold; nothing stale applied"},
      {FaultKind::disorder, "disorder", "delay, jitter, order, copies", "up to 30 ms, both ways", "the newest wins"},
      {FaultKind::cut, "cut", "link cut", "10 ms to 1 s", "hold within the time-out, resume only after arming"},
      {FaultKind::restart, "restart", "site killed and restarted", "dead for 20 ms to 1 s",
       "hold within the time-out, resume only after arming"},
      {FaultKind::bad_number, "bad-number", "bad number",
       "NaN, infinity, huge: position, velocity, torque of a joint's drive or packet, or a packet's age",
       "refused, finite output"},
      {FaultKind::encoder_spike, "encoder-spike", "encoder spike", "one reading of a joint, up to 3 rad",
       "latched in the control cycle"},
      {FaultKind::encoder_freeze, "encoder-freeze", "encoder frozen", "of a joint for 1 s", "bounded"},
      {FaultKind::encoder_wrap, "encoder-wrap", "encoder wrap", "of a joint by a turn", "latched in the control cycle"},
      {FaultKind::encoder_reversed, "encoder-reversed", "encoder reversed",
       "of a joint, from the start or for 1 s while following", "never followed, or bounded"},
      {FaultKind::motor_reversed, "motor-reversed", "motor reversed",
       "of a joint, its drive's law too, from the start or for 1 s while following", "never followed, or bounded"},
      {FaultKind::torque_constant, "torque-constant", "torque constant wrong",
       "a joint gives 0.2 to 0.5 or 2 to 3 times what its drive reports, for 1.5 s", "bounded"},
      {FaultKind::actuator_dead, "actuator-dead", "motor dead", "of a joint, without a report of the drive, for 1.5 s",
       "bounded"},
      {FaultKind::power_lost, "power-lost", "power lost", "of a joint's drive, which reports it, for 100 to 500 ms",
       "no site active at once"},
      {FaultKind::stall, "stall", "site stalled", "1 to 100 ms, its drives continue to run their law",
       "hold after a long one"},
      {FaultKind::hand_lets_go, "hand-lets-go", "hand releases the handle",
       "for 1 s, and of the dead-man switch at the tool", "no site active at once, neither arm falls"},
      {FaultKind::dead_man_released, "dead-man-released", "dead-man switch released", "for 1 s, the hand holds on",
       "no site active at once"},
      {FaultKind::emergency_stop, "emergency-stop", "emergency stop", "pressed at one site for 0.5 s",
       "no site active at once, no torque"},
      {FaultKind::configurations_differ, "configurations-differ", "configurations differ",
       "the tool, a gate of [rig], the time-out, the gain, the gripper or the URDF", "never armed, the key is named"},
      {FaultKind::model_wrong, "model-wrong", "URDF overstates the weight",
       "masses 1.5 to 10 times, or lengths 2 to 1000 times", "no power, or released before a joint leaps"},
  };
  for (FaultRow& row : rows) {
    row.resumes = row.kind != FaultKind::encoder_reversed && row.kind != FaultKind::motor_reversed &&
                  row.kind != FaultKind::configurations_differ && row.kind != FaultKind::model_wrong;
  }
  if (!only.empty()) std::erase_if(rows, [only](const FaultRow& row) { return row.id != only; });
  return rows;
}

}  // namespace tactus::experiments
