// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/linear_fit.hpp>
#include <tactus/identification/axis/narx_fit.hpp>
#include <tactus/identification/axis/orthogonal_least_squares.hpp>
#include <tactus/kernel/signal/checks.hpp>
#include <tactus/kernel/signal/root_mean_square.hpp>

#include <algorithm>
#include <cmath>
#include <string>

namespace tactus::identification {

namespace {

using control::NarxForceEstimator;
using control::NarxMemory;
using control::NarxScales;
using control::NarxTerm;
using control::NarxVariables;
using control::SlaveMotionSample;

/// Low-passes and lags have forgotten where they began.
constexpr double settled_periods = 2.0;
constexpr std::size_t rows_for_each_candidate = 5;

Error too_poor(std::string parameter, std::string message) {
  return {ErrorCode::inconsistent, std::move(parameter), std::move(message), {}};
}

/// All products of up to `degree` variables, the constant first.
std::vector<NarxTerm> candidates_of(const NarxStructure& structure) {
  std::vector<std::int64_t> variables{0};
  for (std::int64_t i = 0; i < structure.differences; ++i) {
    variables.push_back(static_cast<std::int64_t>(NarxVariables::first_difference) + i);
  }
  for (std::int64_t i = 0; i < structure.output_lags; ++i) {
    variables.push_back(static_cast<std::int64_t>(NarxVariables::first_output) + i);
  }
  std::vector<NarxTerm> terms;
  for (std::size_t i = 0; i < variables.size(); ++i) {
    for (std::size_t j = 0; j <= (structure.degree >= 2 ? i : 0); ++j) {
      for (std::size_t k = 0; k <= (structure.degree >= 3 ? j : 0); ++k) {
        terms.push_back(
            {.coefficient_N = 1.0, .variable_1 = variables[i], .variable_2 = variables[j], .variable_3 = variables[k]});
      }
    }
  }
  return terms;
}

struct Seen {
  std::vector<NarxMemory::Variables> variables;
  std::vector<double> force_N;
};

/// Variables and force at every `every`-th tick after `from`, the measured force in the place of the model's.
Seen look(std::span<const SlaveMotionSample> motion, NarxMemory memory, std::size_t from, std::size_t every) {
  Seen seen;
  for (std::size_t tick = 0; tick < motion.size(); ++tick) {
    const NarxMemory::Variables variables = memory.see(motion[tick]);
    memory.remember(memory.command_N());
    if (tick < from || (tick - from) % every != 0) continue;
    seen.variables.push_back(variables);
    seen.force_N.push_back(memory.command_N());
  }
  return seen;
}

double value(const NarxTerm& term, const NarxMemory::Variables& variables) {
  return variables[static_cast<std::size_t>(term.variable_1)] * variables[static_cast<std::size_t>(term.variable_2)] *
         variables[static_cast<std::size_t>(term.variable_3)];
}

/// Scales that bring the variables of this motion near 1, from a first look in metres and newtons.
NarxScales scaled(NarxScales scales, const Seen& seen) {
  std::vector<double> differences;
  double largest_N = 0.0;
  for (std::size_t row = 0; row < seen.force_N.size(); ++row) {
    differences.push_back(seen.variables[row][NarxVariables::first_difference]);
    largest_N = std::max(largest_N, std::abs(seen.force_N[row]));
  }
  scales.difference_scale_m = signal::root_mean_square(differences);
  scales.force_limit_N = 4.0 * largest_N;
  return scales;
}

}  // namespace

Result<NarxFit> fit_narx(std::span<const SlaveMotionSample> motion, const NarxStructure& structure, Seconds dt) {
  if (Check error = signal::check(structure, dt)) return *std::move(error);
  NarxScales scales{
      .cutoff_Hz = structure.cutoff_Hz, .lag_s = structure.lag_s, .difference_scale_m = 1.0, .force_limit_N = 1.0};
  auto memory = NarxMemory::make(scales, structure.actuator_gain, dt);
  if (!memory) return memory.error();
  const std::vector<NarxTerm> candidates = candidates_of(structure);
  const std::size_t every = memory->lag_ticks();
  const std::size_t from = every * (NarxVariables::most_differences + 1) +
                           static_cast<std::size_t>(std::ceil(settled_periods / (structure.cutoff_Hz * dt.value)));
  const std::size_t rows = motion.size() > from ? (motion.size() - from - 1) / every + 1 : 0;
  if (rows < rows_for_each_candidate * candidates.size()) {
    return too_poor("", std::to_string(rows) + " rows, one every lag, are too few to choose among " +
                            std::to_string(candidates.size()) + " terms: record " +
                            rounded_number(std::ceil(static_cast<double>(rows_for_each_candidate * candidates.size()) *
                                                     static_cast<double>(every) * dt.value)) +
                            " s or more, or lower the degree or the number of lags");
  }
  const auto finite = [](const SlaveMotionSample& s) { return std::isfinite(s.command) && std::isfinite(s.position); };
  if (!std::all_of(motion.begin(), motion.end(), finite)) {
    return Error{ErrorCode::out_of_bounds, {}, "the motion holds a value that is not a finite number", {}};
  }
  scales = scaled(scales, look(motion, *memory, from, every));
  if (!(scales.force_limit_N > 0.0) || !(scales.difference_scale_m > 0.0)) {
    return too_poor("", "the motion has no force or does not move: there is no dynamics to learn from it");
  }
  memory = NarxMemory::make(scales, structure.actuator_gain, dt);
  if (!memory) return memory.error();
  const Seen seen = look(motion, *memory, from, every);

  std::vector<double> regressors;
  regressors.reserve(rows * candidates.size());
  for (const NarxMemory::Variables& variables : seen.variables) {
    for (const NarxTerm& term : candidates) regressors.push_back(value(term, variables));
  }
  const auto ranked =
      rank_regressors(regressors, candidates.size(), seen.force_N, static_cast<std::size_t>(structure.most_terms));
  if (!ranked) return ranked.error();
  if (ranked->empty()) return too_poor("", "no term explains the force: the motion does not move what resists it");

  std::vector<double> chosen;
  for (const NarxMemory::Variables& variables : seen.variables) {
    for (const RankedRegressor& one : *ranked) chosen.push_back(value(candidates[one.column], variables));
  }
  const auto fit = fit_linear(chosen, ranked->size(), seen.force_N);
  if (!fit) return fit.error();
  NarxFit result{.model = {.actuator_gain = structure.actuator_gain, .scales = scales, .terms = {}},
                 .terms = {},
                 .candidates = candidates.size(),
                 .rows = rows,
                 .command_rms_N = signal::root_mean_square(seen.force_N),
                 .residual_rms_N = fit->residual_rms,
                 .simulated_rms_N = 0.0};
  std::vector<NarxTerm> terms;
  for (std::size_t i = 0; i < ranked->size(); ++i) {
    NarxTerm term = candidates[(*ranked)[i].column];
    term.coefficient_N = fit->parameters[i];
    terms.push_back(term);
    result.terms.push_back({term, (*ranked)[i].error_reduction, fit->standard_errors[i]});
  }
  result.model.terms = control::NarxTerms::of(terms);

  auto estimator = NarxForceEstimator::make(result.model, dt);
  if (!estimator) return estimator.error();
  std::vector<double> left_N;
  for (const SlaveMotionSample& sample : motion) left_N.push_back(estimator->step(sample).force);
  result.simulated_rms_N = signal::root_mean_square(std::span(left_N).subspan(from));
  if (!(result.simulated_rms_N < result.command_rms_N)) {
    return too_poor("output_lags", "run freely over its own data the model leaves " +
                                       rounded_number(result.simulated_rms_N) + " N of " +
                                       rounded_number(result.command_rms_N) +
                                       " N: its recursion diverges or only repeats the outputs before; write 0, or "
                                       "record a motion that excites the slave more");
  }
  return result;
}

}  // namespace tactus::identification
