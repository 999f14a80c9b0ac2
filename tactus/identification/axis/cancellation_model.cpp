// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/cancellation_model.hpp>
#include <tactus/identification/axis/zero_phase.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::identification {

namespace {

constexpr double slow_Hz = 20.0;
constexpr double impact_s = 0.5;
constexpr double ring_s = 0.06;

/// A push against the hand with a ring on it, gone before the next one comes.
double impact_N(double time_s, double push_N, double ring_Hz) {
  constexpr double rise_s = 0.002, decay_s = 0.025, held_s = 0.2, fade_s = 0.1;
  if (time_s >= held_s + fade_s) return 0.0;
  const double fade = time_s < held_s ? 1.0 : 0.5 + 0.5 * std::cos(std::numbers::pi * (time_s - held_s) / fade_s);
  const double ring = std::cos(2.0 * std::numbers::pi * ring_Hz * time_s) * std::exp(-time_s / decay_s);
  return -push_N * fade * -std::expm1(-time_s / rise_s) * (0.6 + 0.4 * ring);
}

Result<std::vector<double>> fast_part(const std::vector<double>& position_m, Seconds tick) {
  auto slow = zero_phase_low_pass(position_m, slow_Hz, tick);
  if (!slow) return slow.error();
  for (std::size_t i = 0; i < position_m.size(); ++i) (*slow)[i] = position_m[i] - (*slow)[i];
  return slow;
}

/// Of the samples shortly after an impact began, when it rings.
double square_sum_of_rings(const std::vector<double>& values, std::size_t each, std::size_t ring) {
  double sum = 0.0;
  for (std::size_t i = each; i < values.size(); ++i) sum += i % each < ring ? values[i] * values[i] : 0.0;
  return sum;
}

}  // namespace

control::MasterModel model_for_cancellation(const BenchParams& found, double full_force_N, double full_deflection_m) {
  const double per_command = 1.0 / found.amplifier_gain;
  control::MasterModel model = found.master;
  model.linkage.damping_N_s_per_m = std::max(0.0, model.linkage.damping_N_s_per_m);
  for (double* value :
       {&model.motor.mass_kg, &model.motor.friction_N, &model.cable.stiffness_N_per_m, &model.cable.damping_N_s_per_m,
        &model.drum.mass_kg, &model.drum.friction_N, &model.linkage.stiffness_N_per_m, &model.linkage.damping_N_s_per_m,
        &model.handle.mass_kg, &model.hand.stiffness_N_per_m, &model.hand.damping_N_s_per_m}) {
    *value *= per_command;
  }
  model.hand.quintic_stiffness_N_per_m5 = full_force_N / std::pow(full_deflection_m, 5);
  return model;
}

Result<ImpactCheck> check_on_impacts(Rig& rig, const control::MasterModel& model, double full_force_N) {
  struct Impact {
    double share, ring_Hz;
  };
  constexpr Impact impacts[] = {{0.25, 90.0}, {0.5, 60.0}, {1.0, 140.0}, {0.5, 140.0}, {1.0, 60.0}, {0.75, 90.0}};
  const Seconds tick{rig.tick_s()};
  const auto each = static_cast<std::size_t>(impact_s / tick.value);
  MotorProgram program;
  program.force_N.assign(each, 0.0);  // at rest, as afterwards
  for (const Impact& impact : impacts) {
    for (std::size_t i = 0; i < each; ++i) {
      program.force_N.push_back(
          impact_N(static_cast<double>(i) * tick.value, impact.share * full_force_N, impact.ring_Hz));
    }
  }
  if (auto error = rig.assemble(Assembly::held)) return *std::move(error);
  const auto run = rig.run(program);
  if (!run) return run.error();

  control::InducedMotionModel::Params params;
  params.master = model;
  params.friction = control::ModelFriction::at_rest;
  auto induced = control::InducedMotionModel::make(params, tick);
  if (!induced) return under("model", induced.error());
  std::vector<double> modelled_m;
  for (const double force_N : run->commanded_force_N) {
    modelled_m.push_back(induced->motor_position_m());
    induced->step({.motor_force_N = force_N});
  }
  auto measured = fast_part(run->position_m, tick);
  if (!measured) return measured.error();
  auto modelled = fast_part(modelled_m, tick);
  if (!modelled) return modelled.error();

  ImpactCheck check;
  check.tick_s = tick.value;
  check.force_N = run->commanded_force_N;
  std::vector<double> left_m(measured->size());
  for (std::size_t i = 0; i < left_m.size(); ++i) left_m[i] = (*measured)[i] - (*modelled)[i];
  const auto ring = static_cast<std::size_t>(ring_s / tick.value);
  check.residual = std::sqrt(square_sum_of_rings(left_m, each, ring) / square_sum_of_rings(*measured, each, ring));
  check.measured_m = *std::move(measured);
  check.modelled_m = *std::move(modelled);
  return check;
}

}  // namespace tactus::identification
