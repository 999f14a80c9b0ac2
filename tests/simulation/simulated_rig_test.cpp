// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/excitation.hpp>
#include <tactus/simulation/teleoperator/simulated_rig.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tactus::simulation {
namespace simulated_rig_test {

using identification::Assembly;
using identification::MotorProgram;
using identification::RigRun;

/// A rig without friction, noise, hysteresis and quantisation, so that closed forms hold.
SimulatedRigParams ideal() {
  SimulatedRigParams rig;
  auto& mechanism = rig.benched.master.mechanism;
  mechanism.motor.friction_N = mechanism.drum.friction_N = 0.0;
  mechanism.linkage.hysteretic_fraction = 0.0;
  mechanism.linkage.damping_N_s_per_m = 0.0;
  rig.benched.master.amplifier.bandwidth_Hz = 1e6;
  rig.benched.person.correction.gain_per_s = 0.0;
  rig.current_noise_rms_N = rig.encoder_resolution_m = rig.wander_rms_m = rig.tremor_amplitude_m = 0.0;
  return rig;
}

RigRun run(const SimulatedRigParams& params, Assembly assembly, const MotorProgram& program) {
  auto rig = SimulatedRig::make(params).value();
  EXPECT_FALSE(rig.assemble(assembly));
  return rig.run(program).value();
}

RigRun step_of_force(const SimulatedRigParams& params, Assembly assembly, double force_N, double duration_s) {
  MotorProgram program;
  program.force_N.assign(static_cast<std::size_t>(duration_s / 200e-6), force_N);
  return run(params, assembly, program);
}

constexpr double delay_s = 20e-6 + 0.5e-6 / std::numbers::pi;  // of computation and amplifier

TEST(SimulatedRig, AMotorAloneAcceleratesByForceOverItsMass) {
  const auto record = step_of_force(ideal(), Assembly::motor, 0.1, 0.02);
  const double time_s = 99 * 200e-6 - delay_s;
  EXPECT_NEAR(record.position_m[99], 0.5 * 0.1 / 0.0075 * time_s * time_s, 1e-6 * record.position_m[99] + 1e-9);
}

TEST(SimulatedRig, WithTheDrumLockedTheMotorRingsOnTheCableAlone) {
  auto params = ideal();
  params.benched.master.mechanism.cable.damping_N_s_per_m = 0.0;
  const auto record = step_of_force(params, Assembly::cable, 1.0, 0.02);
  const double natural = std::sqrt(39500.0 / 0.0075);
  for (std::size_t i = 1; i < record.position_m.size(); ++i) {
    const double time_s = static_cast<double>(i) * 200e-6 - delay_s;
    EXPECT_NEAR(record.position_m[i], (1.0 - std::cos(natural * time_s)) / 39500.0, 2e-7) << i;
  }
}

TEST(SimulatedRig, WithTheLinkageOffMotorAndDrumAccelerateTogether) {
  const auto record = step_of_force(ideal(), Assembly::drum, 0.1, 0.05);
  const double time_s = 249 * 200e-6 - delay_s;
  EXPECT_NEAR(record.position_m[249], 0.5 * 0.1 / 0.01825 * time_s * time_s, 2e-3 * record.position_m[249]);
}

TEST(SimulatedRig, WithTheHandleLockedTheMotorGivesWayByCableAndLinkageInSeries) {
  MotorProgram slow;
  slow.force_N =
      identification::force_loops_N({.peak_N = 1.0, .rate_N_per_s = 4.0, .loops = 1}, Seconds{200e-6}).value();
  auto params = ideal();
  params.benched.master.mechanism.linkage.damping_N_s_per_m = 2.0;  // or the corners of the loop would ring on
  const auto record = run(params, Assembly::linkage, slow);
  for (std::size_t i = 0; i < record.position_m.size(); i += 50) {
    EXPECT_NEAR(record.position_m[i], slow.force_N[i] * (1.0 / 39500.0 + 1.0 / 3950.0), 3e-6) << i;
  }
}

TEST(SimulatedRig, AHeldMasterSettlesWhereTheGripHoldsTheForce) {
  const auto record = step_of_force(ideal(), Assembly::held, 0.2, 6.0);
  EXPECT_NEAR(record.position_m.back(), 0.2 * (1.0 / 39500.0 + 1.0 / 3950.0 + 1.0 / 40.0), 2e-6);
}

TEST(SimulatedRig, ALockedDrumDoesNotCreepUnderTheLargestForce) {
  auto params = ideal();
  params.benched.master.mechanism.drum.friction_N = 0.0144;
  const auto record = step_of_force(params, Assembly::cable, 5.0, 5.0);
  EXPECT_NEAR(record.position_m.back(), 5.0 / 39500.0, 1e-9);
}

TEST(SimulatedRig, ItsSensorsAreAsCoarseAndNoisyAsStated) {
  SimulatedRigParams params;
  params.amplifier_offset_N = 0.004;
  const auto record = step_of_force(params, Assembly::linkage, 0.5, 1.0);
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 100; i < record.current_force_N.size(); ++i) {
    sum += record.current_force_N[i] - 0.504;
    squares += std::pow(record.current_force_N[i] - 0.504, 2);
  }
  const auto count = static_cast<double>(record.current_force_N.size() - 100);
  EXPECT_NEAR(sum / count, 0.0, 5.0 * 0.01 / std::sqrt(count));
  EXPECT_NEAR(std::sqrt(squares / count), 0.01, 0.0005);
  for (const double position_m : record.position_m) {
    EXPECT_NEAR(position_m / 1e-5, std::round(position_m / 1e-5), 1e-6);
  }
}

TEST(SimulatedRig, AProgramThatLeavesTheLimitsIsRefusedAndNamed) {
  auto rig = SimulatedRig::make({}).value();
  const auto forced = rig.run({.force_N = {0.0, 5.5}, .reference_m = {}});
  ASSERT_FALSE(forced);
  EXPECT_EQ(forced.error().code, ErrorCode::out_of_bounds);
  EXPECT_EQ(forced.error().parameter, "force_N[1]");
  const auto led = rig.run({.force_N = {}, .reference_m = {-0.06}, .stiffness_N_per_m = 10.0});
  ASSERT_FALSE(led);
  EXPECT_EQ(led.error().parameter, "reference_m[0]");
  EXPECT_FALSE(rig.run({}));
  EXPECT_FALSE(rig.run({.force_N = {0.0}, .reference_m = {0.0, 0.0}}));
  EXPECT_FALSE(rig.run({.force_N = {std::nan("")}, .reference_m = {}}));
}

TEST(SimulatedRig, ARunThatLeavesTheLimitsIsStoppedThere) {
  auto rig = SimulatedRig::make(draw_rig(5)).value();
  ASSERT_FALSE(rig.assemble(Assembly::motor));
  const auto away = rig.run({.force_N = std::vector<double>(5000, 1.0), .reference_m = {}});
  ASSERT_FALSE(away);
  EXPECT_EQ(away.error().code, ErrorCode::failed);
  EXPECT_NE(away.error().message.find("position"), std::string::npos) << away.error().message;
  const auto jerked = rig.run({.force_N = {}, .reference_m = std::vector<double>(50, 0.04), .stiffness_N_per_m = 1e3});
  ASSERT_FALSE(jerked);
  EXPECT_NE(jerked.error().message.find("commanded force"), std::string::npos) << jerked.error().message;
}

TEST(SimulatedRig, EqualSeedsAreEqualRigsAndOthersDiffer) {
  const MotorProgram program{.force_N = std::vector<double>(500, 0.3), .reference_m = {}};
  const auto first = run(draw_rig(3), Assembly::held, program);
  const auto again = run(draw_rig(3), Assembly::held, program);
  const auto other = run(draw_rig(4), Assembly::held, program);
  EXPECT_EQ(first.position_m, again.position_m);
  EXPECT_EQ(first.current_force_N, again.current_force_N);
  EXPECT_NE(first.position_m, other.position_m);
}

TEST(SimulatedRig, EveryDrawnRigLiesAroundTheTableAndCanBeMade) {
  const auto table = mechanics::CableChain::Params{};
  for (std::int64_t seed = 1; seed <= 50; ++seed) {
    const auto params = draw_rig(seed);
    const auto& mechanism = params.benched.master.mechanism;
    EXPECT_TRUE(SimulatedRig::make(params)) << seed;
    EXPECT_NEAR(mechanism.motor.mass_kg / table.motor.mass_kg, 1.0, 0.3) << seed;
    EXPECT_NEAR(mechanism.linkage.stiffness_N_per_m / table.linkage.stiffness_N_per_m, 1.0, 0.3) << seed;
    EXPECT_NEAR(params.benched.person.grip.stiffness_N_per_m / 40.0, 1.0, 0.4) << seed;
  }
}

TEST(SimulatedRig, TheLoopAreaIsWhatASlowLoopEncloses) {
  const mechanics::ElastoSlipSpring::Params params;
  auto spring = mechanics::ElastoSlipSpring::make(params, Seconds{1.0}).value();
  const double amplitude_m = 2e-4;
  const int steps = 20000;
  double area_J = 0.0, before_m = 0.0, force_before_N = 0.0;
  for (int i = 1; i <= 3 * steps; ++i) {
    const double now_m = amplitude_m * std::sin(2.0 * std::numbers::pi * i / steps);
    const double force_N = spring.step({.deflection_m = now_m});
    if (i > 2 * steps) area_J += 0.5 * (force_N + force_before_N) * (now_m - before_m);
    before_m = now_m;
    force_before_N = force_N;
  }
  EXPECT_NEAR(area_J, loop_area_J(params, amplitude_m), 1e-3 * area_J);
}

}  // namespace simulated_rig_test
}  // namespace tactus::simulation
