// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/bench_knowledge.hpp>
#include <tactus/identification/axis/nonlinear_fit.hpp>
#include <tactus/identification/axis/zero_phase.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

namespace tactus::identification {

namespace {

/// A parameter counts as told when its interval reaches no further than this part of it.
constexpr double told_within = 0.1;
/// What the model's laws and steps are off themselves, as a standard deviation in proportion: the integrator places a
/// resonance to about this.
constexpr double model_error = 5e-4;
/// How far the area of a loop by one law of hysteresis is from that by another which fits the same data, as a standard
/// deviation in proportion: loops of `BoucWenSpring` and `ElastoSlipSpring` lie within 1 % of the peak force.
constexpr double law_error = 5e-3;

/// How a parameter becomes a variable of about unit scale: its logarithm, the logarithm of its odds, or a multiple.
enum class Scale { logarithm, odds, linear };

struct Description {
  const char* name;
  Unit unit;
  Scale scale;
  double unit_scale;  ///< of a linear one
  double& (*of)(BenchParams&);
};

constexpr std::array<Description, bench_variables> descriptions{{
    {"amplifier.gain", units::none, Scale::logarithm, 0, [](BenchParams& p) -> double& { return p.amplifier_gain; }},
    {"amplifier.offset_N", units::newton, Scale::linear, 0.01,
     [](BenchParams& p) -> double& { return p.amplifier_offset_N; }},
    {"amplifier.bandwidth_Hz", units::hertz, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.amplifier_bandwidth_Hz; }},
    {"amplifier.lag_s", units::second, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.amplifier_lag_s; }},
    {"motor.mass_kg", units::kilogram, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.motor.mass_kg; }},
    {"motor.friction_N", units::newton, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.motor.friction_N; }},
    {"cable.stiffness_N_per_m", units::newton_per_metre, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.cable.stiffness_N_per_m; }},
    {"cable.damping_N_s_per_m", units::newton_second_per_metre, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.cable.damping_N_s_per_m; }},
    {"drum.mass_kg", units::kilogram, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.drum.mass_kg; }},
    {"drum.friction_N", units::newton, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.drum.friction_N; }},
    {"linkage.stiffness_N_per_m", units::newton_per_metre, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.linkage.stiffness_N_per_m; }},
    {"linkage.hysteretic_fraction", units::none, Scale::odds, 0,
     [](BenchParams& p) -> double& { return p.master.linkage.hysteretic_fraction; }},
    {"linkage.slip_deflection_m", units::metre, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.linkage.slip_deflection_m; }},
    {"linkage.damping_N_s_per_m", units::newton_second_per_metre, Scale::linear, 0.1,
     [](BenchParams& p) -> double& { return p.master.linkage.damping_N_s_per_m; }},
    {"handle.mass_kg", units::kilogram, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.handle.mass_kg; }},
    {"operator.stiffness_N_per_m", units::newton_per_metre, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.hand.stiffness_N_per_m; }},
    {"operator.damping_N_s_per_m", units::newton_second_per_metre, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.master.hand.damping_N_s_per_m; }},
    {"operator.correction_gain_per_s", units::per_second, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.correction_gain_per_s; }},
    {"operator.reaction_time_s", units::second, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.reaction_time_s; }},
    {"operator.sight_bandwidth_Hz", units::hertz, Scale::logarithm, 0,
     [](BenchParams& p) -> double& { return p.sight_bandwidth_Hz; }},
}};

const Description& describe(BenchVariable variable) { return descriptions[static_cast<std::size_t>(variable)]; }

double to_variable(const Description& description, double value) {
  switch (description.scale) {
    case Scale::logarithm:
      return std::log(value);
    case Scale::odds:
      return std::log(value / (1.0 - value));
    case Scale::linear:
      break;
  }
  return value / description.unit_scale;
}

double to_value(const Description& description, double variable) {
  switch (description.scale) {
    case Scale::logarithm:
      return std::exp(variable);
    case Scale::odds:
      return std::min(0.98, 1.0 / (1.0 + std::exp(-variable)));
    case Scale::linear:
      break;
  }
  return variable * description.unit_scale;
}

double get(const BenchParams& params, const Description& description) {
  BenchParams copy = params;
  return description.of(copy);
}

constexpr double bias_scale_N = 0.01;

void append_difference(std::vector<double>& to, const std::vector<double>& measured,
                       const std::vector<double>& modelled, double weight) {
  for (std::size_t i = 0; i < modelled.size(); ++i) to.push_back(weight * (measured[i] - modelled[i]));
}

/// Measured less modelled positions, in m, without what is slower than the experiment counts.
std::vector<double> difference_m(const BenchParams& params, const BenchExperiment& experiment) {
  std::vector<double> all;
  append_difference(
      all, experiment.run.position_m,
      simulate_position(params, experiment.assembly, experiment.program, experiment.run, experiment.steps_per_tick),
      1.0);
  if (experiment.high_pass_Hz == 0.0) return all;
  const auto slow = zero_phase_low_pass(all, experiment.high_pass_Hz, Seconds{experiment.run.tick_s});
  // The filter refuses a cutoff beyond the tick and too short runs: neither is an experiment.
  if (!slow) return std::vector<double>(all.size(), std::nan(""));
  for (std::size_t i = 0; i < all.size(); ++i) all[i] -= (*slow)[i];
  return all;
}

double loop_area_J(const mechanics::BoucWenSpring::Params& spring) {
  // One closed loop in steps, after another that brings the spring onto it: the law is exact for every step.
  auto made = mechanics::BoucWenSpring::make(spring, Seconds{1.0});
  if (!made) return std::nan("");
  constexpr int steps = 400;
  double area_J = 0.0, before_m = 0.0, before_N = 0.0;
  for (int i = 1; i <= 3 * steps; ++i) {
    const double way = static_cast<double>(i % steps) / steps;  // 0, 1, −1, 0
    const double now_m =
        spring.reference_deflection_m * (way < 0.25 ? 4.0 * way : (way < 0.75 ? 2.0 - 4.0 * way : 4.0 * way - 4.0));
    const double now_N = made->step({.deflection_m = now_m});
    if (i > 2 * steps) area_J += 0.5 * (now_N + before_N) * (now_m - before_m);
    before_m = now_m;
    before_N = now_N;
  }
  return area_J;
}

/// The viscous damping that at the linkage's resonance loses as much a cycle as the law of hysteresis may be off,
/// π b ω A².
double damping_like_law_error(const control::MasterModel& master) {
  const auto& spring = master.linkage;
  const double natural = std::sqrt(spring.stiffness_N_per_m / (master.motor.mass_kg + master.drum.mass_kg));
  return law_error * loop_area_J(spring) /
         (std::numbers::pi * natural * spring.reference_deflection_m * spring.reference_deflection_m);
}

}  // namespace

BenchKnowledge::BenchKnowledge(const BenchParams& start)
    : params_(start), covariance_(bench_variables * bench_variables, 0.0) {}

const char* BenchKnowledge::name(BenchVariable variable) { return describe(variable).name; }

bool BenchKnowledge::knows(BenchVariable variable) const { return known_[static_cast<std::size_t>(variable)]; }

double BenchKnowledge::covariance(BenchVariable a, BenchVariable b) const {
  return covariance_[static_cast<std::size_t>(a) * bench_variables + static_cast<std::size_t>(b)];
}

void BenchKnowledge::suppose(BenchVariable variable, double share) {
  const auto i = static_cast<std::size_t>(variable);
  prior_[i] = {.middle = to_variable(descriptions[i], get(params_, descriptions[i])), .deviation = share};
}

double BenchKnowledge::surprise(BenchVariable variable) const {
  const auto i = static_cast<std::size_t>(variable);
  if (!(prior_[i].deviation > 0.0)) return 0.0;
  const double now = to_variable(descriptions[i], get(params_, descriptions[i]));
  return std::fabs(now - prior_[i].middle) / prior_[i].deviation;
}

void BenchKnowledge::start_from_supposed(BenchVariable variable) {
  const auto i = static_cast<std::size_t>(variable);
  if (prior_[i].deviation > 0.0) start_from(variable, to_value(descriptions[i], prior_[i].middle));
}

void BenchKnowledge::start_from(BenchVariable variable, double value) { describe(variable).of(params_) = value; }

std::vector<double> BenchKnowledge::left_m(const BenchExperiment& experiment) const {
  return difference_m(params_, experiment);
}

Result<double> BenchKnowledge::fit(std::span<const BenchVariable> wanted, std::span<const BenchExperiment> experiments,
                                   const MeasurementWeights& weights) {
  // The variables of the fit: those wanted, a constant force in each experiment, those known.
  std::vector<std::size_t> fitted;
  for (const BenchVariable variable : wanted) fitted.push_back(static_cast<std::size_t>(variable));
  std::vector<std::size_t> given;
  for (std::size_t i = 0; i < bench_variables; ++i) {
    const bool wanted_now = std::find(fitted.begin(), fitted.end(), i) != fitted.end();
    if (known_[i] && !wanted_now) given.push_back(i);
  }
  const std::size_t biases = weights.position_per_m > 0.0 ? experiments.size() : 0;
  NonlinearProblem problem;
  problem.given = given.size();
  for (const std::size_t i : fitted) {
    problem.start.push_back(to_variable(descriptions[i], get(params_, descriptions[i])));
  }
  for (const std::size_t i : fitted) {
    problem.prior_middle.push_back(prior_[i].middle);
    problem.prior_deviation.push_back(prior_[i].deviation);
  }
  problem.start.insert(problem.start.end(), biases, 0.0);
  for (const std::size_t i : given) {
    problem.start.push_back(to_variable(descriptions[i], get(params_, descriptions[i])));
    for (const std::size_t j : given) problem.given_covariance.push_back(covariance_[i * bench_variables + j]);
  }
  problem.residuals = [&](std::span<const double> variables) {
    BenchParams trial = params_;
    std::size_t next = 0;
    for (const std::size_t i : fitted) descriptions[i].of(trial) = to_value(descriptions[i], variables[next++]);
    const std::size_t first_bias = next;
    next += biases;
    for (const std::size_t i : given) descriptions[i].of(trial) = to_value(descriptions[i], variables[next++]);
    std::vector<double> all;
    for (std::size_t e = 0; e < experiments.size(); ++e) {
      trial.bias_N = biases > 0 ? bias_scale_N * variables[first_bias + e] : 0.0;
      if (weights.position_per_m > 0.0) {
        for (const double left_m : difference_m(trial, experiments[e])) {
          all.push_back(weights.position_per_m / experiments[e].deviation_m * left_m);
        }
      }
      if (weights.current_per_N > 0.0) {
        const RigRun& run = experiments[e].run;
        append_difference(all, run.current_force_N, simulate_current(trial, run), weights.current_per_N);
      }
    }
    return all;
  };
  const auto result = fit_nonlinear(problem);
  if (!result) {
    Error error = result.error();
    for (std::size_t k = 0; k < problem.start.size(); ++k) {
      if (error.parameter != std::to_string(k)) continue;
      error.parameter = k < fitted.size() ? descriptions[fitted[k]].name : "constant force";
      break;
    }
    return error;
  }

  // Rows of the fit's covariance by where they belong; the constant forces belong nowhere.
  const std::size_t size = problem.start.size();
  std::vector<std::pair<std::size_t, std::size_t>> rows;
  for (std::size_t k = 0; k < fitted.size(); ++k) rows.emplace_back(k, fitted[k]);
  for (std::size_t k = 0; k < given.size(); ++k) rows.emplace_back(fitted.size() + biases + k, given[k]);
  for (const auto& [from_row, to_row] : rows) {
    for (const auto& [from_column, to_column] : rows) {
      covariance_[to_row * bench_variables + to_column] = result->covariance[from_row * size + from_column];
    }
  }
  for (std::size_t k = 0; k < fitted.size(); ++k) {
    descriptions[fitted[k]].of(params_) = to_value(descriptions[fitted[k]], result->found[k]);
    known_[fitted[k]] = true;
  }
  return result->residual_rms;
}

FoundParameter BenchKnowledge::found(BenchVariable variable) const {
  const Description& description = describe(variable);
  FoundParameter parameter{.name = description.name, .unit = description.unit.symbol};
  parameter.value = get(params_, description);
  if (!knows(variable)) {
    parameter.interval_95 = {0.0, std::numeric_limits<double>::max()};
    return parameter;
  }
  const double middle = to_variable(description, parameter.value);
  double own = description.scale == Scale::linear ? 0.0 : model_error;
  if (variable == BenchVariable::linkage_damping) own = damping_like_law_error(params_.master) / description.unit_scale;
  const double reach = normal_95 * std::hypot(std::sqrt(covariance(variable, variable)), own);
  parameter.interval_95 = {to_value(description, middle - reach), to_value(description, middle + reach)};
  if (variable == BenchVariable::amplifier_offset) {
    parameter.determined = reach * description.unit_scale < 0.005;
  } else {
    const double half = 0.5 * (parameter.interval_95[1] - parameter.interval_95[0]);
    parameter.determined = half <= told_within * std::fabs(parameter.value);
  }
  return parameter;
}

std::vector<double> BenchKnowledge::correlation(std::span<const FoundParameter> parameters) const {
  const auto covariance_of = [&](const FoundParameter& one, const FoundParameter& other) {
    const auto index_of = [](const FoundParameter& parameter) {
      return static_cast<std::size_t>(
          std::find_if(descriptions.begin(), descriptions.end(),
                       [&parameter](const Description& description) { return description.name == parameter.name; }) -
          descriptions.begin());
    };
    const std::size_t a = index_of(one), b = index_of(other);
    return a < bench_variables && b < bench_variables ? covariance_[a * bench_variables + b] : 0.0;
  };
  std::vector<double> matrix;
  for (const FoundParameter& row : parameters) {
    for (const FoundParameter& column : parameters) {
      const double scale = std::sqrt(covariance_of(row, row) * covariance_of(column, column));
      matrix.push_back(&row == &column ? 1.0 : scale > 0.0 ? covariance_of(row, column) / scale : 0.0);
    }
  }
  return matrix;
}

FoundParameter BenchKnowledge::loop_area() const {
  constexpr std::array shape{BenchVariable::linkage_stiffness, BenchVariable::linkage_hysteretic_fraction,
                             BenchVariable::linkage_slip_deflection};
  FoundParameter parameter{.name = "linkage.loop_area_J", .unit = units::joule.symbol};
  parameter.value = loop_area_J(params_.master.linkage);
  if (!std::all_of(shape.begin(), shape.end(), [this](auto v) { return knows(v); })) {
    parameter.interval_95 = {0.0, std::numeric_limits<double>::max()};
    return parameter;
  }
  std::array<double, shape.size()> slope{};
  constexpr double difference = 1e-4;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    BenchParams moved = params_;
    const Description& description = describe(shape[i]);
    double& value = description.of(moved);
    value = to_value(description, to_variable(description, value) + difference);
    slope[i] = std::log(loop_area_J(moved.master.linkage) / parameter.value) / difference;
  }
  double variance = 0.0;
  for (std::size_t i = 0; i < shape.size(); ++i) {
    for (std::size_t j = 0; j < shape.size(); ++j) variance += slope[i] * slope[j] * covariance(shape[i], shape[j]);
  }
  const double factor = std::exp(normal_95 * std::hypot(std::sqrt(variance), law_error));
  parameter.interval_95 = {parameter.value / factor, parameter.value * factor};
  parameter.determined = factor <= 1.0 + told_within;
  return parameter;
}

std::vector<double> replay(const BenchKnowledge& knowledge, const BenchExperiment& experiment) {
  return simulate_position(knowledge.params(), experiment.assembly, experiment.program, experiment.run,
                           experiment.steps_per_tick);
}

}  // namespace tactus::identification
