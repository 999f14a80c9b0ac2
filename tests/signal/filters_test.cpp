#include <tactus/signal/delay_line.hpp>
#include <tactus/signal/filtered_derivative.hpp>
#include <tactus/signal/low_pass.hpp>
#include <tactus/signal/random.hpp>
#include <tactus/signal/second_order_filter.hpp>

#include <gtest/gtest.h>

namespace tactus::signal {
namespace {

static_assert(Element<LowPass>);
static_assert(Element<SecondOrderFilter>);
static_assert(Element<FilteredDerivative>);
static_assert(Element<DelayLine<double, 8>>);

constexpr Seconds tick{200e-6};

TEST(LowPass, AConstantPassesUnchangedOnceSettled) {
  auto filter = LowPass::make({}, tick);
  ASSERT_TRUE(filter);
  filter->settle(0.7);
  EXPECT_NEAR(filter->step(0.7), 0.7, 1e-15);
}

TEST(FilteredDerivative, TheFirstSampleGivesNoKick) {
  auto derivative = FilteredDerivative::make({}, tick);
  ASSERT_TRUE(derivative);
  EXPECT_EQ(derivative->step(12.5), 0.0);
}

}  // namespace
}  // namespace tactus::signal
