// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/inverse_dynamics.hpp>
#include <tactus/identification/axis/linear_fit.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/identification/axis/zero_phase.hpp>
#include <tactus/kernel/signal/decompositions.hpp>
#include <tactus/kernel/signal/root_mean_square.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <string>
#include <utility>

#include <Eigen/Core>

namespace tactus::identification {
namespace {

constexpr int parameters = 4;
constexpr int scatter_blocks = 12;
constexpr double student_95 = 2.201;           // two-sided, 11 degrees of freedom
constexpr double friction_speed_share = 0.02;  // of the rms speed
constexpr double standstill_share = 0.06;      // of the rms speed
constexpr double filter_reach = 0.6;           // periods of the cutoff within which the filter weighs samples
constexpr double default_cutoff_Hz = 30.0;
constexpr double least_explained = 0.5;

using Regressors = Eigen::Matrix<double, Eigen::Dynamic, parameters, Eigen::RowMajor>;
using Vector = Eigen::VectorXd;

std::string text(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.3g", value);
  return buffer.data();
}

/// The fast velocity passes a filter with four times the cutoff: it tells when friction changes sign, and then friction
/// passes the filter of the force.
struct Kinematics {
  std::vector<double> velocity, acceleration, fast_velocity;
};

Result<Kinematics> differentiate(const std::vector<double>& position, double cutoff_Hz, Seconds dt) {
  const auto smooth = zero_phase_low_pass(position, cutoff_Hz, dt);
  if (!smooth) return smooth.error();
  const auto fast = zero_phase_low_pass(position, std::min(4.0 * cutoff_Hz, 0.4 / dt.value), dt);
  if (!fast) return fast.error();
  Kinematics motion{
      .velocity = central_difference(*smooth, dt), .acceleration = {}, .fast_velocity = central_difference(*fast, dt)};
  motion.acceleration = central_difference(motion.velocity, dt);
  return motion;
}

/// 1 for the samples whose filtered force and friction stem from motion: none nearer to a standstill than the filter
/// reaches. All ones where that would leave less than a third.
Vector moving_samples(const std::vector<double>& fast_velocity, double slow, std::size_t reach, std::size_t cut) {
  const std::size_t rows = fast_velocity.size() - 2 * cut;
  Vector moving = Vector::Ones(static_cast<Eigen::Index>(rows));
  std::size_t since = reach + 1;
  for (std::size_t i = 0; i < fast_velocity.size(); ++i) {
    since = std::abs(fast_velocity[i]) < slow ? 0 : since + 1;
    if (since > 2 * reach || i < reach + cut || i - reach - cut >= rows) continue;
    moving[static_cast<Eigen::Index>(i - reach - cut)] = 0.0;
  }
  if (moving.mean() < 1.0 / 3.0) moving.setOnes();
  return moving;
}

/// What the fit works on; the ends, where the filter has to guess, are cut off.
struct Problem {
  Regressors regressors, instruments;
  Vector force;
  Vector moving;  ///< 1, or 0 near standstill, where friction is whatever holds the axis
  std::vector<double> velocity;
  double friction_speed = 0;
  std::size_t cut = 0;
};

Result<Regressors> regressors_of(const Kinematics& motion, double friction_speed, double cutoff_Hz, Seconds dt,
                                 std::size_t cut) {
  std::vector<double> direction(motion.velocity.size());
  std::transform(motion.fast_velocity.begin(), motion.fast_velocity.end(), direction.begin(),
                 [=](double v) { return std::tanh(v / friction_speed); });
  const auto smooth = zero_phase_low_pass(direction, cutoff_Hz, dt);
  if (!smooth) return smooth.error();
  const std::size_t rows = direction.size() - 2 * cut;
  Regressors matrix(static_cast<Eigen::Index>(rows), parameters);
  for (std::size_t i = 0; i < rows; ++i) {
    matrix.row(static_cast<Eigen::Index>(i)) << motion.acceleration[i + cut], motion.velocity[i + cut],
        (*smooth)[i + cut], 1.0;
  }
  return matrix;
}

Result<Problem> prepare(const AxisSignals& signals, double cutoff_Hz) {
  const Seconds dt = signals.sample_time;
  const auto motion = differentiate(signals.position, cutoff_Hz, dt);
  if (!motion) return motion.error();
  const auto even = differentiate(every_second(signals.position, 0), cutoff_Hz, dt);
  const auto odd = differentiate(every_second(signals.position, 1), cutoff_Hz, dt);
  const auto force = zero_phase_low_pass(signals.force, cutoff_Hz, dt);
  if (!even || !odd || !force) return inconsistent("the recording could not be filtered: choose another --cutoff-Hz");
  Problem problem;
  problem.friction_speed = friction_speed_share * signal::root_mean_square(motion->velocity);
  problem.cut = std::min(static_cast<std::size_t>(1.0 / (cutoff_Hz * dt.value)), signals.position.size() / 8);
  const auto regressors = regressors_of(*even, problem.friction_speed, cutoff_Hz, dt, problem.cut);
  const auto instruments = regressors_of(*odd, problem.friction_speed, cutoff_Hz, dt, problem.cut);
  if (!regressors || !instruments)
    return inconsistent("the recording could not be filtered: choose another --cutoff-Hz");
  problem.regressors = *regressors;
  problem.instruments = *instruments;
  const double slow = standstill_share * signal::root_mean_square(motion->velocity);
  const auto reach = static_cast<std::size_t>(filter_reach / (cutoff_Hz * dt.value));
  problem.moving = moving_samples(motion->fast_velocity, slow, reach, problem.cut);
  problem.instruments.array().colwise() *= problem.moving.array();
  const auto rows = problem.regressors.rows();
  problem.force = Eigen::Map<const Vector>(force->data() + problem.cut, rows);
  const auto first = motion->velocity.begin() + static_cast<std::ptrdiff_t>(problem.cut);
  problem.velocity.assign(first, first + rows);
  return problem;
}

double variance(const Vector& values) { return (values.array() - values.mean()).square().mean(); }

/// Share of the force's variance that remains explained when the model may use the position too.
Result<double> explained_with(const Problem& problem, std::span<const double> position) {
  const auto rows = static_cast<std::size_t>(problem.force.size());
  std::vector<double> wide;
  wide.reserve(rows * (parameters + 1));
  for (std::size_t i = 0; i < rows; ++i) {
    for (int k = 0; k < parameters; ++k) wide.push_back(problem.regressors(static_cast<Eigen::Index>(i), k));
    wide.push_back(position[i + problem.cut]);
  }
  const auto fit = fit_linear(wide, parameters + 1, std::span(problem.force.data(), rows));
  if (!fit) return fit.error();
  return 1.0 - fit->residual_rms * fit->residual_rms / variance(problem.force);
}

Result<LinearFit> least_squares(const Problem& problem) {
  const Regressors regressors = problem.regressors.array().colwise() * problem.moving.array();
  const Vector force = problem.force.array() * problem.moving.array();
  return fit_linear(std::span(regressors.data(), static_cast<std::size_t>(regressors.size())), parameters,
                    std::span(force.data(), static_cast<std::size_t>(force.size())));
}

/// How much of the force the model explains when the two columns change places; 0 when that makes no sense.
double explained_swapped(const AxisSignals& signals, double cutoff_Hz) {
  const auto problem =
      prepare({.position = signals.force, .force = signals.position, .sample_time = signals.sample_time}, cutoff_Hz);
  if (!problem) return 0.0;
  const auto fit = least_squares(*problem);
  if (!fit || fit->parameters[0] <= 0.0) return 0.0;
  return 1.0 - fit->residual_rms * fit->residual_rms / variance(problem->force);
}

Check check_plausible(const InverseDynamics& model, const Problem& problem, const AxisSignals& signals) {
  const std::string explained = text(100.0 * model.explained) + " %";
  if (model.explained < least_explained && explained_swapped(signals, model.cutoff_Hz) > least_explained) {
    return inconsistent("position and force look swapped: as named, the model explains " + explained +
                        " of the force, and the other way round more than half; exchange --position and --force");
  }
  const auto with_position = explained_with(problem, signals.position);
  if (with_position && *with_position - model.explained > 0.15) {
    return inconsistent("the force follows the position (the model explains " + explained + " of it, with a spring " +
                        text(100.0 * *with_position) +
                        " %): the axis was in contact, on a spring or under gravity; record free motion");
  }
  if (model.inertia.upper < 0.0) {
    return inconsistent("the inertia comes out negative (" + text(model.inertia.value) +
                        "): the force has the opposite sign of the motion it makes (turn it with --force-sign -1), or "
                        "position and force are swapped or not of one axis");
  }
  if (model.explained < least_explained) {
    return inconsistent(
        "the model explains only " + explained +
        " of the force: the columns may not belong together, the sample time may be wrong or the axis was in "
        "contact; check the columns, and record free motion");
  }
  double power = 0.0;
  for (const double v : problem.velocity) {
    power += v * (model.viscous.value * v + model.coulomb.value * std::tanh(v / model.friction_speed));
  }
  if (power < 0.0) {
    return inconsistent("friction comes out as giving energy (viscous " + text(model.viscous.value) + ", Coulomb " +
                        text(model.coulomb.value) +
                        "): the force lags or leads the position, has the wrong sign, or another force moves the axis");
  }
  if (model.inertia.lower <= 0.0) {
    return inconsistent("the data do not determine the inertia (95 % interval " + text(model.inertia.lower) + " to " +
                        text(model.inertia.upper) + "): record faster motion or a longer time");
  }
  return std::nullopt;
}

Check check_motion(const Problem& problem) {
  int turns = 0;
  double direction = 0.0;
  const double slow = 0.2 * signal::root_mean_square(problem.velocity);
  for (const double v : problem.velocity) {
    if (std::abs(v) < slow) continue;
    if (direction * v < 0.0) ++turns;
    direction = v;
  }
  if (turns >= 2) return std::nullopt;
  return inconsistent(
      "the axis turns round " + std::to_string(turns) +
      " times in the recording: friction, offset and inertia cannot be distinguished; record motion to and fro");
}

/// Instrumental variables with intervals from the scatter of the score over blocks.
std::array<Estimate, parameters> estimate(const Problem& problem) {
  const Eigen::Index rows = problem.force.size();
  const Eigen::Matrix4d normal = problem.instruments.transpose() * problem.regressors;
  const Eigen::Vector4d found = signal::solve_least_squares(normal, problem.instruments.transpose() * problem.force);
  const Vector residual = problem.force - problem.regressors * found;
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (Eigen::Index block = 0; block < scatter_blocks; ++block) {
    const Eigen::Index first = rows * block / scatter_blocks;
    const Eigen::Index size = rows * (block + 1) / scatter_blocks - first;
    const Eigen::Vector4d score =
        problem.instruments.middleRows(first, size).transpose() * residual.segment(first, size);
    scatter += score * score.transpose();
  }
  const Eigen::Matrix4d inverse = signal::inverse(Eigen::MatrixXd(normal));
  const Eigen::Matrix4d covariance =
      inverse * scatter * inverse.transpose() * (static_cast<double>(scatter_blocks) / (scatter_blocks - 1));
  std::array<Estimate, parameters> result;
  for (int k = 0; k < parameters; ++k) {
    const double half = student_95 * std::sqrt(std::max(0.0, covariance(k, k)));
    result[static_cast<std::size_t>(k)] = {.value = found[k], .lower = found[k] - half, .upper = found[k] + half};
  }
  return result;
}

}  // namespace

Result<InverseDynamics> fit_inverse_dynamics(const AxisSignals& signals, std::optional<double> cutoff_Hz) {
  if (auto error = check_axis(signals)) return *std::move(error);
  const double cutoff = cutoff_Hz.value_or(std::min(default_cutoff_Hz, 0.1 / signals.sample_time.value));
  const auto problem = prepare(signals, cutoff);
  if (!problem) return problem.error();
  if (auto error = check_motion(*problem)) return *std::move(error);
  const auto first_fit = least_squares(*problem);
  if (!first_fit) return first_fit.error();

  InverseDynamics model;
  const auto found = estimate(*problem);
  model.inertia = found[0];
  model.viscous = found[1];
  model.coulomb = found[2];
  model.offset = found[3];
  std::copy_n(first_fit->parameters.begin(), parameters, model.least_squares.begin());
  model.friction_speed = problem->friction_speed;
  model.cutoff_Hz = cutoff;
  const Eigen::Vector4d values{found[0].value, found[1].value, found[2].value, found[3].value};
  const Vector modelled = problem->regressors * values;
  const Vector residual = problem->force - modelled;
  model.residual_rms = std::sqrt(residual.squaredNorm() / static_cast<double>(residual.size()));
  model.explained = 1.0 - residual.squaredNorm() / static_cast<double>(residual.size()) / variance(problem->force);
  if (auto error = check_plausible(model, *problem, signals)) return *std::move(error);
  model.velocity = problem->velocity;
  model.measured.assign(problem->force.begin(), problem->force.end());
  model.modelled.assign(modelled.begin(), modelled.end());
  for (std::size_t i = 0; i < model.velocity.size(); ++i) {
    model.time_s.push_back(static_cast<double>(i + problem->cut) * signals.sample_time.value);
  }
  return model;
}

}  // namespace tactus::identification
