// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/kernel/signal/delay_line.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>
#include <tactus/simulation/experiments/hydraulic_rigid_contact/hydraulic_rigid_contact.hpp>
#include <tactus/simulation/teleoperator/statistics.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <span>

namespace tactus::experiments {

namespace {

/// When the person presses and lets go, in s from the start; a press is judged in its last part.
struct Press {
  double reach_from_s, reach_until_s, hold_until_s, leave_until_s;
};
constexpr std::array presses{Press{0.2, 1.0, 2.0, 2.6}, Press{2.8, 3.6, 4.6, 5.2}};
constexpr double press_judged_s = 0.3;
constexpr double both_presses_s = 5.4;  ///< and the way back
/// Where the person waits between the presses, from mid-stroke, as a share of the way to the stop.
constexpr double waiting_share = 0.6;
/// A master that moves less than this, RMS, has settled: what is left is the noise of the estimate and no oscillation.
constexpr double settled_within_m = 1e-4;

/// 0.1 s at the fastest servo.
using Delay = signal::DelayLine<double, 2000>;

double intended_m(const HydraulicRigidContactParams& params, double time_s) {
  const double stop_m = 0.5 * params.slave.cylinder.stroke_m;
  const std::array depths_m{params.task.first_press_m, params.task.second_press_m};
  double at_m = 0.0, from_m = 0.0;
  for (std::size_t i = 0; i < presses.size(); ++i) {
    const auto& [reach_from_s, reach_until_s, hold_until_s, leave_until_s] = presses[i];
    const double pressed_m = stop_m + depths_m[i], waiting_m = waiting_share * stop_m;
    const mechanics::MinimumJerk reach{0.0, pressed_m - from_m, reach_from_s, reach_until_s - reach_from_s};
    const mechanics::MinimumJerk leave{0.0, waiting_m - pressed_m, hold_until_s, leave_until_s - hold_until_s};
    at_m += reach.position_m(time_s) + leave.position_m(time_s);
    from_m = waiting_m;
  }
  return at_m;
}

/// The master under the person's arm and a force, by symplectic Euler in steps of at most 0.1 ms.
class Master {
 public:
  Master(const HydraulicMasterParams& params, double tick_s)
      : params_(params), steps_(static_cast<int>(std::ceil(tick_s / 1e-4))), step_s_(tick_s / steps_) {}

  void advance(double intended_m, double intended_at_next_tick_m, double force_N) noexcept {
    const double rate = (intended_at_next_tick_m - intended_m) / (step_s_ * steps_);
    for (int i = 0; i < steps_; ++i) {
      const double aim_m = intended_m + rate * step_s_ * i;
      const double arm_N = params_.hand.stiffness_N_per_m * (aim_m - position_m_) +
                           params_.hand.damping_N_s_per_m * (rate - velocity_m_per_s_);
      velocity_m_per_s_ += step_s_ * (arm_N + force_N) / params_.mass_kg;
      position_m_ += step_s_ * velocity_m_per_s_;
    }
  }
  [[nodiscard]] double position_m() const noexcept { return position_m_; }

 private:
  HydraulicMasterParams params_;
  int steps_;
  double step_s_;
  double position_m_ = 0.0, velocity_m_per_s_ = 0.0;
};

RigidContact judge(const RigidContactRun& run, const std::vector<bool>& touching, const Press& press, double tick_s) {
  const auto tick = [&](double time_s) { return static_cast<std::size_t>(std::lround(time_s / tick_s)); };
  RigidContact contact;
  std::size_t first = tick(press.hold_until_s);
  for (std::size_t i = tick(press.reach_from_s) + 1; i < tick(press.hold_until_s); ++i) {
    if (!touching[i] || touching[i - 1]) continue;
    first = std::min(first, i);
    ++contact.touches;
  }
  contact.touched = contact.touches > 0;
  const auto last_part = [&](const std::vector<double>& signal) {
    return std::span(signal).subspan(tick(press.hold_until_s - press_judged_s), tick(press_judged_s));
  };
  contact.fed_back_N = simulation::mean(last_part(run.fed_back_N));
  contact.ripple_N = simulation::rms(last_part(run.fed_back_N), contact.fed_back_N);
  contact.pressure_force_N = simulation::mean(last_part(run.pressure_force_N));
  contact.stop_force_N = simulation::mean(last_part(run.stop_force_N));
  const auto master_m = last_part(run.master_m);
  const auto judged = touching.begin() + static_cast<std::ptrdiff_t>(tick(press.hold_until_s - press_judged_s));
  const bool stays = std::all_of(judged, judged + static_cast<std::ptrdiff_t>(tick(press_judged_s)), std::identity{});
  contact.settled = stays && simulation::rms(master_m, simulation::mean(master_m)) <= settled_within_m;
  const auto half_after_s = [&](const std::vector<double>& signal, double last_N) {
    std::size_t i = first;
    while (i < tick(press.hold_until_s) && signal[i] < 0.5 * last_N) ++i;
    return static_cast<double>(i - first) * tick_s;
  };
  contact.estimate_after_s = half_after_s(run.fed_back_N, contact.fed_back_N);
  contact.pressure_after_s = half_after_s(run.pressure_force_N, contact.pressure_force_N);
  return contact;
}

Result<RigidContactRun> run_with(const HydraulicRigidContactParams& params,
                                 const control::InverseModelEstimator::Params& model) {
  auto rig = simulation::HydraulicRig::make(params);
  if (!rig) return rig.error();
  const Seconds tick{rig->tick_s()};
  auto estimator = control::InverseModelEstimator::make(model, tick);
  if (!estimator) return under("model", estimator.error());
  const auto delay = Delay::make({.delay_s = params.task.delay_s}, tick);
  if (!delay) return under("task", delay.error());
  Delay to_slave = *delay, to_master = *delay;
  auto pressure_filter = signal::SecondOrderFilter::make({.frequency_Hz = params.task.pressure_filter_Hz}, tick);
  if (!pressure_filter) return under("task.pressure_filter_Hz", pressure_filter.error());
  Master master(params.master, tick.value);

  RigidContactRun run{.name = model.prediction.blocks == 0 ? "no prediction" : "prediction",
                      .blocks = model.prediction.blocks,
                      .time_constant_s = model.prediction.blocks == 0 ? 0.0 : model.prediction.block.time_constant_s,
                      .contacts = {},
                      .time_s = {},
                      .master_m = {},
                      .slave_m = {},
                      .fed_back_N = {},
                      .pressure_force_N = {},
                      .stop_force_N = {}};
  std::vector<bool> touching;
  const auto ticks = static_cast<std::size_t>(std::lround(both_presses_s / tick.value));
  for (std::size_t i = 0; i < ticks; ++i) {
    const simulation::HydraulicRig::Sample sample = rig->sample();
    const double felt_N = estimator->step({.command = sample.current_mA, .position = sample.position_m}).force;
    const double at_master_N = to_master.step(felt_N / params.task.force_division);
    const double wanted_m = to_slave.step(master.position_m());
    run.time_s.push_back(sample.time_s);
    run.master_m.push_back(master.position_m());
    run.slave_m.push_back(sample.position_m);
    run.fed_back_N.push_back(-at_master_N);
    run.pressure_force_N.push_back(pressure_filter->step(sample.pressure_force_N) / params.task.force_division);
    run.stop_force_N.push_back(-sample.end_stop_force_N / params.task.force_division);
    touching.push_back(sample.end_stop_force_N < 0.0);
    master.advance(intended_m(params, sample.time_s), intended_m(params, sample.time_s + tick.value), at_master_N);
    rig->advance(sample, wanted_m);
  }
  for (std::size_t i = 0; i < presses.size(); ++i) run.contacts[i] = judge(run, touching, presses[i], tick.value);
  const auto first = std::find(touching.begin(), touching.end(), true) - touching.begin();
  if (first > 0)
    run.false_force_N = simulation::rms(std::span(run.fed_back_N).first(static_cast<std::size_t>(first)), 0.0);
  return run;
}

}  // namespace

Check check(const HydraulicRigidContactParams& params) {
  if (Check error = validate(params)) return error;
  const auto rig = simulation::HydraulicRig::make(params);
  if (!rig) return rig.error();
  const Seconds tick{rig->tick_s()};
  if (auto filter = signal::SecondOrderFilter::make({.frequency_Hz = params.task.pressure_filter_Hz}, tick); !filter) {
    return under("task.pressure_filter_Hz", filter.error());
  }
  return {};
}

Result<std::vector<RigidContactRun>> run_hydraulic_rigid_contact(const HydraulicRigidContactParams& params) {
  const auto rig = simulation::IdentifiedRig::make(params, params.task.training_amplitude_m);
  if (!rig) return rig.error();
  std::vector<RigidContactRun> runs;
  for (const std::int64_t blocks : {std::int64_t{0}, params.task.blocks}) {
    const auto model = rig->with_blocks(blocks);
    if (!model) return model.error();
    auto run = run_with(params, *model);
    if (!run) return run.error();
    runs.push_back(*std::move(run));
  }
  return runs;
}

}  // namespace tactus::experiments
