// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/bench_model.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

namespace tactus::identification {

namespace {

constexpr double locked_kg = 1e9;

/// Applied force of a first-order amplifier whose command changes a delay after each tick.
///
/// A step of the model holds its force, the amplifier's changes within it. So that mean and centre of the force are
/// right all the same, what its centre M₁ = ∫(t − h/2)·F dt is off is made up for by a pair of opposite forces: M₁/h²
/// less in this step, as much more in the next.
class Amplifier {
 public:
  Amplifier(const BenchParams& params, double step_s, int steps_per_tick)
      : gain_(params.amplifier_gain),
        offset_N_(params.amplifier_offset_N),
        rate_per_s_(std::max(2.0 * std::numbers::pi * params.amplifier_bandwidth_Hz, 1.0 / params.amplifier_lag_s)),
        step_s_(step_s) {
    const double tick_s = step_s * steps_per_tick;
    const double delay_s = std::clamp(params.amplifier_lag_s - 1.0 / rate_per_s_, 0.0, 0.999 * tick_s);
    switch_step_ = static_cast<int>(delay_s / step_s);
    whole_ = over(0.0, step_s);
    before_ = over(0.0, delay_s - switch_step_ * step_s);
    after_ = over(before_.duration_s, step_s - before_.duration_s);
  }

  /// Force to be held over step `step` of a tick with the command `command_N`.
  double held_N(int step, double command_N) {
    const double target_N = gain_ * command_N + offset_N_;
    Moments moments;
    if (step == switch_step_) {
      advance(target_before_N_, before_, moments);
      target_before_N_ = target_N;
      advance(target_N, after_, moments);
    } else {
      advance(target_before_N_, whole_, moments);
    }
    const double off_N = (moments.first_N_s2 - 0.5 * step_s_ * moments.impulse_N_s) / (step_s_ * step_s_);
    const double owed_N = std::exchange(owed_N_, off_N);
    return moments.impulse_N_s / step_s_ - off_N + owed_N;
  }
  [[nodiscard]] double applied_N() const { return applied_N_; }

 private:
  struct Moments {
    double impulse_N_s = 0.0;  ///< ∫F dt
    double first_N_s2 = 0.0;   ///< ∫t·F dt, from the start of the step
  };
  /// A part of a step with a constant target, and what an exponential decay integrates to over it.
  struct Span {
    double start_s, duration_s, decay, decayed_s, decayed_s2;
  };
  [[nodiscard]] Span over(double start_s, double duration_s) const {
    const double lost = -std::expm1(-rate_per_s_ * duration_s);
    const double decayed_s = lost / rate_per_s_;
    return {start_s, duration_s, 1.0 - lost, decayed_s, (decayed_s - duration_s * (1.0 - lost)) / rate_per_s_};
  }
  void advance(double target_N, const Span& span, Moments& moments) {
    const double away_N = applied_N_ - target_N;
    applied_N_ = target_N + away_N * span.decay;
    const double impulse_N_s = target_N * span.duration_s + away_N * span.decayed_s;
    moments.impulse_N_s += impulse_N_s;
    moments.first_N_s2 +=
        span.start_s * impulse_N_s + 0.5 * target_N * span.duration_s * span.duration_s + away_N * span.decayed_s2;
  }

  double gain_, offset_N_, rate_per_s_, step_s_;
  int switch_step_;
  Span whole_, before_, after_;
  double target_before_N_ = 0.0;
  double applied_N_ = 0.0;
  double owed_N_ = 0.0;
};

/// Force of a grip whose aim moves, less that of the same grip at rest.
class Correction {
 public:
  Correction(const BenchParams& params, double tick_s)
      : gain_per_s_(params.correction_gain_per_s), hand_(params.master.hand), tick_s_(tick_s) {
    const double rate_per_s =
        std::max(2.0 * std::numbers::pi * params.sight_bandwidth_Hz, 1.0 / params.reaction_time_s);
    sight_ = -std::expm1(-rate_per_s * tick_s);
    const double ticks = std::clamp((params.reaction_time_s - 1.0 / rate_per_s) / tick_s, 0.0, 1e6);
    whole_ticks_ = static_cast<std::size_t>(ticks);
    rest_ = ticks - static_cast<double>(whole_ticks_);
    seen_m_.assign(whole_ticks_ + 2, 0.0);
  }
  double force_N(double handle_m) {
    const double last_m = seen_m_[now_];
    now_ = (now_ + 1) % seen_m_.size();
    seen_m_[now_] = last_m + sight_ * (handle_m - last_m);
    const std::size_t older = (now_ + 1) % seen_m_.size(), newer = (now_ + 2) % seen_m_.size();
    const double rate_m_per_s = -gain_per_s_ * (rest_ * seen_m_[older] + (1.0 - rest_) * seen_m_[newer]);
    const double force_N = hand_.stiffness_N_per_m * aim_m_ + hand_.damping_N_s_per_m * rate_m_per_s;
    aim_m_ += rate_m_per_s * tick_s_;
    return force_N;
  }

 private:
  double gain_per_s_;
  mechanics::QuinticSpring::Params hand_;
  double tick_s_;
  double sight_ = 1.0;
  std::size_t whole_ticks_ = 0;
  double rest_ = 0.0;
  std::vector<double> seen_m_;
  std::size_t now_ = 0;
  double aim_m_ = 0.0;
};

/// The model with what lies beyond the assembly left out or locked.
control::MasterModel partial_model(control::MasterModel master, Assembly assembly) {
  if (assembly == Assembly::motor) master.cable = {.stiffness_N_per_m = 0.0, .damping_N_s_per_m = 0.0};
  if (assembly == Assembly::cable) master.drum = {.mass_kg = locked_kg, .friction_N = 0.0};
  if (assembly < Assembly::linkage) {
    master.linkage.stiffness_N_per_m = master.linkage.damping_N_s_per_m = master.linkage.hysteretic_fraction = 0.0;
  }
  if (assembly == Assembly::linkage) master.handle.mass_kg = locked_kg;
  if (assembly != Assembly::held) master.hand.stiffness_N_per_m = master.hand.damping_N_s_per_m = 0.0;
  return master;
}

}  // namespace

std::vector<double> simulate_current(const BenchParams& params, const RigRun& run) {
  Amplifier amplifier(params, run.tick_s, 1);
  std::vector<double> current_N;
  current_N.reserve(run.commanded_force_N.size());
  for (const double command_N : run.commanded_force_N) {
    current_N.push_back(amplifier.applied_N());
    amplifier.held_N(0, command_N);
  }
  return current_N;
}

std::vector<double> simulate_position(const BenchParams& params, Assembly assembly, const MotorProgram& program,
                                      const RigRun& run, int steps_per_tick) {
  const std::size_t ticks = run.position_m.size();
  const double step_s = run.tick_s / steps_per_tick;
  control::InducedMotionModel::Params model_params;
  model_params.master = partial_model(params.master, assembly);
  model_params.friction = control::ModelFriction::at_rest;
  auto model = control::InducedMotionModel::make(model_params, Seconds{step_s});
  auto feedback = MotorFeedback::make(program, Seconds{run.tick_s});
  if (!model || !feedback) return std::vector<double>(ticks, std::numeric_limits<double>::quiet_NaN());
  const bool fed_back = program.stiffness_N_per_m > 0.0 || program.damping_N_s_per_m > 0.0;
  const bool held = assembly == Assembly::held;
  Amplifier amplifier(params, step_s, steps_per_tick);
  Correction correction(params, run.tick_s);

  std::vector<double> position_m(ticks);
  for (std::size_t i = 0; i < ticks; ++i) {
    position_m[i] = model->motor_position_m();
    double command_N = run.commanded_force_N[i];
    if (fed_back) command_N += feedback->step(run.position_m[i] - position_m[i]);
    const double handle_N = held ? correction.force_N(model->state()[2]) : 0.0;
    for (int s = 0; s < steps_per_tick; ++s) {
      model->step({.motor_force_N = amplifier.held_N(s, command_N) + params.bias_N, .handle_force_N = handle_N});
    }
  }
  return position_m;
}

RigRun thinned(const RigRun& run, std::size_t ticks) {
  RigRun thin;
  thin.tick_s = run.tick_s * static_cast<double>(ticks);
  for (std::size_t i = 0; i + ticks <= run.position_m.size(); i += ticks) {
    const auto first = run.commanded_force_N.begin() + static_cast<std::ptrdiff_t>(i);
    thin.commanded_force_N.push_back(std::accumulate(first, first + static_cast<std::ptrdiff_t>(ticks), 0.0) /
                                     static_cast<double>(ticks));
    thin.position_m.push_back(run.position_m[i]);
  }
  return thin;
}

}  // namespace tactus::identification
