// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/inverse_model_chirp/inverse_model_chirp.hpp>

#include <cmath>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace inverse_model_chirp_test {

TEST(InverseModelChirp, TwoBlocksAtTheDerivedTimeConstantFeelATenthOfTheForceBelowTwoHertz) {
  const InverseModelChirpResult result = run_inverse_model_chirp({}).value();
  ASSERT_EQ(result.variants.size(), 5U);
  const auto& none = result.variants[0];
  const auto& two = result.variants[2];
  EXPECT_EQ(two.blocks, 2);
  EXPECT_LT(10.0 * two.chirp.below_2_Hz_N, none.chirp.below_2_Hz_N);
  EXPECT_LT(10.0 * two.multisine.below_2_Hz_N, none.multisine.below_2_Hz_N);

  EXPECT_DOUBLE_EQ(result.closed_form_s, 0.00425);
  EXPECT_NEAR(result.limit_s, result.closed_form_s, 1e-3 * result.closed_form_s);
  EXPECT_NEAR(result.by_band.front().time_constant_s, result.closed_form_s, 0.05 * result.closed_form_s);
}

TEST(InverseModelChirp, AnInverseThatCannotRunIsRefusedBeforeTheRun) {
  InverseModelChirpParams params;
  params.estimator.derivative_filter_s = 0.0;
  const Check error = check(params);
  ASSERT_TRUE(error);
  EXPECT_TRUE(error->parameter.starts_with("estimator."));
}

TEST(InverseModelChirp, ALoopThatIsUnstableIsRefusedBeforeTheRun) {
  InverseModelChirpParams params;
  params.slave.controller_gain_N_per_m = 1000.0;
  const Check error = check(params);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->parameter, "slave.controller_gain_N_per_m");
}

}  // namespace inverse_model_chirp_test
}  // namespace tactus::experiments
