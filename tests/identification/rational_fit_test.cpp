// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/rational_fit.hpp>

#include <cmath>
#include <complex>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::identification {
namespace rational_fit_test {

TEST(RationalFit, AFourthOrderSystemIsFoundFromItsResponseToNoise) {
  // (s + 30)(s + 80)(s² + 20 s + 4000) below (s + 100)² (s + 200)(s + 50): the truth is in the class of models.
  const signal::RationalFunction truth{9.6e6, 4.88e5, 8600.0, 130.0, 1.0, 1e8, 4.5e6, 70000.0, 450.0, 1.0};
  const Seconds dt{1e-3};
  auto filter = signal::RationalFilter::make(truth, dt).value();
  std::mt19937_64 engine(1);
  std::vector<double> input, output;
  for (int i = 0; i < 20000; ++i) {
    input.push_back(static_cast<double>(engine() >> 11) * 0x1p-52 - 1.0);
    output.push_back(filter.step(input.back()));
  }
  const RationalFit fit = fit_rational(input, output, dt, 20.0).value();
  EXPECT_LT(fit.residual_rms, 1e-6);
  for (const double omega : {1.0, 30.0, 300.0}) {
    const std::complex<double> s(0.0, omega);
    EXPECT_NEAR(std::abs(fit.function(s) / truth(s) - 1.0), 0.0, 1e-4);
  }
}

TEST(RationalFit, DataThatCannotTellTheCoefficientsApartIsRefused) {
  const std::vector<double> silence(500, 0.0);
  EXPECT_FALSE(fit_rational(silence, silence, Seconds{1e-3}, 20.0));
  EXPECT_FALSE(fit_rational(std::vector<double>(5, 1.0), std::vector<double>(5, 1.0), Seconds{1e-3}, 20.0));
}

}  // namespace rational_fit_test
}  // namespace tactus::identification
