// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/linear_fit.hpp>
#include <tactus/identification/axis/prediction_time.hpp>
#include <tactus/identification/axis/zero_phase.hpp>
#include <tactus/simulation/teleoperator/hydraulic_rig.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tactus::simulation {

namespace {

/// The paper's damping function takes the velocity in mm/s.
constexpr double velocity_scale_m_per_s = 1e-3;
constexpr double fit_cutoff_Hz = 30.0;

}  // namespace

Result<HydraulicRig> HydraulicRig::make(const HydraulicRigParams& params) {
  if (Check error = validate(params)) return *std::move(error);
  const auto clock = Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const auto slave = mechanics::ServoHydraulicSlave::make(params.slave, Seconds{clock->substep_s});
  if (!slave) return under("slave", slave.error());
  return HydraulicRig(params, *clock, *slave);
}

HydraulicRig::Sample HydraulicRig::sample() noexcept {
  const auto reading = slave_.measure();
  return {.time_s = static_cast<double>(tick_) * clock_.tick_s,
          .current_mA = current_mA_,
          .position_m = reading.position_m,
          .pressure_force_N = reading.pressure_force_N,
          .end_stop_force_N = end_stop_force_N_};
}

void HydraulicRig::advance(const Sample& measured, double wanted_m) noexcept {
  const double next_mA = std::clamp(gain_mA_per_m_ * (wanted_m - measured.position_m), -limit_mA_, limit_mA_);
  end_stop_force_N_ = 0.0;
  for (int i = 0; i < clock_.substeps; ++i) {
    if (i == clock_.late_substeps) current_mA_ = next_mA;
    end_stop_force_N_ += slave_.step(current_mA_).end_stop_force_N / clock_.substeps;
  }
  ++tick_;
}

Result<std::vector<HydraulicRig::Sample>> follow(const HydraulicRigParams& params,
                                                 const std::function<double(double time_s)>& wanted_m,
                                                 double duration_s) {
  auto rig = HydraulicRig::make(params);
  if (!rig) return rig.error();
  const auto ticks = static_cast<std::size_t>(std::lround(duration_s / rig->tick_s()));
  std::vector<HydraulicRig::Sample> run;
  run.reserve(ticks);
  for (std::size_t i = 0; i < ticks; ++i) {
    run.push_back(rig->sample());
    rig->advance(run.back(), wanted_m(run.back().time_s));
  }
  return run;
}

Result<FittedInverseModel> fit_inverse_model(const ValveCurrentModelParams& params,
                                             const std::vector<HydraulicRig::Sample>& run) {
  if (run.size() < 2) {
    return Error{.code = ErrorCode::inconsistent, .parameter = {}, .message = "a fit needs a run", .place = {}};
  }
  const Seconds tick{run[1].time_s - run[0].time_s};
  std::vector<double> current_mA, position_m;
  for (const HydraulicRig::Sample& sample : run) {
    current_mA.push_back(sample.current_mA);
    position_m.push_back(sample.position_m);
  }
  const auto smooth = [&](const std::vector<double>& signal) {
    return identification::zero_phase_low_pass(signal, fit_cutoff_Hz, tick);
  };
  const auto position = smooth(position_m);
  if (!position) return position.error();
  const std::vector<double> velocity = identification::central_difference(*position, tick);
  const std::vector<double> acceleration = identification::central_difference(velocity, tick);
  // The step of the damping passes the same filter as the current does.
  std::vector<double> step;
  for (const double v : velocity) step.push_back(0.5 * std::tanh(0.5 * v / velocity_scale_m_per_s));
  const auto smooth_step = smooth(step);
  if (!smooth_step) return smooth_step.error();
  const auto observed = smooth(current_mA);
  if (!observed) return observed.error();

  std::vector<double> regressors;
  for (std::size_t i = 0; i < run.size(); ++i) {
    const double v = velocity[i];
    regressors.insert(regressors.end(), {(*smooth_step)[i], v, std::abs(v) * v, acceleration[i], 1.0});
  }
  const auto fit = identification::fit_linear(regressors, 5, *observed);
  if (!fit) return fit.error();
  const auto& c = fit->parameters;
  if (!(c[0] > 0.0 && c[1] > 0.0)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "model",
                 .message = "no damping that grows with velocity follows from this run (" + rounded_number(c[0]) +
                            " mA at the step, " + rounded_number(c[1]) + " mA s/m): move farther or faster",
                 .place = {}};
  }
  FittedInverseModel fitted{
      .model = {}, .apparent_mass_kg = params.actuator_gain_N_per_mA * c[3], .residual_rms_mA = fit->residual_rms};
  fitted.model.mass_kg = params.mass_kg;
  fitted.model.viscous_damping_N_s_per_m = 0.0;
  fitted.model.actuator_gain = params.actuator_gain_N_per_mA;
  fitted.model.force_filter_s = params.force_filter_s;
  fitted.model.derivative_filter_s = params.derivative_filter_s;
  fitted.model.prediction.blocks = 0;
  fitted.model.friction = {
      .law = control::FrictionLaw::sigmoid,
      .force_N = params.actuator_gain_N_per_mA * c[0],
      .offset_N = params.actuator_gain_N_per_mA * c[4],
      .velocity_scale_m_per_s = velocity_scale_m_per_s,
      .linear = c[1] * velocity_scale_m_per_s / c[0],
      // An orifice never gives more than in proportion, but noise may say so where it hardly can be seen.
      .quadratic = std::max(0.0, c[2] * velocity_scale_m_per_s * velocity_scale_m_per_s / c[0])};
  return fitted;
}

Result<IdentifiedRig> IdentifiedRig::make(const HydraulicRigParams& params, double amplitude_m) {
  constexpr double duration_s = 20.0;
  const auto wanted_m = [amplitude_m](double time_s) {
    constexpr std::array frequencies_Hz{0.13, 0.37, 0.71, 1.3, 2.3, 3.7, 5.3, 7.9};
    double sum = 0.0;
    for (std::size_t i = 0; i < frequencies_Hz.size(); ++i) {
      const auto line = static_cast<double>(i);
      sum += std::sin(2.0 * std::numbers::pi * frequencies_Hz[i] * time_s + 0.7 * line * line);
    }
    // From rest within a second.
    return amplitude_m * std::min(1.0, time_s) * sum / static_cast<double>(frequencies_Hz.size());
  };
  const auto run = follow(params, wanted_m, duration_s);
  if (!run) return run.error();
  auto fitted = fit_inverse_model(params.model, *run);
  if (!fitted) return fitted.error();
  IdentifiedRig rig;
  rig.fitted_ = *std::move(fitted);
  rig.tick_s_ = 1.0 / params.servo.rate_Hz;
  for (const HydraulicRig::Sample& sample : *run) {
    rig.current_mA_.push_back(sample.current_mA);
    rig.position_m_.push_back(sample.position_m);
  }
  return rig;
}

Result<control::InverseModelEstimator::Params> IdentifiedRig::with_blocks(std::int64_t blocks) const {
  control::InverseModelEstimator::Params model = fitted_.model;
  if (blocks == 0) return model;
  const auto best = identification::prediction_time_from_data(
      {.command = current_mA_, .position = position_m_, .sample_time_s = tick_s_}, model, blocks);
  if (!best) return under("model", best.error());
  model.prediction.blocks = blocks;
  model.prediction.block.time_constant_s = best->time_constant_s;
  return model;
}

}  // namespace tactus::simulation
