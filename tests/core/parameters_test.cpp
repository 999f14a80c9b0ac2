// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/parameters.hpp>

#include <limits>

#include <gtest/gtest.h>

namespace tactus {
namespace {

struct Inner {
  double mass_kg = 0.01;
  static constexpr auto fields() {
    return List{field("mass_kg", &Inner::mass_kg, units::kilogram, positive, "Moving mass.")};
  }
};

struct Outer {
  Inner motor;
  std::int64_t taps = 32;
  static constexpr auto fields() {
    return List{field("motor", &Outer::motor, "The motor."),
                field("taps", &Outer::taps, between(1, 4096), "Number of taps.")};
  }
};

TEST(Parameters, DefaultsOfASoundDescriptionAreValid) { EXPECT_FALSE(validate(Outer{}).has_value()); }

TEST(Parameters, AnErrorNamesThePathTheValueTheBoundsAndTheUnit) {
  Outer outer;
  outer.motor.mass_kg = -0.5;
  const Check error = validate(outer);
  ASSERT_TRUE(error.has_value());
  EXPECT_EQ(describe(*error), "motor.mass_kg: -0.5 kg is out of bounds: it must be finite and greater than 0 kg");
  EXPECT_EQ(exit_status(*error), 2);
}

TEST(Parameters, AComputedNumberIsRoundedInAMessageAndAWrittenOneIsNot) {
  EXPECT_EQ(rounded_number(-6.1000000000000005), "-6.1");
  EXPECT_EQ(rounded_number(1.0 / 3.0), "0.333333");
  EXPECT_EQ(rounded_number(2e-5 / 3.0), "6.66667e-06");
  EXPECT_EQ(rounded_number(4097.0), "4097");
  EXPECT_EQ(rounded_number(123.456789), "123.456789");
  EXPECT_EQ(out_of_bounds("gain", 7.0 / 3.0, between(0, 1), units::none).message,
            "2.33333 is out of bounds: it must be at least 0 and at most 1");
  EXPECT_EQ(out_of_bounds("gain", 10.000000000000002, between(0, 10), units::none).message,
            "10.000000000000002 is out of bounds: it must be at least 0 and at most 10");
}

TEST(Parameters, NothingThatIsNotFiniteIsEverWithinBounds) {
  for (const double value : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()}) {
    EXPECT_FALSE(any_finite.contain(value));
    EXPECT_FALSE(non_negative.contain(value));
  }
}

TEST(Parameters, ABoundIsPartOfTheRangeUnlessItIsOpen) {
  EXPECT_TRUE(between(1, 20).contain(1));
  EXPECT_TRUE(between(1, 20).contain(20));
  EXPECT_FALSE(between(1, 20).contain(20.0001));
  EXPECT_FALSE(positive.contain(0.0));
  EXPECT_TRUE(non_negative.contain(0.0));
}

}  // namespace
}  // namespace tactus
