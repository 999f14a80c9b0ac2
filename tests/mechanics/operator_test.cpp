// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/mechanics/operator.hpp>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::mechanics {
namespace operator_test {

static_assert(Element<Operator>);

constexpr double tick_s = 200e-6;
constexpr double tau = 2.0 * std::numbers::pi;

Operator person(const Operator::Params& params) { return Operator::make(params, Seconds{tick_s}).value(); }

constexpr Operator::Params calm{.grip_change = {}, .correction = {}, .tremor_amplitude_m = 0.0};

double path_m(double time_s) { return 0.02 * std::sin(3.0 * time_s) + 0.01 * time_s; }

TEST(Operator, WithoutCorrectionAndTremorTheAimIsThePathExactly) {
  Operator element = person({.grip_change = {}, .correction = {.gain_per_s = 0.0}, .tremor_amplitude_m = 0.0});
  for (int tick = 0; tick < 10000; ++tick) {
    const double now_m = path_m(tick * tick_s);
    const double next_m = path_m((tick + 1) * tick_s);
    const Operator::Output aim =
        element.step({.path_m = now_m, .path_at_next_tick_m = next_m, .handle_position_m = 0.5});
    ASSERT_EQ(aim.position_m, now_m);
    ASSERT_EQ(aim.velocity_m_per_s, (next_m - now_m) / tick_s);
  }
}

TEST(Operator, TremorIsASineOfItsAmplitudeFrequencyAndPhase) {
  for (const double frequency_Hz : {1.0, 8.3, 10.0, 30.0}) {
    for (const double phase : {0.0, 0.25, 0.7}) {
      constexpr double amplitude_m = 1e-4;
      Operator element = person({.grip_change = {},
                                 .correction = {.gain_per_s = 0.0},
                                 .tremor_amplitude_m = amplitude_m,
                                 .tremor_frequency_Hz = frequency_Hz,
                                 .tremor_phase_cycles = phase});
      // A minute: turning the phase by a fixed angle must not drift.
      for (int tick = 0; tick < 300000; ++tick) {
        const double moved_m = element.step({}).position_m;
        ASSERT_NEAR(moved_m, amplitude_m * std::sin(tau * (frequency_Hz * tick * tick_s + phase)), 1e-9 * amplitude_m);
      }
    }
  }
}

TEST(Operator, AtItsVelocityTheAimGetsToWhereTheNextTickStarts) {
  Operator element = person({.grip_change = {}, .correction = {}, .tremor_amplitude_m = 1e-3});
  double expected_m = element.step({.path_at_next_tick_m = path_m(0.0), .handle_position_m = 0.01}).position_m;
  element.reset();
  for (int tick = 0; tick < 5000; ++tick) {
    const Operator::Output aim = element.step({.path_m = path_m(tick * tick_s),
                                               .path_at_next_tick_m = path_m((tick + 1) * tick_s),
                                               .handle_position_m = 0.01 * std::cos(0.01 * tick)});
    ASSERT_NEAR(aim.position_m, expected_m, 1e-16);
    expected_m = aim.position_m + tick_s * aim.velocity_m_per_s;
  }
}

TEST(Operator, CorrectionBeginsNoEarlierThanTheReactionTimeAndOpposesTheError) {
  Operator element = person(calm);
  constexpr int error_begins = 100;
  constexpr int reaction_ticks = 500;
  for (int tick = 0; tick < error_begins + reaction_ticks + 100; ++tick) {
    const Operator::Output aim = element.step({.handle_position_m = tick < error_begins ? 0.0 : 0.01});
    if (tick < error_begins + reaction_ticks) {
      ASSERT_EQ(aim.position_m, 0.0) << tick;
      ASSERT_EQ(aim.velocity_m_per_s, 0.0) << tick;
    } else {
      ASSERT_LT(aim.velocity_m_per_s, 0.0) << tick;
    }
  }
}

TEST(Operator, AnErrorThatDoesNotYieldIsAnsweredByARampAfterReactionTimeAndLowPass) {
  constexpr double error_m = 0.01;
  Operator element = person(calm);
  const Operator::Correction& correction = calm.correction;
  const double corner = tau * correction.bandwidth_Hz;
  for (int tick = 0; tick < 5000; ++tick) {
    const double moved_m = element.step({.handle_position_m = error_m}).position_m;
    const double since_s = std::max(0.0, tick * tick_s - correction.reaction_time_s);
    const double expected_m =
        -correction.gain_per_s * error_m * (since_s - (1.0 - std::exp(-corner * since_s)) / corner);
    // Within one tick of the ramp.
    ASSERT_NEAR(moved_m, expected_m, correction.gain_per_s * error_m * tick_s);
  }
}

/// The slowest solution e^{st} of the closed loop ė = −gain · lowpass(e)(t − delay): a zero of
/// s (1 + s/corner) + gain e^{−s·delay}, by Newton's method.
std::complex<double> slowest_mode(const Operator::Correction& correction, std::complex<double> guess) {
  const double corner = tau * correction.bandwidth_Hz;
  std::complex<double> s = guess;
  for (int i = 0; i < 100; ++i) {
    const auto delayed = correction.gain_per_s * std::exp(-s * correction.reaction_time_s);
    s -= (s * (1.0 + s / corner) + delayed) / (1.0 + 2.0 * s / corner - correction.reaction_time_s * delayed);
  }
  return s;
}

TEST(Operator, AConstantDisplacementOfTheHandleDiesAwayLikeTheDelayDifferentialEquation) {
  struct Case {
    double gain_per_s;
    std::complex<double> guess;
  };
  // A slow person creeps back, a quick one overshoots.
  for (const Case& each : {Case{2.0, {-2.5, 0.0}}, Case{4.0, {-4.0, 5.0}}, Case{7.0, {-2.0, 6.0}}}) {
    Operator::Params params = calm;
    params.correction.gain_per_s = each.gain_per_s;
    const std::complex<double> mode = slowest_mode(params.correction, each.guess);
    ASSERT_LT(mode.real(), 0.0);
    Operator element = person(params);
    std::vector<double> errors_m;
    double handle_m = 0.01;
    for (int tick = 0; tick < 15000; ++tick) {
      const Operator::Output aim = element.step({.handle_position_m = handle_m});
      errors_m.push_back(handle_m);
      handle_m = aim.position_m + tick_s * aim.velocity_m_per_s + 0.01;
    }
    // Any sum of e^{st} and its conjugate obeys e₂ = 2 Re(z) e₁ − |z|² e₀ with z = e^{s·spacing}; a real one e₁ = z e₀.
    constexpr std::size_t start = 7500, spacing = 1000;
    const auto z = std::exp(mode * (spacing * tick_s));
    const double e0 = errors_m[start], e1 = errors_m[start + spacing], e2 = errors_m[start + 2 * spacing];
    if (mode.imag() == 0.0) {
      EXPECT_NEAR(e1 / e0, z.real(), 0.005 * z.real()) << each.gain_per_s;
      EXPECT_NEAR(e2 / e1, z.real(), 0.005 * z.real()) << each.gain_per_s;
    } else {
      const double size = std::hypot(e0, e1);
      EXPECT_NEAR(e2, 2.0 * z.real() * e1 - std::norm(z) * e0, 0.01 * size) << each.gain_per_s;
    }
    EXPECT_LT(std::fabs(errors_m.back()), 1e-3 * 0.01);
  }
}

TEST(Operator, APersonQuickerThanTheBoundIsRefusedByName) {
  const auto hasty = Operator::make({.grip_change = {}, .correction = {.gain_per_s = 9.0}}, Seconds{tick_s});
  ASSERT_FALSE(hasty);
  EXPECT_EQ(hasty.error().parameter, "correction.gain_per_s");
  const auto too_long_in_ticks =
      Operator::make({.grip_change = {}, .correction = {.reaction_time_s = 0.4}}, Seconds{40e-6});
  ASSERT_FALSE(too_long_in_ticks);
  EXPECT_EQ(too_long_in_ticks.error().parameter, "correction.reaction_time_s");
}

}  // namespace operator_test
}  // namespace tactus::mechanics
