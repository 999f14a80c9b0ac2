// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/model/induced_motion_model.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <utility>

#include "tests/signal/frequency_response.hpp"
#include <gtest/gtest.h>

// The linear models of lower fidelity. Oracles: impedances of paper A's Table I in complex algebra, and the closed
// solutions of a mass on a spring.
namespace tactus::control {
namespace model_fidelity_test {

constexpr double tick_s = 200e-6;
constexpr CancellationStep both_steps[] = {CancellationStep::exact, CancellationStep::euler};
constexpr ModelFidelity linear_models[] = {ModelFidelity::second_order, ModelFidelity::fourth_order,
                                           ModelFidelity::sixth_order_linear};

InducedMotionModel::Params params(ModelFidelity fidelity, CancellationStep step = CancellationStep::exact) {
  InducedMotionModel::Params made;
  made.fidelity = fidelity;
  made.step = step;
  return made;
}

InducedMotionModel make(const InducedMotionModel::Params& params) {
  return InducedMotionModel::make(params, Seconds{tick_s}).value();
}

/// The model as an element from force to position.
struct Compliance {
  InducedMotionModel model;
  double step(double force_N) { return model.step({.motor_force_N = force_N}); }
  void reset() { model.reset(); }
};

constexpr double hand_N_per_m = 40.0, hand_N_s_per_m = 23.0;

/// Table I once more: motor position over motor force at the complex frequency `s`, in m/N, with the hand's stiffness
/// multiplied. Each mass carries what lies beyond it.
std::complex<double> compliance(ModelFidelity fidelity, std::complex<double> s, double stiffening) {
  const auto series = [](std::complex<double> a, std::complex<double> b) { return a * b / (a + b); };
  const std::complex<double> hand = hand_N_s_per_m * s + stiffening * hand_N_per_m;
  const std::complex<double> linkage = 0.02 * s + 3950.0, cable = 3.6 * s + 39500.0;
  const std::complex<double> handle = 0.014 * s * s + hand;
  switch (fidelity) {
    case ModelFidelity::second_order:
      return 1.0 / ((0.0075 + 0.01075) * s * s + handle);
    case ModelFidelity::fourth_order:
      return 1.0 / ((0.0075 + 0.01075) * s * s + series(linkage, handle));
    default:
      return 1.0 / (0.0075 * s * s + series(cable, 0.01075 * s * s + series(linkage, handle)));
  }
}

std::complex<double> angular(double frequency_Hz) { return {0.0, 2.0 * std::numbers::pi * frequency_Hz}; }

constexpr double frequencies_Hz[] = {1.0, 3.0, 10.0, 30.0, 70.0, 74.5, 80.0, 100.0, 200.0, 300.0};

TEST(ModelFidelity, TheExactStepHasTheClosedFormResponseOfEachModelWithinOnePercent) {
  for (const ModelFidelity fidelity : linear_models) {
    for (const double frequency_Hz : frequencies_Hz) {
      // One tick from the force to the first sample that shows it; a held force is half a tick late of it.
      const auto shift = std::exp(angular(frequency_Hz) * (0.5 * tick_s));
      const auto measured = measured_response(Compliance{make(params(fidelity))}, frequency_Hz, tick_s) / shift;
      const auto expected = compliance(fidelity, angular(frequency_Hz), 10.0);
      EXPECT_LT(std::abs(measured - expected), 0.01 * std::abs(expected))
          << name_of(fidelity) << " " << frequency_Hz << " Hz";
    }
  }
}

TEST(ModelFidelity, TheEulerStepHasTheResponseOfForwardEulerInFiveSubstepsOfEachModel) {
  constexpr double substep_s = 40e-6;
  for (const ModelFidelity fidelity : linear_models) {
    for (const double frequency_Hz : frequencies_Hz) {
      // Forward Euler solves the equations at s = (z − 1)/h, and the force is held over five of its steps.
      const auto z = std::exp(angular(frequency_Hz) * substep_s);
      const auto held = (1.0 + z + z * z + z * z * z + z * z * z * z) / 5.0;
      const double expected = std::abs(compliance(fidelity, (z - 1.0) / substep_s, 10.0) * held);
      const double measured = std::abs(
          measured_response(Compliance{make(params(fidelity, CancellationStep::euler))}, frequency_Hz, tick_s));
      EXPECT_NEAR(measured, expected, 3e-3 * expected) << name_of(fidelity) << " " << frequency_Hz << " Hz";
    }
  }
}

/// Where a steady force of 1 N takes the motor.
double yields_m(const InducedMotionModel::Params& params) {
  InducedMotionModel model = make(params);
  for (int tick = 0; tick < 100000; ++tick) model.step({.motor_force_N = 1.0});
  return model.motor_position_m();
}

TEST(ModelFidelity, ASteadyForceYieldsTheSumOfTheCompliancesThatEachModelHas) {
  constexpr double hand = 1.0 / (10.0 * hand_N_per_m), linkage = 1.0 / 3950.0, cable = 1.0 / 39500.0;
  for (const CancellationStep step : both_steps) {
    for (const auto& [fidelity, expected_m] :
         {std::pair{ModelFidelity::second_order, hand}, std::pair{ModelFidelity::fourth_order, hand + linkage},
          std::pair{ModelFidelity::sixth_order_linear, hand + linkage + cable}}) {
      EXPECT_NEAR(yields_m(params(fidelity, step)), expected_m, 1e-9 * expected_m) << name_of(fidelity);
    }
  }
}

TEST(ModelFidelity, EachModelUnderestimatesTheSlowDeflectionOfTheChainAboutTenfold) {
  constexpr double chain_m = 1.0 / hand_N_per_m + 1.0 / 3950.0 + 1.0 / 39500.0;
  for (const ModelFidelity fidelity : {ModelFidelity::second_order, ModelFidelity::fourth_order,
                                       ModelFidelity::sixth_order_linear, ModelFidelity::sixth_order}) {
    const double factor = chain_m / yields_m(params(fidelity));
    EXPECT_GT(factor, 9.0) << name_of(fidelity);
    EXPECT_LT(factor, 12.0) << name_of(fidelity);
  }
}

TEST(ModelFidelity, AStifferHandChangesTheSlowMotionAndLeavesTheFast) {
  for (const ModelFidelity fidelity : linear_models) {
    const auto ratio = [fidelity](double frequency_Hz) {
      const auto gain = [&](double stiffening) {
        auto stiffened = params(fidelity);
        stiffened.master.linear_hand_stiffening = stiffening;
        return std::abs(measured_response(Compliance{make(stiffened)}, frequency_Hz, tick_s));
      };
      return gain(10.0) / gain(1.0);
    };
    // The hand's stiffness and damping are equal at 40/(2π 23) = 0.28 Hz, and at ten times that with the stiffer one.
    EXPECT_LT(ratio(0.1), 0.15) << name_of(fidelity);
    EXPECT_LT(ratio(2.8), 0.8) << name_of(fidelity);
    // From 8 Hz to the resonance the stiffer hand and the masses meet in a little more motion and not in less.
    EXPECT_LT(ratio(20.0), 1.08) << name_of(fidelity);
    for (const double frequency_Hz : {74.5, 100.0, 150.0}) {
      EXPECT_NEAR(ratio(frequency_Hz), 1.0, 0.02) << name_of(fidelity) << " " << frequency_Hz << " Hz";
    }
  }
}

/// A mass on a spring and a damper: where a force of 1 N since the time 0 has taken it.
struct Oscillator {
  double mass_kg, damping_N_s_per_m, stiffness_N_per_m;
  [[nodiscard]] double after_m(double time_s) const {
    if (time_s <= 0.0) return 0.0;
    const double decay = damping_N_s_per_m / (2.0 * mass_kg);
    const std::complex<double> root = std::sqrt(std::complex<double>(decay * decay - stiffness_N_per_m / mass_kg));
    const auto slow = -decay + root, fast = -decay - root;
    const auto transient = (slow * std::exp(fast * time_s) - fast * std::exp(slow * time_s)) / (fast - slow);
    return (1.0 + transient.real()) / stiffness_N_per_m;
  }
};

TEST(ModelFidelity, OneTickOfForceGivesTheSecondOrderModelTheImpulseResponseOfAMassOnASpring) {
  // With Table I's hand it creeps back; with the linkage's spring in the hand's place it rings.
  for (const auto& [stiffness, damping] : {std::pair{hand_N_per_m, hand_N_s_per_m}, std::pair{395.0, 2.8}}) {
    auto oscillating = params(ModelFidelity::second_order);
    oscillating.master.hand.stiffness_N_per_m = stiffness;
    oscillating.master.hand.damping_N_s_per_m = damping;
    const Oscillator oracle{0.0075 + 0.01075 + 0.014, damping, 10.0 * stiffness};
    InducedMotionModel model = make(oscillating);
    double largest_m = 0.0;
    for (int tick = 1; tick <= 2000; ++tick) {
      model.step({.motor_force_N = tick == 1 ? 1.0 : 0.0});
      const double expected_m = oracle.after_m(tick * tick_s) - oracle.after_m((tick - 1) * tick_s);
      largest_m = std::max(largest_m, std::fabs(expected_m));
      ASSERT_NEAR(model.motor_position_m(), expected_m, 1e-9 * largest_m) << tick;
    }
  }
}

double either(std::mt19937_64& engine) { return std::uniform_real_distribution<double>(-1.0, 1.0)(engine); }

TEST(ModelFidelity, MassesOnARigidLinkHaveEqualStatesBitForBit) {
  for (const CancellationStep step : both_steps) {
    InducedMotionModel second = make(params(ModelFidelity::second_order, step));
    InducedMotionModel fourth = make(params(ModelFidelity::fourth_order, step));
    std::mt19937_64 engine(3);
    for (int tick = 0; tick < 20000; ++tick) {
      const InducedMotionModel::Input input{.motor_force_N = either(engine), .intended_velocity_m_per_s = 0.0};
      second.step(input);
      fourth.step(input);
      for (const std::size_t row : {std::size_t{0}, std::size_t{3}}) {
        ASSERT_EQ(second.state()[row], second.state()[row + 1]) << name_of(step);
        ASSERT_EQ(second.state()[row], second.state()[row + 2]) << name_of(step);
        ASSERT_EQ(fourth.state()[row], fourth.state()[row + 1]) << name_of(step);
        ASSERT_NE(fourth.state()[row], fourth.state()[row + 2]) << name_of(step);
      }
    }
  }
}

TEST(ModelFidelity, InALinearModelForcesAddUpToRounding) {
  for (const ModelFidelity fidelity : linear_models) {
    for (const CancellationStep step : both_steps) {
      InducedMotionModel one = make(params(fidelity, step)), other = one, both = one;
      std::mt19937_64 engine(5);
      double largest_m = 0.0;
      for (int tick = 0; tick < 20000; ++tick) {
        const double a_N = either(engine), b_N = 1e-3 * either(engine);
        one.step({.motor_force_N = a_N});
        other.step({.motor_force_N = b_N});
        both.step({.motor_force_N = a_N - 7.0 * b_N});
        const double sum_m = one.motor_position_m() - 7.0 * other.motor_position_m();
        largest_m = std::max(largest_m, std::fabs(sum_m));
        ASSERT_NEAR(both.motor_position_m(), sum_m, 1e-12 * largest_m) << name_of(fidelity) << " " << name_of(step);
      }
    }
  }
}

TEST(ModelFidelity, TheSixthOrderModelIsNotLinear) {
  InducedMotionModel one = make(params(ModelFidelity::sixth_order)), twice = one;
  for (int tick = 0; tick < 100; ++tick) {
    one.step({.motor_force_N = 0.1});
    twice.step({.motor_force_N = 0.2});
  }
  EXPECT_GT(std::fabs(twice.motor_position_m() - 2.0 * one.motor_position_m()), 0.02 * twice.motor_position_m());
}

TEST(ModelFidelity, ALinearModelHasNoFrictionAndDoesNotSeeTheHandMove) {
  for (const ModelFidelity fidelity : linear_models) {
    for (const CancellationStep step : both_steps) {
      auto rubbing = params(fidelity, step), smooth = rubbing;
      rubbing.master.motor.friction_N = 5.0;
      smooth.master.motor.friction_N = smooth.master.drum.friction_N = 0.0;
      smooth.friction = ModelFriction::at_rest;
      InducedMotionModel a = make(rubbing), b = make(smooth);
      std::mt19937_64 engine(7);
      for (int tick = 0; tick < 5000; ++tick) {
        const double force_N = either(engine);
        a.step({.motor_force_N = force_N, .intended_velocity_m_per_s = either(engine)});
        b.step({.motor_force_N = force_N});
        ASSERT_EQ(a.state(), b.state()) << name_of(fidelity) << " " << name_of(step);
      }
    }
  }
}

TEST(ModelFidelity, SixthOrderLinearIsSixthOrderWithoutFrictionHysteresisAndQuinticOnAStifferHand) {
  for (const CancellationStep step : both_steps) {
    auto bared = params(ModelFidelity::sixth_order, step);
    bared.master.motor.friction_N = bared.master.drum.friction_N = 0.0;
    bared.master.linkage.hysteretic_fraction = 0.0;
    bared.master.hand.quintic_stiffness_N_per_m5 = 0.0;
    bared.master.hand.stiffness_N_per_m = 10.0 * hand_N_per_m;
    InducedMotionModel full = make(bared), linear = make(params(ModelFidelity::sixth_order_linear, step));
    std::mt19937_64 engine(11);
    for (int tick = 0; tick < 5000; ++tick) {
      const InducedMotionModel::Input input{.motor_force_N = either(engine), .intended_velocity_m_per_s = 0.1};
      full.step(input);
      linear.step(input);
      for (std::size_t i = 0; i < 6; ++i) ASSERT_NEAR(full.state()[i], linear.state()[i], 1e-12) << name_of(step);
    }
  }
}

TEST(ModelFidelity, ARigidCableIsNeverTooStiffForForwardEuler) {
  auto stiff = params(ModelFidelity::sixth_order_linear, CancellationStep::euler);
  stiff.master.cable.stiffness_N_per_m = 1e9;
  const auto refused = InducedMotionModel::make(stiff, Seconds{tick_s});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "step");
  for (const ModelFidelity fidelity : {ModelFidelity::second_order, ModelFidelity::fourth_order}) {
    stiff.fidelity = fidelity;
    EXPECT_TRUE(InducedMotionModel::make(stiff, Seconds{tick_s})) << name_of(fidelity);
  }
}

TEST(ModelFidelity, AHandMadeSofterThanItIsIsRefused) {
  auto soft = params(ModelFidelity::fourth_order);
  soft.master.linear_hand_stiffening = 0.5;
  const auto refused = InducedMotionModel::make(soft, Seconds{tick_s});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "master.linear_hand_stiffening");
}

}  // namespace model_fidelity_test
}  // namespace tactus::control
