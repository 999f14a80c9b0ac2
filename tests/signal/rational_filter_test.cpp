// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/rational_filter.hpp>

#include <cmath>
#include <numbers>
#include <vector>

#include "tests/signal/frequency_response.hpp"
#include <gtest/gtest.h>

namespace tactus::signal {
namespace rational_filter_test {

TEST(RationalFilter, TheSampledResponseIsTheContinuousOneAtTheWarpedFrequency) {
  // (s + 30)(s + 80)(s² + 20 s + 4000) below (s + 100)² (s + 200)(s + 50), and the same with fewer powers.
  const RationalFunction fourth{9.6e6, 4.88e5, 8600.0, 130.0, 1.0, 1e8, 4.5e6, 70000.0, 450.0, 1.0};
  const RationalFunction second{.numerator_0 = 0.0,
                                .numerator_1 = 3.0,
                                .numerator_2 = 10.0,
                                .denominator_0 = 1.0,
                                .denominator_1 = 0.02,
                                .denominator_2 = 1e-4};
  const RationalFunction none{.numerator_0 = 3.0, .denominator_0 = 2.0};
  constexpr double dt_s = 1e-3;
  for (const RationalFunction& function : {fourth, second, none}) {
    const RationalFilter filter = RationalFilter::make(function, Seconds{dt_s}).value();
    for (const double frequency_Hz : {0.5, 10.0, 200.0}) {
      const std::complex<double> s(0.0, 2.0 / dt_s * std::tan(std::numbers::pi * frequency_Hz * dt_s));
      const std::complex<double> expected = function(s);
      EXPECT_NEAR(std::abs(measured_response(filter, frequency_Hz, dt_s, 5000) - expected), 0.0,
                  1e-9 * (1.0 + std::abs(expected)));
    }
  }
}

TEST(RationalFilter, ImproperOrUnstableFunctionsAreRefused) {
  const auto improper = RationalFilter::make({.numerator_2 = 1.0, .denominator_1 = 0.1}, Seconds{1e-3});
  ASSERT_FALSE(improper);
  EXPECT_EQ(improper.error().parameter, "numerator_2");
  const auto unstable = RationalFilter::make({.denominator_0 = -1.0, .denominator_1 = 0.1}, Seconds{1e-3});
  ASSERT_FALSE(unstable);
  EXPECT_EQ(unstable.error().parameter, "denominator_1");
}

TEST(Routh, RootsLeftOfTheAxisAndOnlyThose) {
  using Polynomial = std::vector<double>;
  EXPECT_TRUE(is_hurwitz(Polynomial{24.0, 50.0, 35.0, 10.0, 1.0}));  // −1, −2, −3, −4
  EXPECT_TRUE(is_hurwitz(Polynomial{-2.0, -3.0, -1.0}));             // −1, −2, negated
  EXPECT_FALSE(is_hurwitz(Polynomial{2.0, 1.0, 1.0, 1.0}));          // −1.35, 0.18 ± 1.2i
  EXPECT_FALSE(is_hurwitz(Polynomial{1.0, 0.0, 1.0}));               // ±i
  EXPECT_FALSE(is_hurwitz(Polynomial{0.0, 0.0}));
  EXPECT_TRUE(is_hurwitz(Polynomial{5.0}));
}

}  // namespace rational_filter_test
}  // namespace tactus::signal
