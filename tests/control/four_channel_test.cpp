// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/architectures/four_channel.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::control {
namespace four_channel_test {

static_assert(Element<FourChannelMaster>);
static_assert(Element<FourChannelSlave>);
static_assert(Element<CancellingSlave>);

using Complex = std::complex<double>;
constexpr double tick_s = 200e-6;
constexpr double no_limit_N = 100.0;
constexpr std::array frequencies_Hz{1.0, 7.0, 40.0, 150.0, 600.0};

Complex angular(double frequency_Hz) { return {0.0, 2.0 * std::numbers::pi * frequency_Hz}; }

/// How a site answers a sine of a whole number of hertz on one of its inputs, once settled, everything else at rest.
template <class Site, class Drive, class Read>
Complex response(Site site, double frequency_Hz, Drive drive, Read read) {
  constexpr int settling_ticks = 5000, measured_ticks = 5000;
  constexpr double amplitude = 1e-3;  // small enough for no limit to be met
  Complex sum = 0.0;
  for (int tick = 0; tick < settling_ticks + measured_ticks; ++tick) {
    const double angle = 2.0 * std::numbers::pi * frequency_Hz * tick_s * tick;
    typename Site::Input input;
    drive(input) = amplitude * std::cos(angle);
    const double answer = read(site.step(input));
    if (tick >= settling_ticks) sum += answer * std::polar(1.0, -angle);
  }
  return 2.0 * sum / (amplitude * measured_ticks);
}

constexpr auto motor_position = [](auto& input) -> double& { return input.motor_position_m; };
constexpr auto hand_force = [](MasterInput& input) -> double& { return input.hand_force_N; };
constexpr auto tip_force = [](SlaveInput& input) -> double& { return input.tip_force_N; };
constexpr auto told_position = [](auto& input) -> double& { return input.arrival.message.position_m; };
constexpr auto told_force = [](auto& input) -> double& { return input.arrival.message.force_N; };
constexpr auto motor_force = [](const auto& output) { return output.motor_force_N; };
constexpr auto tells_position = [](const auto& output) { return output.message.position_m; };
constexpr auto tells_force = [](const auto& output) { return output.message.force_N; };

/// Gains of a controller of both sites.
struct Gains {
  double lambda = 1.0, mu = 1.0;
  ServoPd::Params slave{};
  FourChannelParams four_channel{};
};

FourChannelMaster master(const Gains& gains) {
  return FourChannelMaster::make({.position_scale = gains.lambda,
                                  .force_gain = gains.mu,
                                  .force_limit_N = no_limit_N,
                                  .four_channel = gains.four_channel},
                                 Seconds{tick_s})
      .value();
}
FourChannelSlave slave(const Gains& gains) {
  return FourChannelSlave::make({.force_gain = gains.mu, .slave = gains.slave, .four_channel = gains.four_channel},
                                Seconds{tick_s})
      .value();
}

/// The channels of Lawrence's block diagram on positions at one frequency, with the devices that they control. Signs as
/// in the header of four_channel.hpp.
struct Teleoperator {
  Complex c_1, c_2, c_3, c_4, c_5, c_6, c_m, c_s;
  Complex master, slave;  ///< dynamics of the devices, N/m

  /// What the controllers really do, measured on them.
  static Teleoperator measured(const Gains& gains, double frequency_Hz, Complex master_device, Complex slave_device) {
    const auto m = four_channel_test::master(gains);
    const auto s = four_channel_test::slave(gains);
    const double f = frequency_Hz;
    return {.c_1 = response(m, f, motor_position, tells_position) * response(s, f, told_position, motor_force),
            .c_2 = -response(s, f, tip_force, tells_force) * response(m, f, told_force, motor_force),
            .c_3 = response(m, f, hand_force, tells_force) * response(s, f, told_force, motor_force),
            .c_4 = -response(s, f, motor_position, tells_position) * response(m, f, told_position, motor_force),
            .c_5 = -response(s, f, tip_force, motor_force),
            .c_6 = response(m, f, hand_force, motor_force),
            .c_m = -response(m, f, motor_position, motor_force),
            .c_s = -response(s, f, motor_position, motor_force),
            .master = master_device,
            .slave = slave_device};
  }
  /// The same with the accelerations that the condition asks for.
  [[nodiscard]] Teleoperator with_accelerations(const Gains& gains) const {
    Teleoperator ideal = *this;
    ideal.c_1 += gains.lambda * slave;
    ideal.c_4 -= master / gains.lambda;
    return ideal;
  }

  struct Answer {
    Complex hand_force, slave_position;
  };
  /// Solves the motion of both devices, D_m x_m = F_h + F_cm and D_s x_s = F_cs − F_e, for given x_m and an environment
  /// that pushes back with `stiffness` times x_s plus `push`.
  [[nodiscard]] Answer solve(Complex master_position, Complex stiffness, Complex push) const {
    const Complex a = 1.0 + c_6, b = -(c_4 + c_2 * stiffness);
    const Complex c = c_3, d = -(slave + c_s + (1.0 + c_5) * stiffness);
    const Complex right_1 = (master + c_m) * master_position + c_2 * push;
    const Complex right_2 = -c_1 * master_position + (1.0 + c_5) * push;
    const Complex determinant = a * d - b * c;
    return {(right_1 * d - b * right_2) / determinant, (a * right_2 - right_1 * c) / determinant};
  }
  /// What the hand feels, F_h / x_m, where the slave feels `environment`, F_e / x_s.
  [[nodiscard]] Complex transmitted(Complex environment) const { return solve(1.0, environment, 0.0).hand_force; }
};

Complex moving_mass(double mass_kg, double damping_N_s_per_m, double frequency_Hz) {
  const Complex s = angular(frequency_Hz);
  return mass_kg * s * s + damping_N_s_per_m * s;
}
Complex master_device(double frequency_Hz) { return moving_mass(0.032, 0.5, frequency_Hz); }
Complex slave_device(double frequency_Hz) { return moving_mass(0.05, 1.2, frequency_Hz); }

/// Nothing, soft, viscous, heavy, hard.
std::vector<Complex> environments(double frequency_Hz) {
  const Complex s = angular(frequency_Hz);
  return {0.0, 200.0 + 2.0 * s, 23.0 * s, 0.3 * s * s, 40000.0 + 3.0 * s};
}

std::vector<Gains> transparent_gains() {
  return {
      {},
      {.lambda = 0.5, .mu = 3.0},
      {.lambda = 2.0,
       .mu = 0.7,
       .slave = {.proportional_N_per_m = 900.0, .derivative_N_s_per_m = 4.0},
       .four_channel = {.master = {.proportional_N_per_m = 50.0, .derivative_N_s_per_m = 0.2},
                        .environment_force_gain = 1.5,
                        .hand_force_gain = 1.25,
                        .slave_force_loop_gain = 0.25,
                        .master_force_loop_gain = 0.5}},
      // Three channels: the slave's force loop takes the place of the hand force's channel, or the master's of the
      // other.
      {.mu = 4.0, .four_channel = {.hand_force_gain = 0.0, .slave_force_loop_gain = -1.0}},
      {.mu = 4.0, .four_channel = {.environment_force_gain = 0.0, .master_force_loop_gain = -1.0}},
  };
}

TEST(FourChannel, WithAccelerationsTheHandFeelsEveryEnvironmentAsItIs) {
  for (const Gains& gains : transparent_gains()) {
    ASSERT_EQ(check_transparency(gains.four_channel), std::nullopt);
    for (const double f : frequencies_Hz) {
      const auto ideal = Teleoperator::measured(gains, f, master_device(f), slave_device(f)).with_accelerations(gains);
      for (const Complex& environment : environments(f)) {
        const Complex felt = gains.lambda * gains.mu * environment;
        EXPECT_NEAR(std::abs(ideal.transmitted(environment) - felt), 0.0,
                    1e-9 * (std::abs(felt) + std::abs(ideal.master) + std::abs(ideal.c_m)))
            << f << " Hz, lambda " << gains.lambda << ", mu " << gains.mu;
      }
    }
  }
}

TEST(FourChannel, WithAccelerationsTheHybridMatrixIsThatOfARigidWeightlessTool) {
  for (const Gains& gains : transparent_gains()) {
    for (const double f : frequencies_Hz) {
      const auto ideal = Teleoperator::measured(gains, f, master_device(f), slave_device(f)).with_accelerations(gains);
      const auto in_free_space = ideal.solve(1.0, 0.0, 0.0);
      const auto with_the_master_held = ideal.solve(0.0, 0.0, 1.0);
      const double scale_N_per_m = std::abs(ideal.master + ideal.c_m) + std::abs(ideal.slave + ideal.c_s);
      EXPECT_NEAR(std::abs(in_free_space.hand_force), 0.0, 1e-9 * scale_N_per_m);
      EXPECT_NEAR(std::abs(in_free_space.slave_position - gains.lambda), 0.0, 1e-9);
      EXPECT_NEAR(std::abs(with_the_master_held.hand_force - gains.mu), 0.0, 1e-9);
      EXPECT_NEAR(std::abs(with_the_master_held.slave_position), 0.0, 1e-9);
    }
  }
}

TEST(FourChannel, GainsThatTheCheckRefusesAreNotTransparentEvenWithAccelerations) {
  struct Refused {
    FourChannelParams channels;
    std::string parameter, remedy;
  };
  const std::vector<Refused> all{
      {{.environment_force_gain = 1.1}, "environment_force_gain", "write 1, "},
      {{.hand_force_gain = 0.8}, "hand_force_gain", "write 1, "},
      {{.master_force_loop_gain = 0.5}, "environment_force_gain", "write 1.5"},
      {{.slave_force_loop_gain = 0.5}, "hand_force_gain", "write 1.5"},
      {{.environment_force_gain = 0.0,
        .hand_force_gain = 0.0,
        .slave_force_loop_gain = -1.0,
        .master_force_loop_gain = -1.0},
       "master_force_loop_gain",
       "raise"},
  };
  for (const Refused& refused : all) {
    const Check error = check_transparency(refused.channels);
    ASSERT_TRUE(error) << refused.parameter;
    EXPECT_EQ(error->parameter, refused.parameter);
    EXPECT_NE(error->message.find(refused.remedy), std::string::npos) << error->message;

    const Gains gains{.four_channel = refused.channels};
    const double f = 7.0;
    const auto ideal = Teleoperator::measured(gains, f, master_device(f), slave_device(f)).with_accelerations(gains);
    // Without any force in the loop there is no solution at all, which is a NaN here.
    const Complex environment = 200.0;
    EXPECT_FALSE(std::abs(ideal.transmitted(environment) - environment) < 1.0) << refused.parameter;
  }
  EXPECT_EQ(check_transparency({.master_force_loop_gain = -2.0})->parameter, "master_force_loop_gain");
}

/// Two equal devices with equal controllers.
Gains symmetric(double force_loop_gain) {
  Gains gains;
  gains.four_channel.master = gains.slave;
  gains.four_channel.environment_force_gain = gains.four_channel.hand_force_gain = 1.0 + force_loop_gain;
  gains.four_channel.slave_force_loop_gain = gains.four_channel.master_force_loop_gain = force_loop_gain;
  return gains;
}

// Both devices see the same force and the same position error with the other sign, so the error is zero, and what is
// left of (1 + C_5)(F_h − F_e) moves one device.
TEST(FourChannel, WithoutAccelerationsTheHandFeelsTheDynamicsOfOneDeviceOverOnePlusTheForceLoopAsWell) {
  for (const double force_loop_gain : {0.0, 1.0, -0.5}) {
    const Gains gains = symmetric(force_loop_gain);
    for (const double f : frequencies_Hz) {
      const auto real = Teleoperator::measured(gains, f, master_device(f), master_device(f));
      for (const Complex& environment : environments(f)) {
        const Complex expected = environment + master_device(f) / (1.0 + force_loop_gain);
        EXPECT_NEAR(std::abs(real.transmitted(environment) - expected), 0.0, 1e-8 * (std::abs(expected) + 1.0))
            << f << " Hz, loop gain " << force_loop_gain;
        if (force_loop_gain == 0.0 && environment == environments(f)[1]) {
          RecordProperty("error at " + format_number(f) + " Hz in N/m",
                         format_number(std::abs(real.transmitted(environment) - environment)));
        }
      }
    }
  }
}

TEST(FourChannel, AFedForwardMassIsThatMassTimesAccelerationHalvedAtTheFiltersCutoff) {
  Gains gains = symmetric(0.0);
  gains.four_channel.master_feedforward_kg = 0.032;
  gains.four_channel.slave_feedforward_kg = 0.05;
  gains.four_channel.acceleration.cutoff_Hz = 40.0;
  const double f = 40.0;
  const Gains without = symmetric(0.0);
  const auto on_master =
      response(master(gains), f, told_position, motor_force) - response(master(without), f, told_position, motor_force);
  const auto on_slave =
      response(slave(gains), f, told_position, motor_force) - response(slave(without), f, told_position, motor_force);
  const double square = std::norm(angular(f));
  EXPECT_NEAR(std::abs(on_master), 0.5 * 0.032 * square, 1e-9 * square);
  EXPECT_NEAR(std::abs(on_slave), 0.5 * 0.05 * square, 1e-9 * square);
  // Far below the cutoff it has the sign of an acceleration.
  const auto slow = response(slave(gains), 1.0, told_position, motor_force) -
                    response(slave(without), 1.0, told_position, motor_force);
  EXPECT_NEAR(slow.real(), -0.05 * std::norm(angular(1.0)), 0.1 * 0.05 * std::norm(angular(1.0)));
}

TEST(FourChannel, FedForwardMassesTakeMostOfTheDevicesWeightOffSlowHandMotion) {
  Gains gains = symmetric(0.0);
  gains.four_channel.master_feedforward_kg = gains.four_channel.slave_feedforward_kg = 0.032;
  const double f = 2.0;
  const Complex device = moving_mass(0.032, 0.0, f);
  const auto felt = [&](const Gains& tried) {
    return std::abs(Teleoperator::measured(tried, f, device, device).transmitted(0.0));
  };
  EXPECT_NEAR(felt(symmetric(0.0)), std::abs(device), 1e-6);
  // Two first-order lags of 30 Hz leave 1 - 1/(1 + jf/30)^2, 13 % at 2 Hz.
  EXPECT_NEAR(felt(gains) / std::abs(device), 0.133, 0.01);
}

TEST(FourChannelMaster, WhatItDisplaysSaturatesAsAWhole) {
  auto site = FourChannelMaster::make({.force_gain = 2.0, .force_limit_N = 0.5}, Seconds{tick_s}).value();
  const auto displayed_N = [&](double motor_position_m, double tip_force_N) {
    site.reset();
    return -site.step({.motor_position_m = motor_position_m, .arrival = {.message = {.force_N = tip_force_N}}})
                .motor_force_N;
  };
  EXPECT_DOUBLE_EQ(displayed_N(0.0, 0.2), 0.4);
  EXPECT_DOUBLE_EQ(displayed_N(0.002, 0.0), 0.2);
  EXPECT_DOUBLE_EQ(displayed_N(0.002, 0.2), 0.5);
  EXPECT_DOUBLE_EQ(displayed_N(-0.02, 0.1), -0.5);
}

TEST(FourChannel, AForceGainOfZeroIsRefusedUnlessNoHandForceGoesToTheSlave) {
  ControlParams params;
  params.architecture = "four-channel";
  params.force_gain = 0.0;
  const auto refused = make_sites(params, Seconds{tick_s});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().parameter, "force_gain");
  params.own<FourChannelParams>().hand_force_gain = 0.0;
  EXPECT_TRUE(make_sites(params, Seconds{tick_s}).ok());
}

TEST(FourChannel, AParameterOutOfBoundsIsNamedAsTheFileNamesIt) {
  ControlParams params;
  params.architecture = "four-channel";
  params.own<FourChannelParams>().acceleration.cutoff_Hz = 3000.0;
  const auto refused = make_sites(params, Seconds{tick_s});
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().parameter, "four_channel.acceleration.cutoff_Hz");
}

TEST(FourChannel, AHandForceThatIsNoNumberClosesTheMastersGateAndNothingBrokenIsSent) {
  ControlParams params;
  params.architecture = "four-channel";
  params.own<FourChannelParams>().master_force_loop_gain = 0.5;
  auto sites = make_sites(params, Seconds{tick_s}).value();
  MasterInput broken;
  broken.hand_force_N = std::numeric_limits<double>::quiet_NaN();
  const auto output = sites.master.step(broken);
  EXPECT_EQ(output.motor_force_N, 0.0);
  EXPECT_EQ(sites.master.fault(), GateFault::not_finite);
  ASSERT_TRUE(is_finite(output.message));
  EXPECT_TRUE(std::isfinite(sites.slave.step({.arrival = {.message = output.message, .fresh = true}}).motor_force_N));
  EXPECT_EQ(sites.slave.fault(), GateFault::none);
}

TEST(FourChannel, AMessageThatIsNoNumberClosesTheSlavesGate) {
  ControlParams params;
  params.architecture = "four-channel";
  auto sites = make_sites(params, Seconds{tick_s}).value();
  const Message broken{.force_N = std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(sites.slave.step({.arrival = {.message = broken, .fresh = true}}).motor_force_N, 0.0);
  EXPECT_EQ(sites.slave.fault(), GateFault::not_finite);
}

}  // namespace four_channel_test
}  // namespace tactus::control
