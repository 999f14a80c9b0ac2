// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/low_pass.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <cmath>
#include <numbers>

#include "tests/oracle_table.hpp"
#include "tests/signal/frequency_response.hpp"
#include <gtest/gtest.h>

namespace tactus::signal {
namespace filters_test {

static_assert(Element<LowPass>);
static_assert(Element<SecondOrderFilter>);

constexpr double rate_Hz = 5000.0;
constexpr double dt_s = 1.0 / rate_Hz;
constexpr double half_power = std::numbers::sqrt2 / 2.0;

LowPass low_pass(double cutoff_Hz) { return LowPass::make({.cutoff_Hz = cutoff_Hz}, Seconds{dt_s}).value(); }

SecondOrderFilter second_order(FilterKind kind, double frequency_Hz, double width_Hz = 50.0) {
  return SecondOrderFilter::make({.kind = kind, .frequency_Hz = frequency_Hz, .notch_width_Hz = width_Hz},
                                 Seconds{dt_s})
      .value();
}

/// The frequency in the analogue prototype that the bilinear transform takes this one to.
double warped(double frequency_Hz) { return std::tan(std::numbers::pi * frequency_Hz * dt_s); }

TEST(LowPass, LosesThreeDecibelsAndFortyFiveDegreesExactlyAtItsCutoff) {
  for (const double cutoff_Hz : {2.0, 30.0, 300.0, 1500.0, 2400.0}) {
    const auto response = measured_response(low_pass(cutoff_Hz), cutoff_Hz, dt_s);
    EXPECT_NEAR(std::abs(response), half_power, 1e-9) << cutoff_Hz;
    EXPECT_NEAR(std::arg(response), -std::numbers::pi / 4.0, 1e-9) << cutoff_Hz;
  }
}

TEST(LowPass, FollowsTheAnalogueResponseAtWarpedFrequencies) {
  for (double frequency_Hz = 1.0; frequency_Hz < 2500.0; frequency_Hz *= 1.7) {
    const double ratio = warped(frequency_Hz) / warped(300.0);
    EXPECT_NEAR(std::abs(measured_response(low_pass(300.0), frequency_Hz, dt_s)), 1.0 / std::hypot(1.0, ratio), 1e-9);
  }
}

TEST(SecondOrderFilter, LowAndHighPassLoseThreeDecibelsExactlyAtTheirFrequency) {
  for (const double frequency_Hz : {2.0, 30.0, 300.0, 1500.0, 2400.0}) {
    for (const FilterKind kind : {FilterKind::low_pass, FilterKind::high_pass}) {
      const auto response = measured_response(second_order(kind, frequency_Hz), frequency_Hz, dt_s);
      EXPECT_NEAR(std::abs(response), half_power, 1e-9) << name_of(kind) << " at " << frequency_Hz;
      const double quarter_turn = kind == FilterKind::low_pass ? -0.5 : 0.5;
      EXPECT_NEAR(std::arg(response), quarter_turn * std::numbers::pi, 1e-9);
    }
  }
}

TEST(SecondOrderFilter, LowAndHighPassFollowButterworthAtWarpedFrequencies) {
  for (double frequency_Hz = 1.0; frequency_Hz < 2500.0; frequency_Hz *= 1.7) {
    const double ratio = warped(frequency_Hz) / warped(200.0);
    const double low = 1.0 / std::sqrt(1.0 + std::pow(ratio, 4));
    EXPECT_NEAR(std::abs(measured_response(second_order(FilterKind::low_pass, 200.0), frequency_Hz, dt_s)), low, 1e-9);
    EXPECT_NEAR(std::abs(measured_response(second_order(FilterKind::high_pass, 200.0), frequency_Hz, dt_s)),
                low * ratio * ratio, 1e-9);
  }
}

/// Where the gain crosses −3 dB between a frequency that passes and one that does not.
double half_power_frequency(const SecondOrderFilter& filter, double passes_Hz, double stopped_Hz) {
  for (int i = 0; i < 40; ++i) {
    const double middle_Hz = 0.5 * (passes_Hz + stopped_Hz);
    (std::abs(measured_response(filter, middle_Hz, dt_s, 8000)) > half_power ? passes_Hz : stopped_Hz) = middle_Hz;
  }
  return passes_Hz;
}

TEST(SecondOrderFilter, ANotchIsSilentAtItsCentreAndExactlyAsWideAsItSays) {
  for (const auto& [centre_Hz, width_Hz] : {std::pair{75.0, 30.0}, {480.0, 50.0}, {2000.0, 400.0}}) {
    const auto notch = second_order(FilterKind::notch, centre_Hz, width_Hz);
    EXPECT_LT(std::abs(measured_response(notch, centre_Hz, dt_s)), 1e-9);
    const double width_measured_Hz =
        half_power_frequency(notch, 2499.0, centre_Hz) - half_power_frequency(notch, 0.1, centre_Hz);
    EXPECT_NEAR(width_measured_Hz, width_Hz, 1e-6 * width_Hz) << "centre " << centre_Hz << " Hz";
    EXPECT_NEAR(std::abs(measured_response(notch, 0.0, dt_s)), 1.0, 1e-9);
    EXPECT_NEAR(std::abs(measured_response(notch, 2500.0, dt_s)), 1.0, 1e-9);
  }
}

template <class Filter>
void expect_column(const OracleTable& table, const char* column, Filter filter) {
  const auto input = table.column("input");
  const auto expected = table.column(column);
  for (std::size_t n = 0; n < input.size(); ++n) {
    ASSERT_NEAR(filter.step(input[n]), expected[n], 1e-11) << column << ", row " << n;
  }
}

TEST(Filters, GiveWhatScipyGivesForTheSameDesigns) {
  const OracleTable table("signal_filters");
  expect_column(table, "low_pass_1_at_300_Hz", low_pass(300.0));
  expect_column(table, "low_pass_2_at_300_Hz", second_order(FilterKind::low_pass, 300.0));
  expect_column(table, "low_pass_2_at_2000_Hz", second_order(FilterKind::low_pass, 2000.0));
  expect_column(table, "high_pass_2_at_20_Hz", second_order(FilterKind::high_pass, 20.0));
  expect_column(table, "notch_at_75_Hz_width_30_Hz", second_order(FilterKind::notch, 75.0, 30.0));
}

template <class Filter>
void expect_no_transient(Filter filter, double value, double expected) {
  filter.settle(value);
  for (int n = 0; n < 100; ++n) ASSERT_NEAR(filter.step(value), expected, 1e-12);
}

TEST(Filters, ASettledFilterStartsWithoutATransient) {
  expect_no_transient(low_pass(10.0), 0.7, 0.7);
  expect_no_transient(second_order(FilterKind::low_pass, 10.0), 0.7, 0.7);
  expect_no_transient(second_order(FilterKind::high_pass, 10.0), 0.7, 0.0);
  expect_no_transient(second_order(FilterKind::notch, 75.0), 0.7, 0.7);
}

TEST(Filters, AFrequencyFromHalfTheSampleRateUpIsRefusedWithTheRemedy) {
  EXPECT_EQ(describe(LowPass::make({.cutoff_Hz = 2500.0}, Seconds{200e-6}).error()),
            "cutoff_Hz: 2500 Hz must lie below half the sample rate, 2500 Hz at a sample time of 2e-04 s: lower the "
            "frequency or sample faster");
  for (const FilterKind kind : {FilterKind::low_pass, FilterKind::high_pass, FilterKind::notch}) {
    const auto filter = SecondOrderFilter::make({.kind = kind, .frequency_Hz = 2600.0}, Seconds{dt_s});
    ASSERT_FALSE(filter.ok());
    EXPECT_EQ(filter.error().parameter, "frequency_Hz");
  }
  const auto wide = SecondOrderFilter::make({.kind = FilterKind::notch, .notch_width_Hz = 2500.0}, Seconds{dt_s});
  ASSERT_FALSE(wide.ok());
  EXPECT_EQ(wide.error().parameter, "notch_width_Hz");
}

}  // namespace filters_test
}  // namespace tactus::signal
