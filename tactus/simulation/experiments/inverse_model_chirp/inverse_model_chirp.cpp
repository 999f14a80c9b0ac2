// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/prediction_time.hpp>
#include <tactus/identification/axis/rational_fit.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>
#include <tactus/simulation/experiments/inverse_model_chirp/inverse_model_chirp.hpp>
#include <tactus/simulation/teleoperator/statistics.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <utility>

namespace tactus::experiments {

namespace {

using control::InverseModelEstimator;

/// Eight sines, logarithmically spaced from 0.17 to 8.3 Hz, with Schroeder's phases; not the chirp's spectrum.
simulation::Path multisine_path(double amplitude_m) {
  return [amplitude_m](double time_s) {
    constexpr int count = 8;
    simulation::PathPoint point;
    for (int i = 0; i < count; ++i) {
      const double omega = 2.0 * std::numbers::pi * 0.17 * std::pow(8.3 / 0.17, i / (count - 1.0));
      const double phase = omega * time_s - std::numbers::pi * i * (i + 1) / count;
      // Rises from rest within half a second or so, as the chirp does.
      point.position_m += amplitude_m / std::sqrt(1.0 * count) * std::sin(phase);
      point.velocity_m_per_s += amplitude_m / std::sqrt(1.0 * count) * omega * std::cos(phase);
    }
    const double rise = -std::expm1(-time_s * time_s / 0.1);
    const double rise_rate = 2.0 * time_s / 0.1 * std::exp(-time_s * time_s / 0.1);
    return simulation::PathPoint{.position_m = rise * point.position_m,
                                 .velocity_m_per_s = rise * point.velocity_m_per_s + rise_rate * point.position_m};
  };
}

FeltForce felt(const std::vector<double>& force_N, Seconds dt) {
  const auto section = signal::SecondOrderFilter::make({.frequency_Hz = 2.0}, dt).value();
  auto first = section, second = section;
  std::vector<double> slow;
  slow.reserve(force_N.size());
  for (const double force : force_N) slow.push_back(second.step(first.step(force)));
  return {.rms_N = simulation::rms(force_N), .below_2_Hz_N = simulation::rms(slow)};
}

/// The forces that an element feels along a record.
template <class Estimate>
std::vector<double> along(const simulation::SlaveRecord& record, Estimate estimate) {
  std::vector<double> force_N;
  force_N.reserve(record.command.size());
  for (std::size_t i = 0; i < record.command.size(); ++i) {
    force_N.push_back(estimate(record.command[i], record.position[i]));
  }
  return force_N;
}

InverseModelEstimator::Params with_blocks(InverseModelEstimator::Params estimator, int blocks, double time_constant_s) {
  estimator.prediction.kind = signal::PredictionKind::blocks;
  estimator.prediction.blocks = blocks;
  if (blocks > 0) estimator.prediction.block.time_constant_s = time_constant_s;
  estimator.declared_delay_s = 0.0;  // the experiment is there to show what an unpredicted delay does
  return estimator;
}

}  // namespace

simulation::Path chirp_path(const InverseModelChirpTask& task, double end_frequency_Hz) {
  return [=](double time_s) {
    const double sweep = (end_frequency_Hz - task.start_frequency_Hz) / task.duration_s;
    const double phase = 2.0 * std::numbers::pi * (task.start_frequency_Hz + 0.5 * sweep * time_s) * time_s;
    const double omega = 2.0 * std::numbers::pi * (task.start_frequency_Hz + sweep * time_s);
    return simulation::PathPoint{.position_m = task.amplitude_m * std::sin(phase),
                                 .velocity_m_per_s = task.amplitude_m * omega * std::cos(phase)};
  };
}

Check check(const InverseModelChirpParams& params) {
  if (Check error = validate(params)) return error;
  const auto tried =
      InverseModelEstimator::make(with_blocks(params.estimator, 0, 0.0), Seconds{1.0 / params.task.sample_rate_Hz});
  if (!tried) return under("estimator", tried.error());
  if (const double margin_deg = simulation::phase_margin_deg(params.slave); !(margin_deg > 0.0)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "slave.controller_gain_N_per_m",
                 .message = "the slave's position loop is unstable, its phase margin " + rounded_number(margin_deg) +
                            " degrees: lower the gain or the delays, or add damping",
                 .place = {}};
  }
  return {};
}

Result<InverseModelChirpResult> run_inverse_model_chirp(const InverseModelChirpParams& params) {
  if (Check error = check(params)) return *std::move(error);
  const InverseModelChirpTask& task = params.task;
  const Seconds dt{1.0 / task.sample_rate_Hz};
  InverseModelChirpResult result;
  result.phase_margin_deg = simulation::phase_margin_deg(params.slave);

  auto chirp = simulation::follow(params.slave, chirp_path(task, task.end_frequency_Hz), task.duration_s, dt.value);
  if (!chirp) return chirp.error();
  const auto multisine = simulation::follow(params.slave, multisine_path(task.amplitude_m), task.duration_s, dt.value);
  if (!multisine) return multisine.error();
  result.chirp = *std::move(chirp);
  result.command_rms_N = params.estimator.actuator_gain * simulation::rms(result.chirp.command);

  const auto plant = [&](double s) { return simulation::transfer(params.slave, s).real(); };
  const double lags_s = params.slave.delays_and_lags_s();
  constexpr int shown_blocks = 2;
  const auto limit = identification::prediction_time_limit(plant, params.estimator, shown_blocks);
  if (!limit) return under("estimator", limit.error());
  result.limit_s = *limit;
  for (int blocks = 0; blocks <= 3; ++blocks) {
    double time_constant_s = 0.0;
    if (blocks > 0) {
      const auto derived =
          identification::prediction_time_closed_form(lags_s, params.estimator.derivative_filter_s, blocks);
      if (!derived) return derived.error();
      time_constant_s = *derived;
      if (blocks == shown_blocks) result.closed_form_s = *derived;
    }
    const auto made = InverseModelEstimator::make(with_blocks(params.estimator, blocks, time_constant_s), dt);
    if (!made) return under("estimator", made.error());
    const auto forces = [&](const simulation::SlaveRecord& record) {
      return along(record, [estimator = *made](double command, double position) mutable {
        return estimator.step({.command = command, .position = position}).force;
      });
    };
    InverseModelVariant variant{.name = blocks == 0 ? "no prediction" : "prediction",
                                .blocks = blocks,
                                .time_constant_s = time_constant_s,
                                .chirp = {},
                                .multisine = felt(forces(*multisine), dt),
                                .felt_N = forces(result.chirp)};
    variant.chirp = felt(variant.felt_N, dt);
    result.variants.push_back(std::move(variant));
  }

  // The rival of equal degree: measured position to filtered command, nine coefficients free, fitted to the chirp.
  const auto low_pass =
      signal::RationalFilter::make({.denominator_0 = 1.0, .denominator_1 = params.estimator.force_filter_s}, dt);
  if (!low_pass) return under("estimator.force_filter_s", low_pass.error());
  const auto filtered =
      along(result.chirp, [filter = *low_pass, gain = params.estimator.actuator_gain](double command, double) mutable {
        return filter.step(gain * command);
      });
  const auto fit = identification::fit_rational(result.chirp.position, filtered, dt, task.fit_start_frequency_Hz);
  if (!fit) return fit.error();
  const auto model = signal::RationalFilter::make(fit->function, dt);
  if (!model) return model.error();
  const auto forces = [&](const simulation::SlaveRecord& record) {
    return along(record, [model = *model, filter = *low_pass, gain = params.estimator.actuator_gain](
                             double command, double position) mutable {
      return model.step(position) - filter.step(gain * command);
    });
  };
  InverseModelVariant fitted{.name = "fitted fourth order",
                             .blocks = 0,
                             .time_constant_s = 0.0,
                             .chirp = {},
                             .multisine = felt(forces(*multisine), dt),
                             .felt_N = forces(result.chirp)};
  fitted.chirp = felt(fitted.felt_N, dt);
  result.variants.push_back(std::move(fitted));

  for (const double band_Hz : {1.0, 2.0, 5.0, 10.0}) {
    const auto record = simulation::follow(params.slave, chirp_path(task, band_Hz), task.duration_s, dt.value);
    if (!record) return record.error();
    const auto found = identification::prediction_time_from_data(
        {.command = record->command, .position = record->position, .sample_time_s = dt.value}, params.estimator,
        shown_blocks);
    if (!found) return under("estimator", found.error());
    result.by_band.push_back({.band_Hz = band_Hz, .time_constant_s = found->time_constant_s});
  }
  return result;
}

}  // namespace tactus::experiments
