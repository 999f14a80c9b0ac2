// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/linear_element.hpp>
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Core>

namespace tactus::stability {

namespace {

constexpr double tolerance = 1e-9;

Error not_linear(const char* what) {
  return {.code = ErrorCode::failed,
          .parameter = {},
          .message = std::string(what) + " does not answer as a linear one would: nothing here can judge it",
          .place = {}};
}

}  // namespace

Result<StateSpace> probe(int order, const std::function<double(double)>& step) {
  constexpr Eigen::Index samples = 4000;
  step(0.0);
  Eigen::VectorXd h(samples);
  for (Eigen::Index k = 0; k < samples; ++k) h[k] = step(k == 0 ? 1.0 : 0.0);
  const double peak = h.cwiseAbs().maxCoeff();
  const bool memoryless = h.tail(samples - 1).isZero(0.0);
  const Eigen::Index n = memoryless ? 0 : order;

  // h[k + n] + a₁ h[k + n − 1] + … + aₙ h[k] = 0 from k = 1 on, since the numerator has n + 1 coefficients.
  const Eigen::Index rows = samples - n - 1;
  Eigen::MatrixXd past(rows, n);
  for (Eigen::Index i = 0; i < n; ++i) past.col(i) = h.segment(n - i, rows);
  Eigen::VectorXd a(n);
  if (n > 0) a = signal::solve_shortest(past, -h.segment(n + 1, rows));

  StateSpace system{.a = Eigen::MatrixXd::Zero(n, n),
                    .b = Eigen::MatrixXd::Zero(n, 1),
                    .c = Eigen::MatrixXd::Zero(1, n),
                    .d = Eigen::MatrixXd::Constant(1, 1, h[0])};
  for (Eigen::Index i = 0; i < n; ++i) {
    // Observer form: the states are what the output still owes to past inputs.
    system.a(i, 0) = -a[i];
    if (i + 1 < n) system.a(i, i + 1) = 1.0;
    double numerator = h[i + 1];
    for (Eigen::Index j = 0; j <= i; ++j) numerator += a[j] * h[i - j];
    system.b(i, 0) = numerator - a[i] * h[0];
  }
  if (n > 0) system.c(0, 0) = 1.0;

  Eigen::VectorXd state = system.b.col(0);
  for (Eigen::Index k = 1; k < samples; ++k) {
    const double predicted = n > 0 ? state[0] : 0.0;
    // Written so that a NaN counts as a failure.
    if (!(std::fabs(predicted - h[k]) <= tolerance * peak)) return not_linear("an element of a site");
    state = (system.a * state).eval();
  }
  return system;
}

namespace {

/// Slope from tip to tip of the closed loop of amplitude `amplitude_m` that the spring goes through.
double chord_N_per_m(const mechanics::BoucWenSpring::Params& params, double amplitude_m) {
  auto spring = mechanics::BoucWenSpring::make(params, Seconds{1e-5});
  if (!spring) return params.stiffness_N_per_m;
  double up_N = 0.0, down_N = 0.0;
  // A loop closes within a few cycles; its sides are exact in one step each.
  for (int cycle = 0; cycle < 20; ++cycle) {
    up_N = spring->step({.deflection_m = amplitude_m});
    down_N = spring->step({.deflection_m = -amplitude_m});
  }
  return (up_N - down_N) / (2.0 * amplitude_m);
}

/// The continuous system that `held`, sampled every `tick_s`, is of: the logarithm of its matrices, by the series of
/// 2 artanh((M − 1)/(M + 1)), which a tick far below a radian of every mode makes short.
StateSpace continuous(const StateSpace& held, double tick_s) {
  const Eigen::Index n = held.states(), whole = n + 1;
  Eigen::MatrixXd tick = Eigen::MatrixXd::Identity(whole, whole);
  tick.topLeftCorner(n, n) = held.a;
  tick.topRightCorner(n, 1) = held.b;
  const Eigen::MatrixXd one = Eigen::MatrixXd::Identity(whole, whole);
  const Eigen::MatrixXd ratio = signal::solve(tick + one, tick - one);
  const Eigen::MatrixXd square = ratio * ratio;
  Eigen::MatrixXd power = ratio, rate = Eigen::MatrixXd::Zero(whole, whole);
  for (int i = 1; i < 40; i += 2) {
    rate += (2.0 / (i * tick_s)) * power;
    power = (power * square).eval();
  }
  return {.a = rate.topLeftCorner(n, n), .b = rate.topRightCorner(n, 1), .c = held.c, .d = held.d};
}

/// The model with a damper from motor and from drum to the ground.
Result<StateSpace> probe_rubbing_model(const control::InducedMotionModel::Params& params,
                                       const Linearisation& linearisation, Seconds dt) {
  constexpr Eigen::Index velocities = 3;
  constexpr double parts = 16.0;
  control::InducedMotionModel::Params exact = params;
  exact.step = control::CancellationStep::exact;
  const auto fine = probe_model(exact, Seconds{dt.value / parts});
  if (!fine) return fine.error();
  StateSpace model = continuous(*fine, dt.value / parts);
  const auto rub = [&](Eigen::Index body, const mechanics::RubbingMass& mass) {
    model.a(velocities + body, velocities + body) -= linearisation.rubbing_N_s_per_m(mass.friction_N) / mass.mass_kg;
  };
  rub(0, params.master.motor);
  rub(1, params.master.drum);
  return sampled(model, dt.value, 0.0);
}

}  // namespace

Result<StateSpace> probe_model(control::InducedMotionModel::Params params, Seconds dt,
                               const Linearisation& linearisation) {
  const control::InducedMotionModel::Params file = params;
  params.master.motor.friction_N = 0.0;
  params.master.drum.friction_N = 0.0;
  params.master.linkage.hysteretic_fraction = 0.0;
  if (linearisation.linkage_amplitude_m > 0.0 && params.fidelity == control::ModelFidelity::sixth_order) {
    params.master.linkage.stiffness_N_per_m = chord_N_per_m(file.master.linkage, linearisation.linkage_amplitude_m);
  }
  params.master.hand.quintic_stiffness_N_per_m5 = 0.0;
  if (linearisation.friction_speed_m_per_s > 0.0 && params.fidelity == control::ModelFidelity::sixth_order) {
    control::InducedMotionModel::Params rubbing = file;
    rubbing.master.linkage = params.master.linkage;
    return probe_rubbing_model(rubbing, linearisation, dt);
  }
  auto model = control::InducedMotionModel::make(params, dt);
  if (!model) return model.error();

  constexpr Eigen::Index samples = 2000, states = 6;
  Eigen::MatrixXd before(states + 1, samples), after(states, samples);
  signal::Random random(1);
  for (Eigen::Index k = 0; k < samples; ++k) {
    const double force_N = random.uniform() < 0.5 ? -1.0 : 1.0;
    const auto column = [&model] { return Eigen::Map<const Eigen::Matrix<double, states, 1>>(model->state().data()); };
    before.col(k) << column(), force_N;
    model->step({.motor_force_N = force_N});
    after.col(k) = column();
  }
  // Positions and velocities differ by orders of magnitude: each row in units of its own largest value. Bodies that a
  // model of lower order takes as one have equal rows; the decomposition takes the solution of least norm.
  const Eigen::VectorXd scale = before.rowwise().lpNorm<Eigen::Infinity>();
  const Eigen::MatrixXd scaled_before = scale.cwiseInverse().asDiagonal() * before;
  const Eigen::MatrixXd scaled_after = scale.head(states).cwiseInverse().asDiagonal() * after;
  const Eigen::MatrixXd fit = signal::solve_shortest(scaled_before.transpose(), scaled_after.transpose()).transpose();
  const double mismatch = (fit * scaled_before - scaled_after).cwiseAbs().maxCoeff();
  if (!(mismatch <= tolerance)) return not_linear("the model of cancellation");

  const Eigen::MatrixXd step = scale.head(states).asDiagonal() * fit * scale.cwiseInverse().asDiagonal();
  StateSpace system{.a = step.leftCols(states),
                    .b = step.rightCols(1),
                    .c = Eigen::MatrixXd::Zero(1, states),
                    .d = Eigen::MatrixXd::Zero(1, 1)};
  system.c(0, 0) = 1.0;
  return system;
}

}  // namespace tactus::stability
