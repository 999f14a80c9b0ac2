// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architectures/position_force.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::control {
namespace position_force_test {

static_assert(Element<PositionForceMaster>);
static_assert(Element<PositionForceSlave>);

constexpr double tick_s = 200e-6;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

PositionForceMaster master(const PositionForceMaster::Params& params) {
  return PositionForceMaster::make(params, Seconds{tick_s}).value();
}

MasterSite gated(const PositionForceMaster::Params& params, const SafetyGate::Params& gate) {
  return {master_controller(master(params)), SafetyGate::make(gate, Seconds{tick_s}).value()};
}

PositionForceMaster::Params plain() {
  PositionForceMaster::Params params;
  params.model.linkage.hysteretic_fraction = 0.0;
  params.cancellation = CancellationMode::off;
  return params;
}

PositionForceMaster::Input input(double position_m, double tip_force_N) {
  return {.motor_position_m = position_m, .arrival = {.message = {.force_N = tip_force_N}, .fresh = true}};
}

TEST(PositionForceMaster, WithoutCancellationTheCommandIsLambdaTimesTheMeasuredPosition) {
  PositionForceMaster::Params params = plain();
  params.position_scale = 0.25;
  PositionForceMaster site = master(params);
  for (int tick = 0; tick < 1000; ++tick) {
    const double position_m = 0.03 * std::sin(0.01 * tick);
    const auto out = site.step(input(position_m, 0.4));
    ASSERT_EQ(out.message.position_m, 0.25 * position_m);
  }
}

TEST(PositionForceMaster, DisplaysMuTimesTheTipForceAgainstTheHandUpToTheLimit) {
  PositionForceMaster::Params params = plain();
  params.force_gain = 3.0;
  params.force_limit_N = 1.5;
  PositionForceMaster site = master(params);
  for (const double tip_force_N : {0.0, 0.1, 0.49, 0.5, 0.51, 40.0, -0.2, -9.0, 1e300}) {
    const auto out = site.step(input(0.0, tip_force_N));
    const double expected_N = tip_force_N >= 0.5 ? 1.5 : tip_force_N <= -0.5 ? -1.5 : 3.0 * tip_force_N;
    EXPECT_DOUBLE_EQ(out.motor_force_N, -expected_N);
  }
}

/// A plant that SciPy integrated, displaced by the forces that the master displays to it.
struct Displaced {
  std::vector<double> force_N, induced_m;
  Displaced() {
    const OracleTable table("control_induced_motion");
    force_N = table.column("motor_force_N");
    induced_m = table.column("rest_motor_m");
  }
};

TEST(PositionForceMaster, WithCancellationTheCommandIsLambdaTimesWhatThePersonMeant) {
  const Displaced plant;
  for (const CancellationMode mode : {CancellationMode::on, CancellationMode::off}) {
    PositionForceMaster::Params params;
    params.model.linkage.hysteretic_fraction = 0.0;
    params.cancellation = mode;
    params.cancellation_friction = ModelFriction::at_rest;
    params.position_scale = 2.0;
    params.force_gain = 5.0;
    PositionForceMaster site = master(params);
    for (std::size_t tick = 0; tick < plant.force_N.size(); ++tick) {
      const double meant_m = 1e-3 * std::sin(0.002 * static_cast<double>(tick));
      const double measured_m = meant_m + plant.induced_m[tick];
      const auto out = site.step(input(measured_m, -plant.force_N[tick] / 5.0));
      ASSERT_NEAR(out.motor_force_N, plant.force_N[tick], 1e-15);
      ASSERT_NEAR(out.induced_position_m, plant.induced_m[tick], 2e-6);
      ASSERT_NEAR(out.intended_position_m, meant_m, 2e-6);
      if (mode == CancellationMode::on) {
        ASSERT_NEAR(out.message.position_m, 2.0 * meant_m, 4e-6);
      } else {
        ASSERT_EQ(out.message.position_m, 2.0 * measured_m);
      }
    }
  }
}

TEST(PositionForceMaster, TheModelIsDrivenByTheForceThatTheGateLetThrough) {
  PositionForceMaster::Params params;
  params.model.linkage.hysteretic_fraction = 0.0;
  MasterSite site = gated(params, {.force_limit_N = 0.3, .rate_limit_N_per_s = 50.0});
  InducedMotionModel reference = InducedMotionModel::make({.master = params.model}, Seconds{tick_s}).value();
  for (int tick = 0; tick < 500; ++tick) {
    // With the command held where the model says, the intended position stays at zero and so does its velocity.
    const auto out = site.step(input(reference.motor_position_m(), tick % 100 < 50 ? 2.0 : -1.0));
    ASSERT_LE(std::fabs(out.motor_force_N), 0.3);
    ASSERT_EQ(out.induced_position_m, reference.motor_position_m());
    reference.step({.motor_force_N = out.motor_force_N});
  }
}

TEST(PositionForceMaster, CancelsWithTheModelThatTheKeyNames) {
  for (const auto& [name, fidelity] :
       {std::pair{"second-order", ModelFidelity::second_order}, std::pair{"fourth-order", ModelFidelity::fourth_order},
        std::pair{"sixth-order-linear", ModelFidelity::sixth_order_linear},
        std::pair{"sixth-order", ModelFidelity::sixth_order}}) {
    EXPECT_STREQ(name_of(fidelity), name);
    PositionForceMaster::Params params;
    params.cancellation_model = fidelity;
    PositionForceMaster site = master(params);
    InducedMotionModel reference =
        InducedMotionModel::make({.master = params.model, .fidelity = fidelity}, Seconds{tick_s}).value();
    for (int tick = 0; tick < 500; ++tick) {
      // With the command held where the model says, the intended position stays at zero and so does its velocity.
      const auto out = site.step(input(reference.motor_position_m(), tick % 100 < 50 ? 0.9 : -0.4));
      ASSERT_EQ(out.message.position_m, 0.0) << name << ", tick " << tick;
      reference.step({.motor_force_N = out.motor_force_N});
    }
  }
}

TEST(PositionForceMaster, ATipForceThatIsNoNumberTakesTheForceToZeroAtTheRateLimitUntilReset) {
  MasterSite site = gated(plain(), {.rate_limit_N_per_s = 500.0});
  for (int tick = 0; tick < 20; ++tick) site.step(input(0.01, 0.8));
  EXPECT_EQ(site.fault(), GateFault::none);
  for (int tick = 1; tick <= 50; ++tick) {
    const double position_m = 0.01 + 1e-4 * tick;
    const auto out = site.step(input(position_m, tick == 1 ? not_a_number : 0.8));
    EXPECT_NEAR(out.motor_force_N, -std::max(0.0, 0.8 - 0.1 * tick), 1e-12);
    EXPECT_EQ(out.message.position_m, position_m);
    EXPECT_EQ(site.fault(), GateFault::not_finite);
  }
  site.reset();
  EXPECT_EQ(site.fault(), GateFault::none);
  EXPECT_NEAR(site.step(input(0.01, 0.05)).motor_force_N, -0.05, 1e-15);
}

TEST(PositionForceMaster, AfterAFaultTheCancelledCommandStaysFiniteAndComesBackToTheMeasuredPosition) {
  MasterSite site = gated({}, {});
  for (int tick = 0; tick < 500; ++tick) site.step(input(0.01, 0.8));
  for (int tick = 0; tick < 25000; ++tick) {
    const auto out = site.step(input(0.01, not_a_number));
    ASSERT_TRUE(std::isfinite(out.message.position_m));
  }
  // What friction can hold: 0.0244 N on 40 N/m.
  EXPECT_NEAR(site.step(input(0.01, 0.0)).message.position_m, 0.01, 0.0244 / 40.0);
}

TEST(PositionForceMaster, AnUnstableModelIsRefusedUnderTheNameOfItsStep) {
  PositionForceMaster::Params params;
  params.model.linkage.hysteretic_fraction = 0.0;
  params.cancellation_step = CancellationStep::euler;
  params.model.cable.stiffness_N_per_m = 1e9;
  const auto refused = PositionForceMaster::make(params, Seconds{tick_s});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().parameter, "cancellation_step");
}

PositionForceSlave slave(const PositionForceSlave::Params& params) {
  return PositionForceSlave::make(params, Seconds{tick_s}).value();
}

SlaveSite gated(const SafetyGate::Params& gate) {
  return {slave_controller(slave({})), SafetyGate::make(gate, Seconds{tick_s}).value()};
}

PositionForceSlave::Input input(double command_m, double position_m, double tip_force_N) {
  return {.motor_position_m = position_m,
          .tip_force_N = tip_force_N,
          .arrival = {.message = {.position_m = command_m}, .fresh = true}};
}

TEST(PositionForceSlave, AConstantErrorIsAnsweredInProportionFromTheFirstSample) {
  PositionForceSlave site = slave({});
  for (int tick = 0; tick < 100; ++tick) {
    EXPECT_NEAR(site.step(input(0.012, 0.010, 0.0)).motor_force_N, 100.0 * 0.002, 1e-12);
  }
}

TEST(PositionForceSlave, AnErrorThatGrowsSteadilyAddsItsRateTimesTheDerivativeGain) {
  PositionForceSlave site = slave({});
  constexpr double rate_m_per_s = 0.1;
  double force_N = 0.0, error_m = 0.0;
  for (int tick = 0; tick < 200; ++tick) {
    error_m = rate_m_per_s * tick_s * tick;
    force_N = site.step(input(2.0 * error_m, error_m, 0.0)).motor_force_N;
  }
  EXPECT_NEAR(force_N, 100.0 * error_m + 0.65 * rate_m_per_s, 1e-9);
}

TEST(PositionForceSlave, PullsTowardTheCommandFromEitherSideAndNoHarderThanItsGate) {
  for (const double way : {-1.0, 1.0}) {
    SlaveSite site = gated({.force_limit_N = 3.0, .rate_limit_N_per_s = 1e6});
    EXPECT_EQ(site.step(input(way * 0.5, 0.0, 0.0)).motor_force_N, way * 3.0);
  }
}

TEST(PositionForceSlave, SendsTheTipForceBackAsItWasMeasured) {
  PositionForceSlave site = slave({});
  for (const double tip_force_N : {0.0, -0.3, 12.5, 1e300}) {
    EXPECT_EQ(site.step(input(0.0, 0.0, tip_force_N)).message.force_N, tip_force_N);
  }
}

TEST(PositionForceSlave, ACommandThatIsNoNumberReleasesTheMotorUntilReset) {
  SlaveSite site = gated({.rate_limit_N_per_s = 500.0});
  for (int tick = 0; tick < 20; ++tick) site.step(input(0.01, 0.0, 0.0));
  for (int tick = 1; tick <= 30; ++tick) {
    const auto out = site.step(input(tick == 1 ? not_a_number : 0.01, 0.0, 0.2));
    EXPECT_NEAR(out.motor_force_N, std::max(0.0, 1.0 - 0.1 * tick), 1e-12);
    EXPECT_EQ(out.message.force_N, 0.2);
    EXPECT_EQ(site.fault(), GateFault::not_finite);
  }
  site.reset();
  EXPECT_EQ(site.fault(), GateFault::none);
  EXPECT_NEAR(site.step(input(0.0005, 0.0, 0.0)).motor_force_N, 0.05, 1e-12);
}

}  // namespace position_force_test
}  // namespace tactus::control
