// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/model/induced_motion_model.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/mechanics/reference_chain.hpp"
#include "tests/oracle_table.hpp"
#include "tests/signal/frequency_response.hpp"
#include <gtest/gtest.h>

namespace tactus::control {
namespace induced_motion_model_test {

static_assert(Element<InducedMotionModel>);

constexpr double tick_s = 200e-6;
constexpr CancellationStep both_steps[] = {CancellationStep::exact, CancellationStep::euler};
constexpr ModelFriction both_frictions[] = {ModelFriction::at_rest, ModelFriction::total_velocity};

InducedMotionModel::Params params(CancellationStep step, ModelFriction friction = ModelFriction::at_rest) {
  InducedMotionModel::Params made;
  made.master.linkage.hysteretic_fraction = 0.0;
  made.step = step;
  made.friction = friction;
  return made;
}

InducedMotionModel::Params frictionless(CancellationStep step, ModelFriction friction = ModelFriction::at_rest) {
  InducedMotionModel::Params made = params(step, friction);
  made.master.motor.friction_N = 0.0;
  made.master.drum.friction_N = 0.0;
  return made;
}

InducedMotionModel make(const InducedMotionModel::Params& params) {
  return InducedMotionModel::make(params, Seconds{tick_s}).value();
}

/// Only the linear part, as an element from force to position.
struct LinearModel {
  InducedMotionModel model;
  explicit LinearModel(CancellationStep step) : model(make(linear(step))) {}
  double step(double force_N) { return model.step({.motor_force_N = force_N}); }
  void reset() { model.reset(); }
  static InducedMotionModel::Params linear(CancellationStep step) {
    InducedMotionModel::Params params = frictionless(step);
    params.master.hand.quintic_stiffness_N_per_m5 = 0.0;
    return params;
  }
};

/// Paper A's Table I once more.
ReferenceChain table_one() {
  ReferenceChain reference;
  reference.grip_N_per_m = 40.0;
  reference.grip_N_s_per_m = 23.0;
  return reference;
}

double gain(CancellationStep step, double frequency_Hz) {
  return std::abs(measured_response(LinearModel(step), frequency_Hz, tick_s));
}

TEST(InducedMotionModel, TheLinearPartHasTheMagnitudesOfPaperAsTable) {
  struct Point {
    double frequency_Hz, gain_m_per_N, last_digit;
  };
  for (const auto& [frequency_Hz, expected, digit] :
       {Point{1.0, 6.8e-3, 1e-4}, Point{10.0, 7.6e-4, 1e-5}, Point{70.0, 7.1e-4, 1e-5}, Point{100.0, 3.0e-4, 1e-5},
        Point{200.0, 3.3e-5, 1e-6}}) {
    EXPECT_NEAR(gain(CancellationStep::exact, frequency_Hz), expected, 0.5 * digit + 0.01 * expected) << frequency_Hz;
  }
}

TEST(InducedMotionModel, TheExactStepHasTheClosedFormResponseAtEveryFrequency) {
  for (const double frequency_Hz : {1.0, 10.0, 50.0, 70.0, 74.5, 80.0, 100.0, 200.0, 300.0}) {
    // A force that is held for a tick has lost this much of a sine.
    const double x = std::numbers::pi * frequency_Hz * tick_s;
    const double expected = table_one().gain(frequency_Hz) * std::sin(x) / x;
    EXPECT_NEAR(gain(CancellationStep::exact, frequency_Hz), expected, 2e-3 * expected) << frequency_Hz;
    EXPECT_NEAR(gain(CancellationStep::exact, frequency_Hz), table_one().gain(frequency_Hz), 0.01 * expected);
  }
}

/// What forward Euler in substeps of `h` makes of the closed form: it solves the equations at s = (z − 1)/h.
double euler_gain(double frequency_Hz, double h, int substeps) {
  const std::complex<double> z = std::polar(1.0, 2.0 * std::numbers::pi * frequency_Hz * h);
  std::complex<double> hold = 0.0;
  for (int i = 0; i < substeps; ++i) hold += std::pow(z, i) / static_cast<double>(substeps);
  return std::abs(table_one().compliance((z - 1.0) / h) * hold);
}

TEST(InducedMotionModel, TheEulerStepHasTheResponseOfForwardEulerInFiveSubsteps) {
  for (const double frequency_Hz : {1.0, 10.0, 50.0, 70.0, 74.5, 80.0, 100.0, 200.0, 300.0}) {
    const double expected = euler_gain(frequency_Hz, 40e-6, 5);
    EXPECT_NEAR(gain(CancellationStep::euler, frequency_Hz), expected, 3e-3 * expected) << frequency_Hz;
  }
}

TEST(InducedMotionModel, EulerMeetsTheClosedFormToOnePercentSaveAtTheResonanceThatItDampsTooLittle) {
  for (const double frequency_Hz : {1.0, 10.0, 50.0, 200.0}) {
    const double expected = table_one().gain(frequency_Hz);
    EXPECT_NEAR(gain(CancellationStep::euler, frequency_Hz), expected, 0.01 * expected) << frequency_Hz;
  }
  // Forward Euler takes ω² h m of its damping away from a mode.
  for (const auto& [frequency_Hz, excess] : {std::pair{70.0, 0.035}, std::pair{74.5, 0.050}, std::pair{100.0, 0.020}}) {
    const double ratio = gain(CancellationStep::euler, frequency_Hz) / table_one().gain(frequency_Hz);
    EXPECT_NEAR(ratio, 1.0 + excess, 0.005) << frequency_Hz;
  }
}

TEST(InducedMotionModel, TheResponsePeaksBetween74And75Hz) {
  for (const CancellationStep step : both_steps) {
    double peak = 0.0, peak_Hz = 0.0;
    for (double frequency_Hz = 70.0; frequency_Hz <= 80.0; frequency_Hz += 0.5) {
      const double here = gain(step, frequency_Hz);
      if (here > peak) {
        peak = here;
        peak_Hz = frequency_Hz;
      }
    }
    EXPECT_GE(peak_Hz, 74.0) << name_of(step);
    EXPECT_LE(peak_Hz, 75.0) << name_of(step);
  }
}

/// Deflection at which 40 N/m and 3.125e13 N/m⁵ balance a force.
double balanced_deflection_m(double force_N) {
  double x = 2e-3;
  for (int i = 0; i < 50; ++i) {
    x -= (40.0 * x + 3.125e13 * std::pow(x, 5) - force_N) / (40.0 + 5.0 * 3.125e13 * std::pow(x, 4));
  }
  return x;
}

TEST(InducedMotionModel, ADisplayedForceOf1NMovesTheHandOfTheModelNoFurtherThan2MillimetresAtRest) {
  for (const CancellationStep step : both_steps) {
    InducedMotionModel model = make(params(step));
    double furthest_m = 0.0;
    for (int tick = 0; tick < 25000; ++tick) {
      model.step({.motor_force_N = -1.0});
      if (tick * tick_s > 0.05) furthest_m = std::max(furthest_m, std::fabs(model.state()[2]));
    }
    EXPECT_LT(furthest_m, 2e-3) << name_of(step);
    EXPECT_NEAR(model.state()[2], -2e-3, 0.05 * 2e-3) << name_of(step);
  }
}

TEST(InducedMotionModel, WithoutFrictionASteadyForceIsBalancedByEverySpring) {
  for (const CancellationStep step : both_steps) {
    for (const double force_N : {0.05, 0.5, 1.0}) {
      InducedMotionModel model = make(frictionless(step));
      for (int tick = 0; tick < 50000; ++tick) model.step({.motor_force_N = force_N});
      const double hand_m = balanced_deflection_m(force_N);
      EXPECT_NEAR(model.state()[2], hand_m, 1e-6 * hand_m) << name_of(step);
      EXPECT_NEAR(model.motor_position_m(), hand_m + force_N * (1.0 / 3950.0 + 1.0 / 39500.0), 1e-6 * hand_m);
    }
  }
}

/// RMS error of the motor's position over the run `name` of the oracle.
double error_m(CancellationStep step, const OracleTable& table, const std::string& name, double intended_m_per_s) {
  const auto forces_N = table.column("motor_force_N");
  const auto motor_m = table.column(name + "_motor_m");
  InducedMotionModel model = make(params(step, ModelFriction::total_velocity));
  double sum = 0.0;
  for (std::size_t tick = 0; tick < forces_N.size(); ++tick) {
    const double difference_m = model.motor_position_m() - motor_m[tick];
    sum += difference_m * difference_m;
    model.step({.motor_force_N = forces_N[tick], .intended_velocity_m_per_s = intended_m_per_s});
  }
  return std::sqrt(sum / static_cast<double>(forces_N.size()));
}

TEST(InducedMotionModel, UnderImpactsTheExactStepHasAtMostFourTenthsOfTheErrorOfEulerAgainstScipy) {
  const OracleTable table("control_induced_motion");
  for (const auto& [name, intended_m_per_s] :
       {std::pair{"rest", 0.0}, std::pair{"slow", 0.002}, std::pair{"fast", -0.05}}) {
    const double exact_m = error_m(CancellationStep::exact, table, name, intended_m_per_s);
    const double euler_m = error_m(CancellationStep::euler, table, name, intended_m_per_s);
    EXPECT_LT(exact_m, 0.4 * euler_m) << name;
    EXPECT_LT(euler_m, 4e-6) << name;
  }
}

TEST(InducedMotionModel, AForceBelowTheMotorsFrictionMovesNothing) {
  for (const CancellationStep step : both_steps) {
    for (const ModelFriction friction : both_frictions) {
      for (const double force_N : {0.00123, -0.007, 0.0099999}) {
        InducedMotionModel model = make(params(step, friction));
        for (int tick = 0; tick < 20000; ++tick) model.step({.motor_force_N = force_N});
        for (const double value : model.state()) EXPECT_EQ(value, 0.0) << name_of(step);
      }
    }
  }
}

TEST(InducedMotionModel, AForceThatIsNoNumberIsNotTakenForFriction) {
  for (const CancellationStep step : both_steps) {
    for (const ModelFidelity fidelity : {ModelFidelity::fourth_order, ModelFidelity::sixth_order}) {
      InducedMotionModel::Params lost = params(step);
      lost.fidelity = fidelity;
      InducedMotionModel model = make(lost);
      model.step({.motor_force_N = std::numeric_limits<double>::quiet_NaN()});
      for (int tick = 0; tick < 10; ++tick) model.step({.motor_force_N = 0.5});
      EXPECT_TRUE(std::isnan(model.motor_position_m())) << name_of(step) << " " << name_of(fidelity);
      model.reset();
      EXPECT_TRUE(std::isfinite(model.step({.motor_force_N = 0.5}))) << name_of(step);
    }
  }
}

TEST(InducedMotionModel, AForceThatRisesToJustBelowBothFrictionsOnlyStretchesTheCableAndDoesNotCreep) {
  for (const CancellationStep step : both_steps) {
    InducedMotionModel model = make(params(step));
    constexpr double most_N = 0.999 * (0.01 + 0.0144);
    constexpr int ticks = 20000;
    for (int tick = 0; tick <= ticks; ++tick) model.step({.motor_force_N = most_N * tick / ticks});
    const double drum_m = model.state()[1];
    // A thousandth of an encoder count; without friction this force would move the drum by 0.6 mm.
    EXPECT_NEAR(drum_m, 0.0, 1e-8) << name_of(step);
    EXPECT_NEAR(model.motor_position_m() - drum_m, (most_N - 0.01) / 39500.0, 1e-3 * 3.62e-7) << name_of(step);
    for (int tick = 0; tick < 50000; ++tick) model.step({.motor_force_N = most_N});
    EXPECT_NEAR(model.state()[1], drum_m, 1e-12) << name_of(step);
  }
}

/// A force like an impact and a hand in motion, both arbitrary.
InducedMotionModel::Input arbitrary(std::mt19937_64& engine, double speed_m_per_s) {
  std::uniform_real_distribution<double> either(-1.0, 1.0);
  return {.motor_force_N = either(engine), .intended_velocity_m_per_s = speed_m_per_s * either(engine)};
}

TEST(InducedMotionModel, NoForceGivesNoMotionWhateverTheHandDoes) {
  const double edges[] = {0.0, 1e9, -1e9, 0.005, -0.005, std::nextafter(0.005, 1.0), 5e-324, -5e-324, 1e308};
  for (const CancellationStep step : both_steps) {
    InducedMotionModel model = make(params(step, ModelFriction::total_velocity));
    std::mt19937_64 engine(5);
    for (int tick = 0; tick < 20000; ++tick) {
      InducedMotionModel::Input input = arbitrary(engine, std::pow(10.0, static_cast<double>(engine() % 7) - 5.0));
      input.motor_force_N = 0.0;
      if (engine() % 8 == 0) input.intended_velocity_m_per_s = edges[engine() % std::size(edges)];
      model.step(input);
      for (const double value : model.state()) ASSERT_EQ(value, 0.0) << name_of(step) << ", tick " << tick;
    }
  }
}

TEST(InducedMotionModel, AFastHandLeavesNoFrictionForTheForceToOvercome) {
  for (const CancellationStep step : both_steps) {
    InducedMotionModel model = make(params(step, ModelFriction::total_velocity));
    InducedMotionModel smooth = make(frictionless(step));
    std::mt19937_64 engine(9);
    for (int tick = 0; tick < 5000; ++tick) {
      const double force_N = arbitrary(engine, 0.0).motor_force_N;
      model.step({.motor_force_N = force_N, .intended_velocity_m_per_s = tick < 2500 ? 10.0 : -10.0});
      smooth.step({.motor_force_N = force_N});
      ASSERT_EQ(model.state(), smooth.state()) << name_of(step) << ", tick " << tick;
    }
  }
}

TEST(InducedMotionModel, WithAHandAtRestBothKindsOfFrictionAreTheSameBitForBit) {
  for (const CancellationStep step : both_steps) {
    InducedMotionModel total = make(params(step, ModelFriction::total_velocity));
    InducedMotionModel rest = make(params(step, ModelFriction::at_rest));
    std::mt19937_64 engine(11);
    for (int tick = 0; tick < 5000; ++tick) {
      InducedMotionModel::Input input = arbitrary(engine, 1.0);
      rest.step(input);
      input.intended_velocity_m_per_s = 0.0;
      total.step(input);
      ASSERT_EQ(total.state(), rest.state()) << name_of(step) << ", tick " << tick;
    }
  }
}

TEST(InducedMotionModel, MirroredForceAndHandGiveTheMirroredMotionBitForBit) {
  for (const CancellationStep step : both_steps) {
    for (const ModelFriction friction : both_frictions) {
      InducedMotionModel one = make(params(step, friction));
      InducedMotionModel other = one;
      std::mt19937_64 engine(13);
      for (int tick = 0; tick < 5000; ++tick) {
        const auto input = arbitrary(engine, 0.02);
        one.step(input);
        other.step(
            {.motor_force_N = -input.motor_force_N, .intended_velocity_m_per_s = -input.intended_velocity_m_per_s});
        for (std::size_t i = 0; i < 6; ++i) ASSERT_EQ(one.state()[i], -other.state()[i]) << name_of(step);
      }
    }
  }
}

TEST(InducedMotionModel, ForwardEulerIsRefusedWhereTheCableIsStifferThanItsDampingOverTheSubstep) {
  // A mode of stiffness k and damping b is stable under forward Euler up to h = b/k: the cable's 91 µs.
  InducedMotionModel::Params stiff = params(CancellationStep::euler);
  const double limit_N_per_m = stiff.master.cable.damping_N_s_per_m / InducedMotionModel::euler_substep_s;
  stiff.master.cable.stiffness_N_per_m = 0.93 * limit_N_per_m;
  EXPECT_TRUE(InducedMotionModel::make(stiff, Seconds{tick_s}));
  for (const double stiffness : {1.07 * limit_N_per_m, 1e9}) {
    stiff.master.cable.stiffness_N_per_m = stiffness;
    stiff.step = CancellationStep::euler;
    const auto refused = InducedMotionModel::make(stiff, Seconds{tick_s});
    ASSERT_FALSE(refused) << stiffness;
    EXPECT_EQ(refused.error().parameter, "step");
    stiff.step = CancellationStep::exact;
    EXPECT_TRUE(InducedMotionModel::make(stiff, Seconds{tick_s})) << stiffness;
  }
}

TEST(InducedMotionModel, AForceOnTheHandleMovesTheMotorAsOneOnTheMotorMovesTheHandle) {
  // Maxwell and Betti: what is linear and has no gyroscope answers alike both ways.
  for (const CancellationStep step : both_steps) {
    InducedMotionModel at_motor = make(LinearModel::linear(step)), at_handle = at_motor;
    for (int tick = 0; tick < 500; ++tick) {
      const double force_N = tick % 37 < 12 ? 1.0 : -0.4;
      at_motor.step({.motor_force_N = force_N});
      at_handle.step({.handle_force_N = force_N});
      EXPECT_NEAR(at_handle.motor_position_m(), at_motor.state()[2], 1e-12) << name_of(step) << " " << tick;
    }
    EXPECT_GT(std::fabs(at_handle.motor_position_m()), 1e-4);
  }
}

TEST(InducedMotionModel, ForwardEulerIsRefusedWithoutAHandThatDampsTheLinkage) {
  InducedMotionModel::Params loose = params(CancellationStep::euler);
  loose.master.hand.damping_N_s_per_m = 0.0;
  const auto refused = InducedMotionModel::make(loose, Seconds{tick_s});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "step");
}

TEST(InducedMotionModel, AfterAnAbsurdForceItComesBackToRest) {
  for (const CancellationStep step : both_steps) {
    InducedMotionModel model = make(params(step));
    for (int tick = 0; tick < 250; ++tick) {
      model.step({.motor_force_N = tick % 100 < 50 ? 1e6 : -3e6});
      for (const double value : model.state()) ASSERT_TRUE(std::isfinite(value));
    }
    for (int tick = 0; tick < 100000; ++tick) model.step({});
    // Friction can hold no more than 0.0244 N against 40 N/m.
    EXPECT_LT(std::fabs(model.motor_position_m()), 0.0244 / 40.0) << name_of(step);
    EXPECT_NEAR(model.state()[3], 0.0, 1e-6) << name_of(step);
  }
}

}  // namespace induced_motion_model_test
}  // namespace tactus::control
