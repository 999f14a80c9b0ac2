// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/prediction_time.hpp>
#include <tactus/identification/axis/refusal.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace tactus::identification {

namespace {

using control::InverseModelEstimator;

Check check_blocks(std::int64_t blocks) {
  if (blocks >= 1 && blocks <= static_cast<std::int64_t>(signal::PredictionCascade::most_blocks)) return {};
  return Error{.code = ErrorCode::out_of_bounds,
               .parameter = "prediction.blocks",
               .message = "is " + std::to_string(blocks) + ": a time constant needs 1 to 4 blocks",
               .place = {}};
}

}  // namespace

Result<double> prediction_time_closed_form(double delays_and_lags_s, double derivative_filter_s, std::int64_t blocks) {
  if (Check error = check_blocks(blocks)) return *std::move(error);
  return (delays_and_lags_s + derivative_filter_s) / static_cast<double>(blocks);
}

Result<double> prediction_time_limit(const TransferFunction& plant, const InverseModelEstimator::Params& model,
                                     std::int64_t blocks) {
  if (Check error = check_blocks(blocks)) return *std::move(error);
  const auto root = [&](double s) {
    const double passed = plant(s) * control::inverse_response(model, s).real() / model.actuator_gain;
    return std::pow(passed, -1.0 / static_cast<double>(blocks));
  };
  constexpr double near_one = 1e-2;
  double s = 1.0;
  for (int halved = 0; std::abs(root(s) - 1.0) > near_one && halved < 40; ++halved) s *= 0.5;
  if (!(std::abs(root(s) - 1.0) <= near_one)) {
    return inconsistent("prediction.blocks",
                        "plant and inverse model do not cancel as s tends to 0: gain or viscous damping differ, and no "
                        "prediction repairs that");
  }
  // Neville's scheme at 0 on equally halved abscissas.
  std::array<double, 5> tableau{};
  for (std::size_t i = 0; i < tableau.size(); ++i, s *= 0.5) {
    const double rho = root(s);
    tableau[i] = (rho - 1.0) / (s * (2.0 - rho));
  }
  for (std::size_t level = 1; level < tableau.size(); ++level) {
    const double factor = std::exp2(static_cast<double>(level));
    for (std::size_t i = tableau.size() - 1; i >= level; --i) {
      tableau[i] += (tableau[i] - tableau[i - 1]) / (factor - 1.0);
    }
  }
  if (!(tableau.back() > 0.0)) {
    return inconsistent("prediction.blocks", "the model lags more than the plant: there is nothing to predict");
  }
  return tableau.back();
}

Result<double> free_motion_error(const FreeMotion& motion, const InverseModelEstimator::Params& model) {
  if (motion.command.empty() || motion.command.size() != motion.position.size()) {
    return inconsistent("", "free motion needs as many commands as positions, and at least one");
  }
  auto estimator = InverseModelEstimator::make(model, Seconds{motion.sample_time_s});
  if (!estimator) return estimator.error();
  double sum = 0.0;
  for (std::size_t i = 0; i < motion.command.size(); ++i) {
    const double force = estimator->step({.command = motion.command[i], .position = motion.position[i]}).force;
    sum += force * force;
  }
  return std::sqrt(sum / static_cast<double>(motion.command.size()));
}

Result<PredictionFromData> prediction_time_from_data(const FreeMotion& motion, InverseModelEstimator::Params model,
                                                     std::int64_t blocks) {
  if (Check error = check_blocks(blocks)) return *std::move(error);
  model.prediction.kind = signal::PredictionKind::blocks;
  model.prediction.blocks = blocks;
  model.declared_delay_s = 0.0;  // it is what is looked for
  model.prediction.block.time_constant_s = std::max(motion.sample_time_s, 1e-6);
  if (const auto tried = free_motion_error(motion, model); !tried) return tried.error();
  const auto error_at = [&](double logarithm) {
    model.prediction.block.time_constant_s = std::exp(logarithm);
    const auto error = free_motion_error(motion, model);
    return error ? *error : std::numeric_limits<double>::infinity();
  };
  constexpr int points = 24;
  const double lowest = std::log(std::max(motion.sample_time_s, 1e-6)), highest = std::log(0.1);
  const double spacing = (highest - lowest) / points;
  int best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= points; ++i) {
    const double error = error_at(lowest + i * spacing);
    if (error < least) least = error, best = i;
  }
  if (best == 0 || best == points) {
    return inconsistent("prediction.block.time_constant_s",
                        "the free-motion error is least at an end of the search, from one sample time to 0.1 s: the "
                        "data does not determine it, or the model is wrong");
  }
  double low = lowest + (best - 1) * spacing, high = lowest + (best + 1) * spacing;
  const double golden = 0.5 * (std::sqrt(5.0) - 1.0);
  double left = high - golden * (high - low), right = low + golden * (high - low);
  double left_error = error_at(left), right_error = error_at(right);
  while (high - low > 1e-5) {
    if (left_error < right_error) {
      high = right, right = left, right_error = left_error;
      left = high - golden * (high - low), left_error = error_at(left);
    } else {
      low = left, left = right, left_error = right_error;
      right = low + golden * (high - low), right_error = error_at(right);
    }
  }
  const double found = 0.5 * (low + high);
  return PredictionFromData{.time_constant_s = std::exp(found), .error_rms_N = error_at(found)};
}

}  // namespace tactus::identification
