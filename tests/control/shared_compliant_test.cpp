// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architectures/shared_compliant.hpp>

#include <cmath>
#include <numbers>

#include "tests/signal/frequency_response.hpp"
#include <gtest/gtest.h>

namespace tactus::control {
namespace shared_compliant_test {

constexpr double tick_s = 200e-6;

SharedCompliantSlave slave(const SharedCompliantSlave::Params& params) {
  return SharedCompliantSlave::make(params, Seconds{tick_s}).value();
}

SlaveInput input(double command_m, double position_m, double tip_force_N) {
  return {.motor_position_m = position_m,
          .tip_force_N = tip_force_N,
          .arrival = {.message = {.position_m = command_m}, .fresh = true}};
}

TEST(SharedCompliantSlave, AtRestTheCommandYieldsByTheTipForceOverTheStiffness) {
  for (const double stiffness : {50.0, 500.0, 4000.0}) {
    for (const double tip_force_N : {-0.4, 0.0, 0.7}) {
      SharedCompliantSlave site = slave({.slave = {}, .compliance = {.stiffness_N_per_m = stiffness}});
      double force_N = 0.0;
      for (int tick = 0; tick < 10000; ++tick) force_N = site.step(input(0.012, 0.010, tip_force_N)).motor_force_N;
      EXPECT_NEAR(force_N, 100.0 * (0.012 - tip_force_N / stiffness - 0.010), 1e-9);
    }
  }
}

TEST(SharedCompliantSlave, YieldsThreeDecibelsLessAtItsCutoff) {
  struct Yielding {
    SharedCompliantSlave site;
    void reset() { site.reset(); }
    double step(double tip_force_N) { return site.step(input(0.0, 0.0, tip_force_N)).motor_force_N; }
  };
  for (const double cutoff_Hz : {5.0, 40.0, 400.0}) {
    SharedCompliantSlave::Params params{.slave = {},
                                        .compliance = {.stiffness_N_per_m = 500.0, .cutoff_Hz = cutoff_Hz}};
    params.slave.derivative_N_s_per_m = 0.0;
    const Yielding yielding{slave(params)};
    const double at_rest = std::abs(measured_response(yielding, 0.0, tick_s));
    EXPECT_NEAR(at_rest, 100.0 / 500.0, 1e-9);
    EXPECT_NEAR(std::abs(measured_response(yielding, cutoff_Hz, tick_s)), at_rest * std::numbers::sqrt2 / 2.0, 1e-9);
  }
}

TEST(SharedCompliantSlave, ReflectsTheTipForceAsItWasMeasured) {
  SharedCompliantSlave site = slave({});
  for (const double tip_force_N : {0.0, -0.3, 12.5}) {
    EXPECT_EQ(site.step(input(0.0, 0.0, tip_force_N)).message.force_N, tip_force_N);
  }
}

TEST(SharedCompliantSlave, InFreeSpaceItFollowsAsPositionForceDoes) {
  SharedCompliantSlave compliant = slave({});
  PositionForceSlave plain = PositionForceSlave::make({}, Seconds{tick_s}).value();
  for (int tick = 0; tick < 500; ++tick) {
    const SlaveInput free = input(0.01 * std::sin(0.02 * tick), 0.01 * std::sin(0.02 * tick - 0.1), 0.0);
    ASSERT_EQ(compliant.step(free).motor_force_N, plain.step(free).motor_force_N);
  }
}

}  // namespace shared_compliant_test
}  // namespace tactus::control
