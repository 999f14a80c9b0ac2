// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/contest/spectral_error.hpp>

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::experiments {
namespace spectral_error_test {

constexpr double sample_time_s = 200e-6;
constexpr std::size_t samples = 1000;  // a bin every 5 Hz
constexpr std::size_t middle = 500;

std::vector<double> impulse(double height, std::size_t at = middle) {
  std::vector<double> signal(samples, 0.0);
  signal[at] = height;
  return signal;
}

double error(const std::vector<double>& wanted, const std::vector<double>& arrived) {
  return spectral_error(wanted, arrived, sample_time_s, 20.0, 1000.0).value();
}

TEST(SpectralError, IsNoughtForEqualSpectraOneForNothingAndTheShareThatIsMissingElse) {
  EXPECT_DOUBLE_EQ(error(impulse(2.0), impulse(2.0)), 0.0);
  EXPECT_NEAR(error(impulse(2.0), impulse(0.5)), 0.75, 1e-12);
  EXPECT_NEAR(error(impulse(2.0), impulse(4.0)), 1.0, 1e-12);
  EXPECT_NEAR(error(impulse(2.0), std::vector<double>(samples, 0.0)), 1.0, 1e-12);
}

TEST(SpectralError, DoesNotCountADelayNorASign) {
  EXPECT_NEAR(error(impulse(1.0), impulse(1.0, middle + 50)), 0.0, 1e-9);
  EXPECT_NEAR(error(impulse(1.0), impulse(-1.0)), 0.0, 1e-12);
}

TEST(SpectralError, OfAFirstOrderLowPassIsThatOfItsFrequencyResponse) {
  const double pole = 0.9;
  std::vector<double> arrived(samples, 0.0);
  for (std::size_t i = middle; i < samples; ++i) {
    arrived[i] = (1.0 - pole) * std::pow(pole, static_cast<double>(i - middle));
  }
  double squares = 0.0;
  int bins = 0;
  for (double frequency_Hz = 20.0; frequency_Hz <= 1000.0; frequency_Hz += 5.0, ++bins) {
    const double angle = 2.0 * std::numbers::pi * frequency_Hz * sample_time_s;
    const double gain = (1.0 - pole) / std::sqrt(1.0 - 2.0 * pole * std::cos(angle) + pole * pole);
    squares += (1.0 - gain) * (1.0 - gain);
  }
  EXPECT_NEAR(error(impulse(1.0), arrived), std::sqrt(squares / bins), 1e-9);
}

TEST(SpectralError, DoesNotHearWhatLiesOutsideTheBand) {
  std::vector<double> arrived = impulse(1.0);
  for (std::size_t i = 0; i < samples; ++i) {
    arrived[i] += std::sin(2.0 * std::numbers::pi * 2000.0 * sample_time_s * static_cast<double>(i));
  }
  EXPECT_LT(error(impulse(1.0), arrived), 1e-3);
}

TEST(SpectralError, HasNoMeaningWhereNothingWasWanted) {
  EXPECT_FALSE(spectral_error(std::vector<double>(samples, 0.0), impulse(1.0), sample_time_s, 20.0, 1000.0));
}

}  // namespace spectral_error_test
}  // namespace tactus::experiments
