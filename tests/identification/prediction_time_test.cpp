// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/prediction_time.hpp>

#include <cmath>

#include <gtest/gtest.h>

namespace tactus::identification {
namespace prediction_time_test {

TEST(PredictionTime, TheNumericLimitIsTheClosedFormForEveryNumberOfBlocks) {
  control::InverseModelEstimator::Params model;
  for (const double lag_s : {0.001, 0.01, 0.1}) {
    const auto plant = [lag_s](double s) { return std::exp(-0.004 * s) / ((10.0 * s + 1.0) * s * (lag_s * s + 1.0)); };
    for (std::int64_t blocks = 1; blocks <= 4; ++blocks) {
      const double closed_s = prediction_time_closed_form(0.004 + lag_s, model.derivative_filter_s, blocks).value();
      EXPECT_NEAR(prediction_time_limit(plant, model, blocks).value(), closed_s, 1e-6 * closed_s);
    }
  }
}

TEST(PredictionTime, AWrongGainIsNoDelay) {
  const auto plant = [](double s) { return 1.1 / ((10.0 * s + 1.0) * s); };
  EXPECT_FALSE(prediction_time_limit(plant, {}, 2));
}

TEST(PredictionTime, APlantThatLagsLessThanTheModelHasNothingToPredict) {
  const auto plant = [](double s) { return 1.0 / ((10.0 * s + 1.0) * s); };
  control::InverseModelEstimator::Params model;
  EXPECT_NEAR(prediction_time_limit(plant, model, 1).value(), model.derivative_filter_s, 1e-9);
  model.derivative_filter_s = 0.0;
  EXPECT_FALSE(prediction_time_limit([](double s) { return std::exp(0.01 * s) / ((10.0 * s + 1.0) * s); }, model, 1));
}

TEST(PredictionTime, NoBlocksHaveNoTimeConstant) {
  EXPECT_FALSE(prediction_time_closed_form(0.01, 0.0, 0));
  EXPECT_FALSE(prediction_time_closed_form(0.01, 0.0, 5));
}

}  // namespace prediction_time_test
}  // namespace tactus::identification
