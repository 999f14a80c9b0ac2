// SPDX-License-Identifier: Apache-2.0
#include "tests/control/rivals.hpp"

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

// The remedies of paper A, Sec. IV, each alone, all seen from outside the site.
namespace tactus::control {
namespace rivals_test {

static_assert(Element<ShapingFilter>);
static_assert(Element<LocalDamping>);
static_assert(Element<Crossover>);

using Complex = std::complex<double>;

constexpr double half_power = std::numbers::sqrt2 / 2.0;

/// What a site makes of a sine, once settled: `drive(sample)` is the site's input, `read(output)` what is looked at.
/// Fits sine and cosine over a window of whole periods of every multiple of 5 Hz.
template <class Drive, class Read>
Complex response(PositionForceMaster site, double frequency_Hz, Drive drive, Read read) {
  constexpr int settling = 10000, window = 5000;
  Complex sum = 0.0;
  for (int n = 0; n < settling + window; ++n) {
    const MasterOutput out = site.step(drive(1e-3 * std::cos(angle_of(frequency_Hz) * n)));
    if (n >= settling) sum += read(out) * std::polar(1.0, -angle_of(frequency_Hz) * n);
  }
  return sum * (2.0 / (window * 1e-3));
}

Complex command_response(const Params& params, double frequency_Hz) {
  return response(
      master(params), frequency_Hz, [](double sample) { return input(sample, 0.0); },
      [](const MasterOutput& out) { return out.message.position_m; });
}

/// Positive when it pushes the hand back, as the force from the slave is.
Complex motor_response(const Params& params, double frequency_Hz) {
  return response(
      master(params), frequency_Hz, [](double sample) { return input(0.0, sample); },
      [](const MasterOutput& out) { return -out.motor_force_N; });
}

Complex handle_response(const Params& params, double frequency_Hz) {
  return response(
      master(params), frequency_Hz, [](double sample) { return input(0.0, sample); },
      [](const MasterOutput& out) { return -out.handle_force_N; });
}

/// The analogue low-pass at the frequency that the bilinear transform makes of this one.
Complex butterworth(double frequency_Hz, double corner_Hz) {
  const Complex s(0.0, std::tan(0.5 * angle_of(frequency_Hz)) / std::tan(0.5 * angle_of(corner_Hz)));
  return 1.0 / (s * s + std::numbers::sqrt2 * s + 1.0);
}

void expect_near(Complex actual, Complex expected, double tolerance, double frequency_Hz) {
  EXPECT_NEAR(actual.real(), expected.real(), tolerance) << frequency_Hz << " Hz";
  EXPECT_NEAR(actual.imag(), expected.imag(), tolerance) << frequency_Hz << " Hz";
}

constexpr double frequencies_Hz[] = {5.0, 20.0, 40.0, 75.0, 150.0, 400.0, 1000.0, 2000.0};

TEST(CommandFilter, ALowPassShapesTheCommandAsButterworthAndLosesThreeDecibelsAtItsFrequency) {
  Params params = plain();
  params.position_scale = 0.5;
  params.command_filter = {.kind = Shaping::low_pass, .frequency_Hz = 40.0};
  for (const double f : frequencies_Hz) {
    expect_near(command_response(params, f), 0.5 * butterworth(f, 40.0), 1e-9, f);
  }
  EXPECT_NEAR(std::abs(command_response(params, 40.0)), 0.5 * half_power, 1e-9);
}

TEST(ForceFilter, ALowPassShapesTheDisplayedForceAsButterworthAndLosesThreeDecibelsAtItsFrequency) {
  Params params = plain();
  params.force_gain = 4.0;
  params.force_filter = {.kind = Shaping::low_pass, .frequency_Hz = 40.0};
  for (const double f : frequencies_Hz) {
    expect_near(motor_response(params, f), 4.0 * butterworth(f, 40.0), 1e-9, f);
    EXPECT_EQ(std::abs(handle_response(params, f)), 0.0);
  }
  EXPECT_NEAR(std::abs(motor_response(params, 40.0)), 4.0 * half_power, 1e-9);
}

/// The edges of a band of `width_Hz` around a centre of a digital notch: cos ω₀ = cos(middle) / cos(half the width).
struct Edges {
  double lower_Hz, upper_Hz;
};
Edges edges(double centre_Hz, double width_Hz) {
  const double middle = std::acos(std::cos(angle_of(centre_Hz)) * std::cos(0.5 * angle_of(width_Hz)));
  const double middle_Hz = middle / angle_of(1.0);
  return {middle_Hz - 0.5 * width_Hz, middle_Hz + 0.5 * width_Hz};
}

TEST(ShapingFilters, ANotchSilencesItsFrequencyInCommandAndForceAndHasItsEdgesWhereItSays) {
  Params params = plain();
  const ShapingFilter::Params notch{.kind = Shaping::notch, .frequency_Hz = 75.0, .notch_width_Hz = 50.0};
  params.command_filter = notch;
  params.force_filter = notch;
  for (auto* look : {&command_response, &motor_response}) {
    EXPECT_LT(std::abs(look(params, 75.0)), 1e-9);
    EXPECT_NEAR(std::abs(look(params, 5.0)), 1.0, 2e-3);
    EXPECT_NEAR(std::abs(look(params, 2000.0)), 1.0, 2e-3);
  }
  // An edge falls between the frequencies that the window holds whole, so it is put there: 50 and 110 Hz.
  const double width_Hz = 60.0;
  double centre_Hz = 75.0;
  for (int i = 0; i < 60; ++i) centre_Hz += 50.0 - edges(centre_Hz, width_Hz).lower_Hz;
  const ShapingFilter::Params placed{.kind = Shaping::notch, .frequency_Hz = centre_Hz, .notch_width_Hz = width_Hz};
  params.command_filter = placed;
  params.force_filter = placed;
  for (auto* look : {&command_response, &motor_response}) {
    EXPECT_NEAR(std::abs(look(params, 50.0)), half_power, 1e-9);
    EXPECT_NEAR(std::abs(look(params, 110.0)), half_power, 1e-9);
  }
}

TEST(ShapingFilters, StartFromTheFirstSampleWithoutATransientWhereverThatIs) {
  for (const Shaping kind : {Shaping::low_pass, Shaping::notch}) {
    Params params = plain();
    params.command_filter.kind = kind;
    params.force_filter.kind = kind;
    PositionForceMaster site = master(params);
    for (const double start : {0.3, -0.2}) {
      site.reset();
      for (int tick = 0; tick < 200; ++tick) {
        const auto out = site.step(input(start, start));
        ASSERT_NEAR(out.message.position_m, start, 1e-12) << name_of(kind) << " at tick " << tick;
        ASSERT_NEAR(out.motor_force_N, -start, 1e-12) << name_of(kind) << " at tick " << tick;
      }
    }
  }
}

/// By how much the command lags a steady motion, in s.
double lag_s(const ShapingFilter::Params& filter) {
  Params params = plain();
  params.command_filter = filter;
  PositionForceMaster site = master(params);
  constexpr double speed_m_per_s = 0.1;
  double position_m = 0.0, command_m = 0.0;
  for (int tick = 0; tick < 5000; ++tick) {
    position_m = 0.2 + speed_m_per_s * tick_s * tick;
    command_m = site.step(input(position_m, 0.0)).message.position_m;
  }
  return (position_m - command_m) / speed_m_per_s;
}

TEST(CommandFilter, LagsASteadyMotionByTheSlopeOfItsPhase) {
  // Of the analogue filters √2 / (2π f) and width / (2π f²). The bilinear transform changes the second by its warping.
  const auto warped = [](double frequency_Hz) { return std::tan(0.5 * angle_of(frequency_Hz)); };
  const double low_pass_s = lag_s({.kind = Shaping::low_pass, .frequency_Hz = 30.0});
  EXPECT_NEAR(low_pass_s, std::numbers::sqrt2 / warped(30.0) * 0.5 * tick_s, 1e-9);
  EXPECT_NEAR(low_pass_s, std::numbers::sqrt2 / (2.0 * std::numbers::pi * 30.0), 1e-3 * low_pass_s);
  const double notch_s = lag_s({.kind = Shaping::notch, .frequency_Hz = 75.0, .notch_width_Hz = 50.0});
  const double centre2 = std::pow(warped(75.0), 2);
  EXPECT_NEAR(notch_s, warped(50.0) * (1.0 + centre2) / centre2 * 0.5 * tick_s, 1e-9);
  EXPECT_NEAR(notch_s, 50.0 / (2.0 * std::numbers::pi * 75.0 * 75.0), 1e-2 * notch_s);
}

TEST(Crossover, ThePartsOfMotorAndHandleSumToTheWholeForceAtEveryInstant) {
  Params params = plain();
  params.force_gain = 2.0;
  params.crossover.frequency_Hz = 60.0;
  PositionForceMaster site = master(params);
  for (int tick = 0; tick < 5000; ++tick) {
    const double tip_force_N = 0.5 + std::sin(0.3 * tick) + (tick % 700 < 20 ? 3.0 : 0.0);
    const auto out = site.step(input(0.0, tip_force_N));
    // Two roundings of numbers no larger than these.
    const double round_off = std::numeric_limits<double>::epsilon() * (std::fabs(out.motor_force_N) + 10.0);
    ASSERT_NEAR(out.motor_force_N + out.handle_force_N, -2.0 * tip_force_N, round_off) << tick;
  }
}

TEST(Crossover, TheMotorGetsTheLowPassAndTheHandleWhatIsMissing) {
  Params params = plain();
  params.crossover.frequency_Hz = 40.0;
  for (const double f : frequencies_Hz) {
    expect_near(motor_response(params, f), butterworth(f, 40.0), 1e-9, f);
    expect_near(handle_response(params, f), 1.0 - butterworth(f, 40.0), 1e-9, f);
  }
  EXPECT_NEAR(std::abs(motor_response(params, 40.0)), half_power, 1e-9);
  EXPECT_NEAR(std::abs(handle_response(params, 40.0)), std::sqrt(3.0) / std::numbers::sqrt2, 1e-9);
}

TEST(Crossover, AForceThatIsThereFromTheFirstSampleIsTheMotorsAlone) {
  Params params = plain();
  params.crossover.frequency_Hz = 10.0;
  PositionForceMaster site = master(params);
  for (int tick = 0; tick < 200; ++tick) {
    const auto out = site.step(input(0.0, 0.8));
    ASSERT_NEAR(out.motor_force_N, -0.8, 1e-14);
    ASSERT_NEAR(out.handle_force_N, 0.0, 1e-14);
  }
}

TEST(Crossover, NothingOfItEntersTheCommand) {
  Params split = plain();
  split.crossover.frequency_Hz = 40.0;
  PositionForceMaster with = master(split), without = master(plain());
  for (int tick = 0; tick < 500; ++tick) {
    const MasterInput in = input(1e-3 * std::sin(0.1 * tick), std::cos(0.2 * tick));
    ASSERT_EQ(with.step(in).message.position_m, without.step(in).message.position_m);
  }
}

TEST(LocalDamping, ASteadyMotionMeetsDampingTimesVelocityAndTheStartNone) {
  for (const double speed_m_per_s : {0.1, -0.25}) {
    Params params = plain();
    params.damping.damping_N_s_per_m = 7.0;
    PositionForceMaster site = master(params);
    double force_N = 0.0;
    for (int tick = 0; tick < 1000; ++tick) {
      const auto out = site.step(input(0.3 + speed_m_per_s * tick_s * tick, 0.5));
      if (tick == 0) {
        EXPECT_EQ(out.motor_force_N, -0.5);
      }
      EXPECT_EQ(out.message.position_m, 0.3 + speed_m_per_s * tick_s * tick);
      force_N = out.motor_force_N;
    }
    EXPECT_NEAR(force_N, -0.5 - 7.0 * speed_m_per_s, 1e-9);
  }
}

TEST(LocalDamping, LosesThreeDecibelsOfAnIdealDamperAtItsCutoff) {
  Params params = plain();
  params.damping = {.damping_N_s_per_m = 7.0, .velocity = {.cutoff_Hz = 200.0}};
  const Complex force = response(
      master(params), 200.0, [](double sample) { return input(sample, 0.0); },
      [](const MasterOutput& out) { return out.motor_force_N; });
  EXPECT_NEAR(std::abs(force), 7.0 * 2.0 * std::numbers::pi * 200.0 * half_power, 1e-6);
}

TEST(Rivals, TheForceFilterComesBeforeTheCrossoverSoNeitherActuatorGetsWhatItTakesOut) {
  Params params = plain();
  params.force_filter = {.kind = Shaping::notch, .frequency_Hz = 100.0, .notch_width_Hz = 50.0};
  params.crossover.frequency_Hz = 100.0;
  EXPECT_LT(std::abs(motor_response(params, 100.0)), 1e-9);
  EXPECT_LT(std::abs(handle_response(params, 100.0)), 1e-9);
}

}  // namespace rivals_test
}  // namespace tactus::control
