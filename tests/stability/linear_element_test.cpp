// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/linear_element.hpp>
#include <tactus/analysis/stability/loop.hpp>
#include <tactus/kernel/mechanics/cable_chain.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>
#include <tests/stability/linear_rig.hpp>

namespace tactus::stability {
namespace {

TEST(LinearElement, ProbedSiteAnswersARandomSignalAsTheSiteItselfDoes) {
  simulation::Teleoperator::Params params = linear_rig();
  params.control.force_gain = 1.0;
  params.control.position_scale = 0.7;
  params.control.force_filter = {.kind = control::Shaping::notch, .frequency_Hz = 80.0, .notch_width_Hz = 40.0};
  params.control.command_filter = {.kind = control::Shaping::low_pass, .frequency_Hz = 150.0};
  params.control.damping.damping_N_s_per_m = 2.0;
  params.control.crossover.frequency_Hz = 60.0;
  params.control.hand_compensation_Hz = 150.0;
  const LinearSites sites = *linear_sites(params);
  auto site = *control::PositionForceMaster::make(params.control, Seconds{2e-4});
  auto servo = *control::ServoPd::make(params.control.slave, Seconds{2e-4});
  site.step({});
  servo.step(0.0);

  signal::Random random(7);
  Eigen::VectorXd master = Eigen::VectorXd::Zero(sites.master.states());
  Eigen::VectorXd slave = Eigen::VectorXd::Zero(sites.slave.states());
  double largest_N = 0.0, largest_m = 0.0, largest_servo_N = 0.0, worst_N = 0.0, worst_m = 0.0, worst_servo_N = 0.0;
  for (int tick = 0; tick < 2000; ++tick) {
    const Eigen::Vector2d input{1e-6 * random.normal(), 1e-2 * random.normal()};
    const auto said = site.step({.motor_position_m = input[0], .arrival = {.message = {.force_N = input[1]}}});
    const Eigen::VectorXd expected = sites.master.c * master + sites.master.d * input;
    master = (sites.master.a * master + sites.master.b * input).eval();
    worst_N = std::max(worst_N, std::fabs(said.motor_force_N - expected[motor_force_out]));
    worst_N = std::max(worst_N, std::fabs(said.handle_force_N - expected[handle_force_out]));
    worst_m = std::max(worst_m, std::fabs(said.message.position_m - expected[message_out]));
    largest_N = std::max(largest_N, std::fabs(said.motor_force_N));
    largest_m = std::max(largest_m, std::fabs(said.message.position_m));

    const double force_N = servo.step(input[0]);
    worst_servo_N =
        std::max(worst_servo_N, std::fabs(force_N - (sites.slave.c * slave)(0) - sites.slave.d(0) * input[0]));
    slave = (sites.slave.a * slave + sites.slave.b * input[0]).eval();
    largest_servo_N = std::max(largest_servo_N, std::fabs(force_N));
  }
  EXPECT_LE(worst_N, 1e-8 * largest_N);
  EXPECT_LE(worst_m, 1e-8 * largest_m);
  EXPECT_LE(worst_servo_N, 1e-8 * largest_servo_N);
}

TEST(LinearElement, WhatIsNotLinearIsFoundOut) {
  double state = 0.0;
  const auto squares = probe(2, [&state](double input) { return state = 0.9 * state + input - 0.1 * state * state; });
  EXPECT_FALSE(squares);
  // Three states where two were promised.
  double a = 0.0, b = 0.0, c = 0.0;
  const auto third = probe(2, [&](double input) {
    c += 0.1 * (b - c);
    b += 0.2 * (a - b);
    a += 0.3 * (input - a);
    return c;
  });
  EXPECT_FALSE(third);
}

TEST(LinearElement, SimulatedMechanismMovesAsItsLinearModel) {
  const simulation::Teleoperator::Params params = linear_rig();
  const double substep_s = 2e-6;
  auto chain = *mechanics::CableChain::make(params.master.mechanism, params.person.grip, Seconds{substep_s});
  const StateSpace device =
      linear_device(params.master.mechanism, {.bandwidth_Hz = 1e6}, 1000.0, params.person.grip, {});
  const StateSpace ticks = sampled(device, 2e-4, 0.0);
  Eigen::VectorXd state = Eigen::VectorXd::Zero(ticks.states());
  double worst_m = 0.0, largest_m = 0.0;
  for (int tick = 0; tick < 250; ++tick) {
    for (int i = 0; i < 100; ++i) chain.step({.motor_force_N = 1.0});
    state = (ticks.a * state + ticks.b.col(command_in)).eval();
    worst_m = std::max(worst_m, std::fabs(chain.tip_position_m() - (ticks.c * state)[tip_out]));
    largest_m = std::max(largest_m, std::fabs(chain.tip_position_m()));
  }
  EXPECT_LE(worst_m, 1e-3 * largest_m);
}

TEST(LinearElement, FrictionAsADamperTakesTheEnergyThatFrictionTakesInACycle) {
  // Of a motion of velocity amplitude V: Coulomb 4 f a a cycle, a damper c π a V.
  simulation::Teleoperator::Params params;
  const double speed = 0.05;
  const StateSpace with = linear_device(params.master.mechanism, params.master.amplifier, 1000.0,
                                        mechanics::nobody_holds, {.friction_speed_m_per_s = speed});
  const StateSpace without =
      linear_device(params.master.mechanism, params.master.amplifier, 1000.0, mechanics::nobody_holds, {});
  const double damper = (without.a(3, 3) - with.a(3, 3)) * params.master.mechanism.motor.mass_kg;
  const double amplitude_m = 1e-3;
  EXPECT_NEAR(damper * 3.14159265358979 * amplitude_m * speed,
              4.0 * params.master.mechanism.motor.friction_N * amplitude_m, 1e-12);
}

/// Fundamental of a motor's velocity, in m/s per N, that a force N sin ωt keeps up.
template <class Step>
std::complex<double> shaken(double force_N, double frequency_Hz, double dt_s, const Step& step) {
  const auto period = std::lround(1.0 / (frequency_Hz * dt_s));
  const auto angle = [period](long n) {
    return 2.0 * std::numbers::pi * static_cast<double>(n) / static_cast<double>(period);
  };
  std::complex<double> position;
  for (long n = 0; n < 40 * period; ++n) {
    // The position is that of the sample, before the force of this step acts.
    const double position_m = step(force_N * std::sin(angle(n)));
    if (n >= 30 * period) position += position_m * std::polar(1.0, -angle(n));
  }
  const std::complex<double> sine =
      position * std::complex<double>(0.0, 1.0) * 2.0 / (10.0 * static_cast<double>(period));
  return std::complex<double>(0.0, 2.0 * std::numbers::pi * frequency_Hz) * sine / force_N;
}

TEST(LinearElement, DescribingFunctionLeavesAQuarterAtMostOfWhatFrictionDoesToTheModel) {
  control::InducedMotionModel::Params params;
  params.master.linkage.hysteretic_fraction = 0.0;
  params.master.hand.quintic_stiffness_N_per_m5 = 0.0;
  const double tick_s = 2e-4, frequency_Hz = 50.0;
  for (const double force_N : {0.1, 0.3}) {
    auto model = *control::InducedMotionModel::make(params, Seconds{tick_s});
    const auto rubbing = shaken(force_N, frequency_Hz, tick_s, [&model](double force) {
      const double before_m = model.motor_position_m();
      model.step({.motor_force_N = force});
      return before_m;
    });
    const std::complex<double> z = std::polar(1.0, 2.0 * std::numbers::pi * frequency_Hz * tick_s);
    const std::complex<double> s{0.0, 2.0 * std::numbers::pi * frequency_Hz};
    const auto linear = probe_model(params, Seconds{tick_s}, {.friction_speed_m_per_s = force_N * std::abs(rubbing)});
    const auto smooth = probe_model(params, Seconds{tick_s});
    ASSERT_TRUE(linear && smooth);
    const std::complex<double> predicted = s * response(*linear, z)(0, 0);
    const std::complex<double> without = s * response(*smooth, z)(0, 0);
    EXPECT_LE(std::abs(rubbing - predicted), 0.25 * std::abs(rubbing - without)) << force_N;
    EXPECT_GE(std::abs(rubbing - without), 0.1 * std::abs(rubbing)) << "friction matters here";
  }
}

TEST(LinearElement, DescribingFunctionLeavesAQuarterAtMostOfWhatFrictionDoesToTheMaster) {
  const simulation::Teleoperator::Params rig = linear_rig();
  mechanics::CableChain::Params chain = rig.master.mechanism;
  chain.motor.friction_N = 0.02;
  chain.drum.friction_N = 0.03;
  const double step_s = 1e-5, frequency_Hz = 40.0, force_N = 0.3;
  auto device = *mechanics::CableChain::make(chain, rig.person.grip, Seconds{step_s});
  const auto rubbing = shaken(force_N, frequency_Hz, step_s, [&device](double force) {
    const double before_m = device.motor_position_m();
    device.step({.motor_force_N = force});
    return before_m;
  });
  const auto answer = [&](double speed_m_per_s) {
    const StateSpace linear =
        linear_device(chain, {.bandwidth_Hz = 1e6}, 1000.0, rig.person.grip, {.friction_speed_m_per_s = speed_m_per_s});
    const std::complex<double> s{0.0, 2.0 * std::numbers::pi * frequency_Hz};
    return s * response(linear, s)(motor_out, command_in);
  };
  EXPECT_LE(std::abs(rubbing - answer(force_N * std::abs(rubbing))), 0.25 * std::abs(rubbing - answer(0.0)));
  EXPECT_GE(std::abs(rubbing - answer(0.0)), 0.1 * std::abs(rubbing)) << "friction matters here";
}

TEST(LinearElement, ModelsLinkageIsStifferInSmallMotionAsTheDevicesIs) {
  control::InducedMotionModel::Params params;
  const auto shift = [&params](const Linearisation& linearisation) {
    const auto model = probe_model(params, Seconds{2e-4}, linearisation);
    return std::abs(response(*model, std::polar(1.0, 2.0 * std::numbers::pi * 120.0 * 2e-4))(0, 0));
  };
  const double reference = params.master.linkage.reference_deflection_m;
  EXPECT_NEAR(shift({.linkage_amplitude_m = reference}), shift({}), 1e-6 * shift({}));
  EXPECT_GT(std::fabs(shift({.linkage_amplitude_m = 1e-6}) / shift({}) - 1.0), 0.01);
}

TEST(LinearElement, WallIsFoundFromItsLaw) {
  mechanics::Environment::Params wall{.stiffness_N_per_m = 30000.0, .damping_N_s_per_m = 4.0};
  EXPECT_NEAR(wall_load(wall, 1.0).stiffness_N_per_m, 30000.0, 1e-3);
  EXPECT_NEAR(wall_load(wall, 1.0).damping_N_s_per_m, 4.0, 1e-6);
  wall = {.law = mechanics::ContactLaw::hunt_crossley,
          .stiffness_N_per_m = 30000.0,
          .exponent = 1.5,
          .dissipation_s_per_m = 0.4};
  // F = k δ^1.5 / √δ_ref at 3 N is δ = δ_ref; there dF/dδ = 1.5 k and the damping is F c.
  EXPECT_NEAR(wall_load(wall, 3.0).stiffness_N_per_m, 45000.0, 1.0);
  EXPECT_NEAR(wall_load(wall, 3.0).damping_N_s_per_m, 1.2, 1e-6);
}

TEST(LinearElement, LinkageIsStifferInSmallMotion) {
  simulation::Teleoperator::Params params;
  const auto coupling = [&params](double amplitude_m) {
    const StateSpace device = linear_device(params.master.mechanism, params.master.amplifier, 1000.0,
                                            mechanics::nobody_holds, {.linkage_amplitude_m = amplitude_m});
    return -device.a(5, 2) * params.master.mechanism.tip.mass_kg;
  };
  EXPECT_NEAR(coupling(0.0), 3950.0, 1e-9);
  EXPECT_NEAR(coupling(params.master.mechanism.linkage.reference_deflection_m), 3950.0, 1e-9);
  EXPECT_GT(coupling(1e-6), 3950.0);
}

}  // namespace
}  // namespace tactus::stability
