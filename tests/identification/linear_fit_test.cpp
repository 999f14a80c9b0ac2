// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/linear_fit.hpp>

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::identification {
namespace linear_fit_test {

// y over x = 1…5, worked by hand: slope 0.6, offset 2.2, residual squares 2.4 on three degrees of freedom, so s² = 0.8,
// the slope's standard error √(0.8/10) and the offset's √(0.8·(1/5 + 9/10)).
const std::vector<double> line_regressors{1, 1, 1, 2, 1, 3, 1, 4, 1, 5};
const std::vector<double> line_observations{2, 4, 5, 4, 5};

TEST(LinearFit, ALineWorkedByHandHasItsParametersErrorsAndResidual) {
  const auto fit = fit_linear(line_regressors, 2, line_observations);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->parameters[0], 2.2, 1e-12);
  EXPECT_NEAR(fit->parameters[1], 0.6, 1e-12);
  EXPECT_NEAR(fit->standard_errors[0], std::sqrt(0.8 * 1.1), 1e-12);
  EXPECT_NEAR(fit->standard_errors[1], std::sqrt(0.08), 1e-12);
  EXPECT_NEAR(fit->residual_rms, std::sqrt(2.4 / 5), 1e-12);
}

TEST(LinearFit, TheUnitOfARegressorDoesNotMatter) {
  std::vector<double> in_nanounits = line_regressors;
  for (std::size_t row = 0; row < line_observations.size(); ++row) in_nanounits[2 * row + 1] *= 1e9;
  const auto fit = fit_linear(in_nanounits, 2, line_observations);
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->parameters[1], 0.6e-9, 1e-21);
  EXPECT_NEAR(fit->standard_errors[1], std::sqrt(0.08) * 1e-9, 1e-21);
}

TEST(LinearFit, ParametersThatTheDataCannotTellApartAreRefused) {
  const std::vector<double> twice{1, 2, 2, 4, 3, 6};
  const auto fit = fit_linear(twice, 2, std::vector<double>{1, 2, 3});
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().code, ErrorCode::inconsistent);
  EXPECT_NE(fit.error().message.find("cannot distinguish the parameters"), std::string::npos);
}

TEST(LinearFit, ARegressorThatIsAlwaysZeroIsNamed) {
  const auto fit = fit_linear(std::vector<double>{1, 0, 2, 0, 3, 0}, 2, std::vector<double>{1, 2, 3});
  ASSERT_FALSE(fit);
  EXPECT_NE(fit.error().message.find("column 1"), std::string::npos);
}

TEST(LinearFit, SizesThatDoNotFitTooFewObservationsAndValuesThatAreNoNumbersAreRefused) {
  EXPECT_FALSE(fit_linear(std::vector<double>{1, 2, 3}, 2, std::vector<double>{1, 2, 3}));
  EXPECT_FALSE(fit_linear(std::vector<double>{1, 2, 3, 5}, 2, std::vector<double>{1, 2}));
  EXPECT_FALSE(fit_linear(std::vector<double>{}, 0, std::vector<double>{}));
  std::vector<double> spoilt = line_observations;
  spoilt[2] = std::numeric_limits<double>::quiet_NaN();
  const auto fit = fit_linear(line_regressors, 2, spoilt);
  ASSERT_FALSE(fit);
  EXPECT_EQ(fit.error().code, ErrorCode::out_of_bounds);
}

}  // namespace linear_fit_test
}  // namespace tactus::identification
