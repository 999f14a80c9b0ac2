// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/angle.hpp>
#include <tactus/analysis/stability/two_port.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cmath>
#include <complex>
#include <vector>

#include <gtest/gtest.h>
#include <tests/stability/linear_rig.hpp>

namespace tactus::stability {
namespace {

simulation::Teleoperator::Params uncancelled() {
  simulation::Teleoperator::Params params = linear_rig();
  params.control.cancellation = control::CancellationMode::off;
  params.control.force_gain = 3.0;
  params.control.position_scale = 0.5;
  return params;
}

TEST(TwoPort, SlowMotionSeesTheMassesTheGainsAndTheServo) {
  const simulation::Teleoperator::Params params = uncancelled();
  const TwoPort port = *TwoPort::make(params);
  const double omega = turn * 0.2;
  const HybridMatrix h = port.at(omega);
  const std::complex<double> s{0.0, omega};
  const auto& chain = params.master.mechanism;
  const double mass_kg = chain.motor.mass_kg + chain.drum.mass_kg + chain.tip.mass_kg;
  EXPECT_NEAR(std::abs(h.h11 / (s * mass_kg) - 1.0), 0.0, 1e-3);
  EXPECT_NEAR(std::abs(h.h12 - params.control.force_gain), 0.0, 0.01);
  EXPECT_NEAR(std::abs(h.h21 + params.control.position_scale), 0.0, 0.01);
  // The tip gives way as the servo does, and with it both links of the slave; those of the master give way to the
  // force.
  const double links = 1.0 / chain.cable.stiffness_N_per_m + 1.0 / chain.linkage.stiffness_N_per_m;
  const double reflected = params.control.position_scale * params.control.force_gain;
  const double compliance = 1.0 / params.control.slave.proportional_N_per_m + (1.0 + reflected) * links;
  EXPECT_NEAR(std::abs(h.h22 / (s * compliance) - 1.0), 0.0, 0.01);
}

TEST(TwoPort, HandThatMovesItsAimPressesABondedWallAsInTheSimulation) {
  // The aim goes in a sine; the grip, the two-port and the wall make the contact force of it.
  for (const double frequency_Hz : {10.0, 40.0, 100.0}) {
    simulation::Teleoperator::Params params = uncancelled();
    params.control.force_gain = 0.2;
    params.control.position_scale = 1.0;
    auto teleoperator = *simulation::Teleoperator::make(params, 0.0);
    const double tick_s = teleoperator.tick_s();
    const auto angle = [&](long tick) { return turn * frequency_Hz * tick_s * static_cast<double>(tick); };
    const auto aim_m = [&](long tick) { return 1e-6 * std::sin(angle(tick)); };
    std::complex<double> aim, contact;
    constexpr long ticks = 10000, settled = 5000;
    for (long tick = 0; tick < ticks; ++tick) {
      const auto record = teleoperator.step(aim_m(tick), aim_m(tick + 1));
      if (tick < settled) continue;
      const std::complex<double> turned = std::polar(1.0, -angle(tick));
      aim += turned * aim_m(tick);
      contact += turned * record.contact_force_N;
    }
    const std::complex<double> s{0.0, turn * frequency_Hz};
    const HybridMatrix h = TwoPort::make(params)->at(turn * frequency_Hz);
    const std::complex<double> wall = params.environment.damping_N_s_per_m + params.environment.stiffness_N_per_m / s;
    const std::complex<double> grip = params.person.grip.damping_N_s_per_m + params.person.grip.stiffness_N_per_m / s;
    const std::complex<double> handle_over_aim = grip / (grip + transmitted_impedance(h, wall));
    const std::complex<double> tip_over_handle = -h.h21 / (1.0 + h.h22 * wall);
    // The record is the mean over the tick that follows.
    const std::complex<double> half_a_tick = std::exp(0.5 * s * tick_s);
    const std::complex<double> expected = s * wall * tip_over_handle * handle_over_aim * half_a_tick;
    EXPECT_LE(std::abs(contact / aim - expected), 0.01 * std::abs(expected)) << frequency_Hz;
  }
}

TEST(TwoPort, MasterThatGetsNoForceIsAsPassiveAsItsMechanism) {
  simulation::Teleoperator::Params params = uncancelled();
  params.control.force_gain = 0.0;
  const TwoPort port = *TwoPort::make(params);
  for (double frequency_Hz = 1.0; frequency_Hz < 1000.0; frequency_Hz *= 1.5) {
    const HybridMatrix h = port.at(turn * frequency_Hz);
    EXPECT_GE(h.h11.real(), -1e-9 * std::abs(h.h11));
    EXPECT_EQ(std::abs(h.h12), 0.0);
  }
}

TEST(TwoPort, LlewellynAndScatteringOfNetworksThatAreKnown) {
  // An ideal transformer of ratio one joined by a series damper is passive, and lossless without the damper.
  const HybridMatrix lossless{.h11 = 0.0, .h12 = 1.0, .h21 = -1.0, .h22 = 0.0};
  EXPECT_NEAR(llewellyn_index(lossless), 1.0, 1e-12);
  EXPECT_NEAR(scattering_norm(lossless, 7.0), 1.0, 1e-12);
  const HybridMatrix damped{.h11 = 2.0, .h12 = 1.0, .h21 = -1.0, .h22 = 0.1};
  EXPECT_GT(llewellyn_index(damped), 1.0);
  EXPECT_LE(scattering_norm(damped, 7.0), 1.0 + 1e-12);
  // Force three times what the slave feels, motion one to one: a source of energy.
  const HybridMatrix amplifying{.h11 = 0.1, .h12 = 3.0, .h21 = -1.0, .h22 = 0.1};
  EXPECT_GT(scattering_norm(amplifying, 1.0), 1.0);
  // A pure delay of both ways is not absolutely stable.
  const std::complex<double> late = std::polar(1.0, -0.3);
  EXPECT_LT(llewellyn_index({.h11 = 0.0, .h12 = late, .h21 = -late, .h22 = 0.0}), 1.0);
  EXPECT_EQ(llewellyn_index({.h11 = -0.1, .h12 = 1.0, .h21 = -1.0, .h22 = 1.0}), -1.0);
}

TEST(TwoPort, PassivityIndexAndScatteringNormAgreeOnWhatIsPassive) {
  signal::Random random(3);
  int passive = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto entry = [&random] { return std::complex<double>(random.normal(), random.normal()); };
    HybridMatrix h{.h11 = 2.0 + entry(), .h12 = entry(), .h21 = entry(), .h22 = 2.0 + entry()};
    const double reference = std::exp(random.normal());
    const double index = passivity_index(h, reference);
    if (std::fabs(index) < 1e-9) continue;
    EXPECT_EQ(index > 0.0, scattering_norm(h, reference) < 1.0) << index;
    passive += index > 0.0 ? 1 : 0;
    // A damper at each port, one reference impedance large, adds just as much.
    h.h11 += reference;
    h.h22 += 1.0 / reference;
    EXPECT_NEAR(passivity_index(h, reference), index + 1.0, 1e-9);
  }
  EXPECT_GT(passive, 100);
  EXPECT_LT(passive, 1900);
}

TEST(TwoPort, ActuatorOnTheHandleBringsTheForceBackWhereTheMotorNoLongerDoes) {
  simulation::Teleoperator::Params params = uncancelled();
  params.control.crossover.frequency_Hz = 30.0;
  const TwoPort port = *TwoPort::make(params);
  // Slow force comes through the motor as before; the actuator pushes the handle in its place at high frequency.
  EXPECT_NEAR(std::abs(port.at(turn * 0.2).h12 - params.control.force_gain), 0.0, 0.02);
  params.control.crossover.frequency_Hz = 0.0;
  const TwoPort plain = *TwoPort::make(params);
  const double frequency = turn * 250.0;
  EXPECT_GT(std::abs(port.at(frequency).h12), 3.0 * std::abs(plain.at(frequency).h12));
}

TEST(TwoPort, HandFeelsTheEnvironmentItselfThroughAnIdealOne) {
  const HybridMatrix ideal{.h11 = 0.0, .h12 = 1.0, .h21 = -1.0, .h22 = 0.0};
  const std::complex<double> environment{3.0, -500.0};
  EXPECT_EQ(transmitted_impedance(ideal, environment), environment);
  EXPECT_EQ(transmitted_impedance(ideal, 0.0), std::complex<double>(0.0));
}

}  // namespace
}  // namespace tactus::stability
