// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/declared.hpp>
#include <tactus/analysis/stability/map_point.hpp>
#include <tactus/kernel/control/stages/cancellation.hpp>
#include <tactus/simulation/experiments/contact_metrics.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace tactus::stability {

namespace {

/// A slave that has not met the wall this long after the reach has ended never will.
constexpr double touch_timeout_s = 0.2;
/// As in `control::GripCancellation`, which is not made here because its bank of models is not needed.
constexpr control::Cancellation::Params cancellation_defaults{};

double start_m(const MapParams& params) {
  return params.environment.position_m / params.control.position_scale - params.task.depth_m;
}

double reach_s(const MapTask& task) {
  return mechanics::MinimumJerk::duration_for(2.0 * task.depth_m, task.speed_m_per_s);
}

/// An error naming the first key outside of `[control]` that asks for something that the map's loop does not have.
Check check_supported(const MapParams& params) {
  struct Demand {
    bool met;
    const char* key;
    const char* remedy;
  };
  const Demand demands[] = {
      {params.environment.law == mechanics::ContactLaw::kelvin_voigt, "environment.law", "write kelvin-voigt"},
      {params.slave.force_sensor.noise_rms_N == 0.0, "slave.force_sensor.noise_rms_N", "write 0"},
      {params.channel.to_slave.jitter_s == 0.0, "channel.to_slave.jitter_s", "write 0"},
      {params.channel.to_slave.loss_fraction == 0.0, "channel.to_slave.loss_fraction", "write 0"},
      {params.channel.to_master.jitter_s == 0.0, "channel.to_master.jitter_s", "write 0"},
      {params.channel.to_master.loss_fraction == 0.0, "channel.to_master.loss_fraction", "write 0"},
      {params.person.grip_change.factor == 1.0, "operator.grip_change.factor", "write 1, and vary task.grip"},
  };
  for (const Demand& demand : demands) {
    if (demand.met) continue;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = demand.key,
                 .message = std::string("asks for something that the loop of a map does not have: ") + demand.remedy +
                            ", or use `tactus run` with an experiment of kind tapping",
                 .place = {}};
  }
  return {};
}

LaneGate<double> gate_of(const control::SafetyGate::Params& gate, double tick_s) {
  return {.force_limit_N = gate.force_limit_N, .largest_step_N = gate.rate_limit_N_per_s * tick_s};
}

std::size_t ticks_in(double duration_s, double tick_s) {
  return static_cast<std::size_t>(std::lround(duration_s / tick_s));
}

}  // namespace

simulation::Teleoperator::Params teleoperator_params(const MapParams& params) {
  simulation::Teleoperator::Params teleoperator = params;
  teleoperator.person.grip = mechanics::scaled(params.person.grip, params.task.grip);
  teleoperator.control.model = experiments::mismatched(params.control.model, params.task.mismatch);
  return teleoperator;
}

Result<LanePlan> make_plan(const MapParams& params) {
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const double longest_s = reach_s(params.task) + touch_timeout_s;
  if (longest_s > 60.0) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "task.speed_m_per_s",
                 .message = "the reach would take " + rounded_number(longest_s) + " s, over a minute: go faster",
                 .place = {}};
  }
  return LanePlan{
      .clock = {.tick_s = clock->tick_s, .substeps = clock->substeps, .late_substeps = clock->late_substeps},
      .approach_ticks = ticks_in(longest_s, clock->tick_s),
      .observation_ticks = ticks_in(params.task.observation_s, clock->tick_s)};
}

Result<LanePoint> make_point(const MapParams& params) {
  if (auto error = validate(params)) return *std::move(error);
  if (auto error = check_declared(params.control, Analysis::lanes)) return *std::move(error);
  if (auto error = check_supported(params)) return *std::move(error);
  const simulation::Teleoperator::Params rig = teleoperator_params(params);
  const auto clock = simulation::Clock::make(rig.servo, rig.plant);
  if (!clock) return clock.error();
  const Seconds tick{clock->tick_s}, substep{clock->substep_s};

  auto master = mechanics::CableDrivenMaster::make(rig.master, rig.person.grip, substep);
  if (!master) return under(master.error().parameter.starts_with("grip.") ? "operator" : "master", master.error());
  auto slave = mechanics::ElectricSlave::make(rig.slave, rig.environment, substep);
  if (!slave) {
    const Error& error = slave.error();
    return error.parameter.starts_with("environment.") ? error : under("slave", error);
  }
  const auto person = mechanics::Operator::make(rig.person, tick);
  if (!person) return under("operator", person.error());
  const auto model = control::InducedMotionModel::make({.master = rig.control.model,
                                                        .fidelity = rig.control.cancellation_model,
                                                        .step = rig.control.cancellation_step,
                                                        .friction = rig.control.cancellation_friction},
                                                       tick);
  if (!model) return under("control", under("model", model.error()));
  const auto intended = signal::FilteredDerivative::make(cancellation_defaults.intended_velocity, tick);
  if (!intended) return under("control", intended.error());
  const auto servo = control::ServoPd::make(rig.control.slave, tick);
  if (!servo) return under("control", under("slave", servo.error()));

  const double scale = rig.control.position_scale;
  const double from_m = start_m(params);
  master->reset(from_m);
  slave->reset(scale * from_m);
  return LanePoint{
      .loop = {.master = master->mechanism().motion(),
               .master_amplifier = master->amplifier().motion(),
               .master_resolution_m = rig.master.encoder.resolution_m,
               .slave = slave->mechanism().motion(),
               .slave_amplifier = slave->amplifier().motion(),
               .slave_resolution_m = rig.slave.encoder.resolution_m,
               .wall = {.surface_m = rig.environment.position_m,
                        .stiffness_N_per_m = rig.environment.stiffness_N_per_m,
                        .damping_N_s_per_m = rig.environment.damping_N_s_per_m},
               .sensor = slave->force_sensor().analogue(),
               .sensor_offset_N = rig.slave.force_sensor.offset_N,
               .sensor_limit_N = rig.slave.force_sensor.limit_N,
               .model = model->exact_step(),
               .intended_velocity = intended->motion(),
               .cancels = rig.control.cancellation == control::CancellationMode::on ? 1.0 : 0.0,
               .hysteretic = model->hysteretic() ? 1.0 : 0.0,
               .position_scale = scale,
               .force_gain = rig.control.force_gain,
               .force_limit_N = rig.control.force_limit_N,
               .proportional_N_per_m = rig.control.slave.proportional_N_per_m,
               .derivative_N_s_per_m = rig.control.slave.derivative_N_s_per_m,
               .error_rate = servo->rate().motion(),
               .master_gate = gate_of(rig.control.gate, clock->tick_s),
               .slave_gate = gate_of(rig.control.slave_gate, clock->tick_s),
               .person = person->motion(),
               .path = {.start_m = from_m, .stroke_m = 2.0 * params.task.depth_m, .duration_s = reach_s(params.task)},
               .substep_s = clock->substep_s},
      .to_slave_ticks = ticks_in(rig.channel.to_slave.delay_s, clock->tick_s),
      .to_master_ticks = ticks_in(rig.channel.to_master.delay_s, clock->tick_s),
      .reaction_ticks = person->reaction_ticks(),
      .slave_start_m = scale * from_m};
}

PointResult judge(const LaneResult& run, std::span<const double> contact_force_N, double tick_s) {
  PointResult result{.contacts = run.touches, .peak_force_N = run.peak_force_N};
  if (run.touched) {
    const auto metrics = experiments::judge_contact(contact_force_N, run.first_touch, tick_s);
    result.settling_time_s = metrics.settling_time_s;
    result.residual_rms_N = metrics.residual_rms_N;
    result.verdict = !metrics.settled                                           ? experiments::Verdict::limit_cycle
                     : metrics.settling_time_s <= experiments::settled_within_s ? experiments::Verdict::settled
                                                                                : experiments::Verdict::ringing;
  }
  if (run.diverged || !run.touched) result.verdict = experiments::Verdict::diverged;
  return result;
}

}  // namespace tactus::stability
