// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/force_comparison.hpp>
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/experiments/force_estimators/force_estimators.hpp>
#include <tactus/simulation/teleoperator/statistics.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

namespace tactus::experiments {

namespace {

using control::InverseModelEstimator;

/// Contact forces are compared up to here, with a zero-phase low-pass of the true force.
constexpr double comparison_cutoff_Hz = 200.0;

double start_of(const ForceEstimatorsParams& params) {
  return params.environment.position_m - 3.0 * params.task.free_amplitude_m;
}

/// Where the slave is told to be.
double path_m(const ForceEstimatorsParams& params, const ForceEstimatorsPlan& plan, double time_s) {
  const double start_m = start_of(params);
  if (time_s < plan.rest_s) return start_m;
  if (time_s < plan.free_until_s) {
    const double phase = 2.0 * std::numbers::pi * params.task.free_frequency_Hz * (time_s - plan.rest_s);
    return start_m + params.task.free_amplitude_m * (1.0 - std::cos(phase));
  }
  const double pressed_m = params.environment.position_m + params.task.press_depth_m;
  const mechanics::MinimumJerk press{start_m, pressed_m, plan.press_s, plan.hold_s - plan.press_s};
  const mechanics::MinimumJerk release{0.0, start_m - pressed_m, plan.release_s, plan.end_s - plan.release_s};
  return press.position_m(time_s) + release.position_m(time_s);
}

EstimatorScore score(std::string name, std::vector<double> estimate_N, const SlaveRun& run,
                     const ForceEstimatorsPlan& plan) {
  const auto part = [&](const std::vector<double>& signal, double from_s, double until_s) {
    const auto tick = [&](double time_s) { return static_cast<std::size_t>(std::lround(time_s / run.tick_s)); };
    return std::span(signal).subspan(tick(from_s), tick(until_s) - tick(from_s));
  };
  const auto rest = part(estimate_N, 0.5 * plan.rest_s, plan.rest_s);
  EstimatorScore result{.name = std::move(name),
                        .rest_noise_N = simulation::rms(rest, simulation::mean(rest)),
                        .free_residual_N = simulation::rms(part(estimate_N, plan.rest_s, plan.free_until_s)),
                        .contact_error_N = 0.0,
                        .lead_s = 0.0,
                        .estimate_N = {}};
  // Equal lengths, and longer than the comparison asks for: it cannot fail.
  const auto comparison = identification::compare_force(part(estimate_N, plan.press_s, plan.end_s),
                                                        part(run.true_N, plan.press_s, plan.end_s),
                                                        comparison_cutoff_Hz, Seconds{run.tick_s}, 0)
                              .value();
  result.contact_error_N = comparison.rmse;
  result.lead_s = comparison.lead_s;
  result.estimate_N = std::move(estimate_N);
  return result;
}

/// Slave, controller and their clock, each valid.
struct Loop {
  simulation::Clock clock;
  mechanics::ElectricSlave slave;
  control::ServoPd controller;
};

Result<Loop> make_loop(const ForceEstimatorsParams& params) {
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const auto slave = mechanics::ElectricSlave::make(params.slave, params.environment, Seconds{clock->substep_s});
  if (!slave) {
    const bool of_wall = slave.error().parameter.starts_with("environment");
    return of_wall ? slave.error() : under("slave", slave.error());
  }
  const auto controller = control::ServoPd::make(params.controller, Seconds{clock->tick_s});
  if (!controller) return under("controller", controller.error());
  return Loop{*clock, *slave, *controller};
}

/// The closed loop for `seconds`, told to be at `path_m(time_s)`.
template <class Path>
Result<SlaveRun> drive(const ForceEstimatorsParams& params, double seconds, Path path_m) {
  if (auto error = validate(params)) return *std::move(error);
  auto loop = make_loop(params);
  if (!loop) return loop.error();
  auto& [clock, slave, controller] = *loop;
  slave.reset(start_of(params));

  SlaveRun run{.tick_s = clock.tick_s, .samples = {}, .sensor_N = {}, .true_N = {}};
  const auto ticks = static_cast<std::size_t>(std::lround(seconds / clock.tick_s));
  double command_N = 0.0;
  double contact_N = 0.0;
  for (std::size_t tick = 0; tick < ticks; ++tick) {
    const auto reading = slave.measure();
    run.samples.push_back({.command = command_N, .position = reading.motor_position_m});
    run.sensor_N.push_back(-reading.tip_force_N);
    run.true_N.push_back(-contact_N);
    const double wanted_m = path_m(static_cast<double>(tick) * clock.tick_s);
    const double next_N = controller.step(wanted_m - reading.motor_position_m);
    contact_N = 0.0;
    for (int i = 0; i < clock.substeps; ++i) {
      if (i == clock.late_substeps) command_N = next_N;
      contact_N += slave.step(command_N).contact_force_N / clock.substeps;
    }
  }
  return run;
}

struct Estimators {
  InverseModelEstimator unpredicted;
  InverseModelEstimator by_blocks;
  InverseModelEstimator by_polynomial;
  InverseModelEstimator by_kalman;
  control::DisturbanceObserver disturbance_observer;
  control::MomentumObserver momentum_observer;
  control::KalmanForceEstimator kalman;
};

Result<Estimators> make_estimators(const ForceEstimatorsParams& params, Seconds dt) {
  InverseModelEstimator::Params variant = params.inverse_model;
  const auto predicted_by = [&variant, dt](signal::PredictionKind kind) {
    variant.prediction.kind = kind;
    return InverseModelEstimator::make(variant, dt);
  };
  const auto by_blocks = predicted_by(signal::PredictionKind::blocks);
  if (!by_blocks) return under("inverse_model", by_blocks.error());
  const auto by_polynomial = predicted_by(signal::PredictionKind::polynomial);
  if (!by_polynomial) return under("inverse_model", by_polynomial.error());
  const auto by_kalman = predicted_by(signal::PredictionKind::kalman);
  if (!by_kalman) return under("inverse_model", by_kalman.error());
  variant.prediction = signal::Predictor::Params::none();
  variant.declared_delay_s = 0.0;
  const auto unpredicted = InverseModelEstimator::make(variant, dt);
  if (!unpredicted) return under("inverse_model", unpredicted.error());
  const auto disturbance = control::DisturbanceObserver::make(params.disturbance_observer, dt);
  if (!disturbance) return under("disturbance_observer", disturbance.error());
  const auto momentum = control::MomentumObserver::make(params.momentum_observer, dt);
  if (!momentum) return under("momentum_observer", momentum.error());
  const auto kalman = control::KalmanForceEstimator::make(params.kalman, dt);
  if (!kalman) return under("kalman", kalman.error());
  return Estimators{*unpredicted, *by_blocks, *by_polynomial, *by_kalman, *disturbance, *momentum, *kalman};
}

template <class Estimator>
std::vector<double> along(const SlaveRun& run, Estimator estimator) {
  const double start = run.samples.front().position;
  std::vector<double> estimate_N;
  estimate_N.reserve(run.samples.size());
  for (const control::SlaveMotionSample& sample : run.samples) {
    estimate_N.push_back(estimator.step({.command = sample.command, .position = sample.position - start}).force);
  }
  return estimate_N;
}

}  // namespace

ForceEstimatorsPlan plan_of(const ForceEstimatorsTask& task) {
  constexpr double rest_s = 0.5;
  // Two periods or more, whole ones, so that the motion ends where it began.
  const double free_s = std::max(2.0, std::ceil(2.0 * task.free_frequency_Hz)) / task.free_frequency_Hz;
  const double press_s = rest_s + free_s + 0.25;
  return {.rest_s = rest_s,
          .free_until_s = rest_s + free_s,
          .press_s = press_s,
          .hold_s = press_s + 0.5,
          .release_s = press_s + 1.0,
          .end_s = press_s + 1.5};
}

Check check(const ForceEstimatorsParams& params) {
  if (auto error = validate(params)) return error;
  const auto loop = make_loop(params);
  if (!loop) return loop.error();
  const auto estimators = make_estimators(params, Seconds{loop->clock.tick_s});
  if (!estimators) return estimators.error();
  const auto narx = control::NarxMemory::make({.cutoff_Hz = params.narx.cutoff_Hz, .lag_s = params.narx.lag_s},
                                              params.narx.actuator_gain, Seconds{loop->clock.tick_s});
  if (!narx) return under("narx", narx.error());
  return std::nullopt;
}

Result<SlaveRun> drive_slave(const ForceEstimatorsParams& params) {
  const ForceEstimatorsPlan plan = plan_of(params.task);
  return drive(params, plan.end_s, [&](double time_s) { return path_m(params, plan, time_s); });
}

Result<SlaveRun> drive_for_narx(const ForceEstimatorsParams& params) {
  const double frequency_Hz = params.task.free_frequency_Hz;
  return drive(params, std::max(10.0, 10.0 / frequency_Hz), [&](double time_s) {
    double wave = 0.0;
    for (const double times : {0.7, 1.7, 4.1}) {
      wave += (1.0 - std::cos(2.0 * std::numbers::pi * times * frequency_Hz * time_s)) / 3.0;
    }
    return start_of(params) + params.task.free_amplitude_m * wave;
  });
}

Result<ForceEstimatorsResult> compare_force_estimators(const ForceEstimatorsParams& params) {
  auto run = drive_slave(params);
  if (!run) return run.error();
  const auto estimators = make_estimators(params, Seconds{run->tick_s});
  if (!estimators) return estimators.error();
  const auto training = drive_for_narx(params);
  if (!training) return training.error();
  std::vector<control::SlaveMotionSample> motion = training->samples;
  const double start = motion.front().position;
  for (control::SlaveMotionSample& sample : motion) sample.position -= start;
  auto narx = identification::fit_narx(motion, params.narx, Seconds{run->tick_s});
  if (!narx) return under("narx", narx.error());
  const auto narx_estimator = control::NarxForceEstimator::make(narx->model, Seconds{run->tick_s});
  if (!narx_estimator) return under("narx", narx_estimator.error());
  const ForceEstimatorsPlan plan = plan_of(params.task);
  ForceEstimatorsResult result{.run = *std::move(run), .narx = *std::move(narx), .scores = {}};
  const auto add = [&](const char* name, std::vector<double> estimate_N) {
    result.scores.push_back(score(name, std::move(estimate_N), result.run, plan));
  };
  add("force sensor", result.run.sensor_N);
  add("inverse model, no prediction", along(result.run, estimators->unpredicted));
  add("inverse model, prediction blocks", along(result.run, estimators->by_blocks));
  add("inverse model, polynomial", along(result.run, estimators->by_polynomial));
  add("inverse model, Kalman predictor", along(result.run, estimators->by_kalman));
  add("disturbance observer", along(result.run, estimators->disturbance_observer));
  add("momentum observer", along(result.run, estimators->momentum_observer));
  add("Kalman filter", along(result.run, estimators->kalman));
  add("NARX model", along(result.run, *narx_estimator));
  return result;
}

}  // namespace tactus::experiments
