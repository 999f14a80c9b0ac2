// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/model/induced_motion_model.hpp>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

// The model with its defaults, hysteretic linkage, quintic hand and friction and all, against SciPy, which integrates
// Bouc and Wen's differential equation along with the rest.
namespace tactus::control {
namespace hysteretic_model_test {

constexpr double tick_s = 200e-6;

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

/// RMS error of a position of the model over the run `name` of the oracle, over the RMS of the position itself.
double share_of_error(const InducedMotionModel::Params& params, const OracleTable& table, const std::string& column,
                      std::size_t state, double intended_m_per_s) {
  const auto forces_N = table.column("motor_force_N");
  const auto truth_m = table.column(column);
  InducedMotionModel model = InducedMotionModel::make(params, Seconds{tick_s}).value();
  std::vector<double> error_m;
  for (std::size_t tick = 0; tick < forces_N.size(); ++tick) {
    error_m.push_back(model.state()[state] - truth_m[tick]);
    model.step({.motor_force_N = forces_N[tick], .intended_velocity_m_per_s = intended_m_per_s});
  }
  return rms(error_m) / rms(truth_m);
}

constexpr std::pair<const char*, double> hands[] = {{"rest", 0.0}, {"slow", 0.002}, {"fast", -0.15}};

TEST(HystereticModel, UnderImpactsUpTo1NTheExactStepErrsLessThanFourTenthsOfEulerAgainstScipy) {
  const OracleTable table("control_hysteretic_motion");
  for (const auto& [hand, intended_m_per_s] : hands) {
    const auto error = [&, name = std::string(hand), speed = intended_m_per_s](CancellationStep step) {
      return share_of_error({.master = {}, .step = step}, table, name + "_motor_m", 0, speed);
    };
    const double exact = error(CancellationStep::exact), euler = error(CancellationStep::euler);
    EXPECT_LT(exact, 1.2e-3) << hand;
    EXPECT_LT(exact, 0.4 * euler) << hand << ", Euler errs by " << euler;
    EXPECT_LT(euler, 6e-3) << hand;
  }
}

TEST(HystereticModel, TheExactStepKnowsWhereTheHandleIsToATenthOfAPercent) {
  const OracleTable table("control_hysteretic_motion");
  for (const auto& [hand, intended_m_per_s] : hands) {
    EXPECT_LT(share_of_error({}, table, std::string(hand) + "_handle_m", 2, intended_m_per_s), 1e-3) << hand;
  }
}

TEST(HystereticModel, WithALinearLinkageItMissesTheHystereticPathByTwentyTimesAsMuch) {
  const OracleTable table("control_hysteretic_motion");
  InducedMotionModel::Params linear;
  linear.master.linkage.hysteretic_fraction = 0.0;
  for (const auto& [hand, intended_m_per_s] : hands) {
    EXPECT_GT(share_of_error(linear, table, std::string(hand) + "_motor_m", 0, intended_m_per_s), 20.0 * 1.2e-3)
        << hand;
  }
}

}  // namespace hysteretic_model_test
}  // namespace tactus::control
