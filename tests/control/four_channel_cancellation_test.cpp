// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/four_channel.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <deque>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

// Paper A's appendix: cancellation of induced master motion as the slave's local force loop of a four-channel
// controller that has C_1 and C_2 only.
namespace tactus::control {
namespace four_channel_cancellation_test {

using Complex = std::complex<double>;
constexpr double tick_s = 200e-6;

/// A linear model: nothing rubs, slips or stiffens. Gates and saturation out of reach.
ControlParams linear(const std::string& architecture) {
  ControlParams params;
  params.architecture = architecture;
  params.position_scale = 0.8;
  params.force_gain = 4.0;
  params.force_limit_N = 100.0;
  params.gate = params.slave_gate = {.force_limit_N = 100.0, .rate_limit_N_per_s = 1e6};
  params.model.motor.friction_N = params.model.drum.friction_N = 0.0;
  params.model.linkage.hysteretic_fraction = 0.0;
  params.model.hand.quintic_stiffness_N_per_m5 = 0.0;
  return params;
}

/// Motor position over motor force of Table I's master and hand in m/N: each mass carries what lies beyond it.
Complex master_and_hand(Complex s) {
  const auto series = [](Complex a, Complex b) { return a * b / (a + b); };
  const Complex handle = 0.014 * s * s + 23.0 * s + 40.0;
  const Complex drum = 0.01075 * s * s + series(0.02 * s + 3950.0, handle);
  return 1.0 / (0.0075 * s * s + series(3.6 * s + 39500.0, drum));
}

TEST(FourChannelCancellation, TheSlavesForceLoopIsMinusC1TimesC2OverTheImpedanceOfMasterAndHand) {
  const ControlParams params = linear("four-channel-cancellation");
  for (const double f : {2.0, 20.0, 75.0, 200.0}) {
    const auto answer = [&](double SlaveInput::*driven) {
      auto site = CancellingSlave::make({.master = params, .slave = params.slave}, Seconds{tick_s}).value();
      Complex sum = 0.0;
      constexpr int settling_ticks = 20000, measured_ticks = 5000;
      for (int tick = 0; tick < settling_ticks + measured_ticks; ++tick) {
        const double angle = 2.0 * std::numbers::pi * f * tick_s * tick;
        SlaveInput input;
        input.*driven = std::cos(angle);
        const double force_N = site.step(input).motor_force_N;
        if (tick >= settling_ticks) sum += force_N * std::polar(1.0, -angle);
      }
      return 2.0 * sum / static_cast<double>(measured_ticks);
    };
    const Complex c_5 = -answer(&SlaveInput::tip_force_N);
    const Complex c_s = -answer(&SlaveInput::motor_position_m);
    // The force is displayed one tick after it was sent and held for one tick.
    const Complex s(0.0, 2.0 * std::numbers::pi * f);
    const Complex tick_and_hold = std::exp(-s * tick_s) * (1.0 - std::exp(-s * tick_s)) / (s * tick_s);
    const Complex expected = -(params.position_scale * c_s) * params.force_gain * tick_and_hold * master_and_hand(s);
    EXPECT_NEAR(std::abs(c_5 - expected), 0.0, 2e-3 * std::abs(expected)) << f << " Hz";
  }
}

/// A linear rig written for this test: the master's chain in the hand, and a slave of one mass bound to a wall by a
/// spring and damper that pull as well as push. Semi-implicit Euler in steps of 10 us.
struct LinearRig {
  std::array<double, 3> x{}, v{};
  double slave_m = 0.0, slave_m_per_s = 0.0;

  [[nodiscard]] double tip_force_N() const { return 4000.0 * slave_m + 3.0 * slave_m_per_s; }

  void advance(double master_force_N, double slave_force_N, double hand_m, double hand_m_per_s) {
    constexpr int steps = 20;
    constexpr double h = tick_s / steps;
    for (int i = 0; i < steps; ++i) {
      const double cable_N = 39500.0 * (x[0] - x[1]) + 3.6 * (v[0] - v[1]);
      const double linkage_N = 3950.0 * (x[1] - x[2]) + 0.02 * (v[1] - v[2]);
      const double hand_N = 40.0 * (hand_m - x[2]) + 23.0 * (hand_m_per_s - v[2]);
      v[0] += h / 0.0075 * (master_force_N - cable_N);
      v[1] += h / 0.01075 * (cable_N - linkage_N);
      v[2] += h / 0.014 * (linkage_N + hand_N);
      for (std::size_t k = 0; k < 3; ++k) x[k] += h * v[k];
      slave_m_per_s += h / 0.032 * (slave_force_N - tip_force_N());
      slave_m += h * slave_m_per_s;
    }
  }
};

/// The slave's motor force, tick by tick, while the hand swings, over channels of `delay_ticks` each way on top of the
/// tick that a message to the master takes at least.
std::vector<double> slave_commands(const ControlParams& params, std::size_t delay_ticks) {
  Sites sites = make_sites(params, Seconds{tick_s}).value();
  LinearRig rig;
  std::deque<Message> to_slave(delay_ticks), to_master(delay_ticks + 1);
  std::vector<double> commands_N;
  for (int tick = 0; tick < 5000; ++tick) {
    const double time_s = tick * tick_s;
    const auto master =
        sites.master.step({.motor_position_m = rig.x[0], .arrival = {.message = to_master.front(), .fresh = true}});
    to_master.pop_front();
    to_slave.push_back(master.message);
    const auto slave = sites.slave.step({.motor_position_m = rig.slave_m,
                                         .tip_force_N = rig.tip_force_N(),
                                         .arrival = {.message = to_slave.front(), .fresh = true}});
    to_slave.pop_front();
    to_master.push_back(slave.message);
    commands_N.push_back(slave.motor_force_N);
    // A slow swing with a beat on it that wakes the chain.
    rig.advance(master.motor_force_N, slave.motor_force_N,
                0.01 * std::sin(9.0 * time_s) + 2e-4 * std::sin(400.0 * time_s),
                0.09 * std::cos(9.0 * time_s) + 0.08 * std::cos(400.0 * time_s));
  }
  return commands_N;
}

double largest(const std::vector<double>& values) {
  double most = 0.0;
  for (const double value : values) most = std::max(most, std::fabs(value));
  return most;
}
double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  std::vector<double> difference(a.size());
  std::transform(a.begin(), a.end(), b.begin(), difference.begin(), std::minus<>());
  return largest(difference);
}

// The derivative gain over a tick, times λ and the round-off of a position of 10 mm, is 1e-14 N; the bound leaves room
// for the loop to carry it on.
constexpr double round_off_N = 1e-11;

TEST(FourChannelCancellation, WithoutDelayTheLinearLoopIsThatOfTheCancellingMasterTickByTick) {
  const auto on_master = slave_commands(linear("position-force"), 0);
  const auto on_slave = slave_commands(linear("four-channel-cancellation"), 0);
  ASSERT_GT(largest(on_master), 0.1);
  EXPECT_LT(largest_difference(on_master, on_slave), round_off_N);

  // Cancellation does something here that could be missed.
  ControlParams plain = linear("position-force");
  plain.cancellation = CancellationMode::off;
  EXPECT_GT(largest_difference(on_master, slave_commands(plain, 0)), 0.01);
}

TEST(FourChannelCancellation, TheSlaveCancelsWhateverTheFilesSwitchSays) {
  ControlParams params = linear("four-channel-cancellation");
  const auto on = slave_commands(params, 0);
  params.cancellation = CancellationMode::off;
  EXPECT_EQ(largest_difference(on, slave_commands(params, 0)), 0.0);
}

// The slave would go on to subtract the motion of the old gain.
TEST(FourChannelCancellation, TheForceGainCannotBeChangedWhileTheLoopRuns) {
  const auto gain_of = [](const char* name) {
    return find_architecture(name)->make(linear(name), Seconds{tick_s}).value().master->force_gain();
  };
  EXPECT_EQ(gain_of("four-channel-cancellation"), std::nullopt);
  EXPECT_EQ(gain_of("position-force"), linear("position-force").force_gain);
}

TEST(FourChannelCancellation, WithDelayTheSlaveCancelsTooEarlyAndTheTwoPart) {
  const auto on_master = slave_commands(linear("position-force"), 10);
  const auto on_slave = slave_commands(linear("four-channel-cancellation"), 10);
  EXPECT_GT(largest_difference(on_master, on_slave), 1e6 * round_off_N);
}

}  // namespace four_channel_cancellation_test
}  // namespace tactus::control
