// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/safety_gate.hpp>
#include <tactus/kernel/control/stopping_brake.hpp>

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace tactus::control {
namespace stopping_brake_test {

constexpr double tick_s = 200e-6;
constexpr double mass_kg = 0.03;
constexpr double damping_N_s_per_m = 3.0;

/// A free mass that slides against a gate that brakes, read by an encoder of 10 um; its motor gives `motor` times what
/// it is told.
struct Sliding {
  double motor = 1.0;
  double velocity_m_per_s = 0.0;
  double position_m = 0.0;
  double fastest_m_per_s = 0.0;
  bool ever_pushed_on = false;  ///< the motor's force was along the motion
  SafetyGate gate = [] {
    SafetyGate::Params params;
    params.energy.damping_N_s_per_m = damping_N_s_per_m;
    return SafetyGate::make(params, Seconds{tick_s}).value();
  }();

  double read_m() const { return 1e-5 * std::floor(position_m / 1e-5); }
  void slide(double seconds) {
    for (double time_s = 0.0; time_s < seconds; time_s += tick_s) {
      gate.believe(read_m());
      const double given_N = motor * gate.pass(1.0);
      ever_pushed_on = ever_pushed_on || given_N * velocity_m_per_s > 1e-9;
      velocity_m_per_s += given_N / mass_kg * tick_s;
      position_m += velocity_m_per_s * tick_s;
      fastest_m_per_s = std::max(fastest_m_per_s, std::fabs(velocity_m_per_s));
    }
  }
};

/// Moves at a speed that the gate has seen for a while.
Sliding sliding_at(double velocity_m_per_s, double motor = 1.0) {
  Sliding device{.motor = motor, .velocity_m_per_s = velocity_m_per_s};
  constexpr int before = 100;
  for (int i = -before; i < 0; ++i) {
    device.position_m = velocity_m_per_s * tick_s * i;
    device.gate.believe(device.read_m());
    device.gate.pass(0.0);
  }
  device.position_m = 0.0;
  device.gate.brake();
  return device;
}

TEST(StoppingBrake, AFreeMassStopsWithinItsMomentumOverTheDampingAndIsThenGivenNothing) {
  for (const double speed_m_per_s : {0.5, -0.9}) {
    Sliding device = sliding_at(speed_m_per_s);
    device.slide(0.3);
    const double way_m = mass_kg * std::fabs(speed_m_per_s) / damping_N_s_per_m;
    // The low-pass on the velocity is 0.8 ms late. It ripples by a count or two, so the brake ends at up to twice the
    // speed that counts as standing; friction takes what is left.
    EXPECT_NEAR(std::fabs(device.position_m), way_m + 1e-3 * std::fabs(speed_m_per_s), 0.3 * way_m);
    EXPECT_LE(std::fabs(device.velocity_m_per_s), 2.0 * StoppingBrake::stands_m_per_s);
    EXPECT_EQ(device.gate.passed_N(), 0.0);
    EXPECT_EQ(device.gate.fault(), GateFault::none);
  }
}

TEST(StoppingBrake, AMotorThatPushesTheWrongWayIsFoundOutBeforeItHasGainedTwiceTheBound) {
  for (const double speed_m_per_s : {0.02, 0.5, 0.9}) {
    Sliding device = sliding_at(speed_m_per_s, -1.0);
    device.slide(0.3);
    EXPECT_TRUE(device.ever_pushed_on) << "nothing was put to the test";
    EXPECT_LT(device.fastest_m_per_s, speed_m_per_s + 2.0 * StoppingBrake::gained_m_per_s);
    EXPECT_EQ(device.gate.passed_N(), 0.0);
  }
}

TEST(StoppingBrake, LettingGoAndAFaultTakeItsForceAndRearmingTheGateBeginsAnew) {
  Sliding device = sliding_at(0.5);
  device.slide(0.002);
  EXPECT_LT(device.gate.passed_N(), -0.1);
  Sliding refused = device;
  refused.gate.refuse();
  refused.slide(0.01);
  EXPECT_EQ(refused.gate.passed_N(), 0.0);
  device.gate.release();
  device.slide(0.01);
  EXPECT_EQ(device.gate.passed_N(), 0.0);
  device.gate.rearm();
  device.slide(tick_s);
  EXPECT_EQ(device.gate.passed_N(), 1.0) << "what is commanded passes again";
}

}  // namespace stopping_brake_test
}  // namespace tactus::control
