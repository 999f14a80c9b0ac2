// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/control/estimators/slave_force.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::control {
namespace slave_force_test {

static_assert(Element<SlaveForce>);

constexpr double tick_s = 200e-6;
constexpr std::array estimators{SlaveForceSource::inverse_model, SlaveForceSource::disturbance_observer,
                                SlaveForceSource::momentum_observer, SlaveForceSource::kalman};

/// Every estimator told the truth about a rigid body of 0.05 kg without friction.
SlaveForce::Params exact(SlaveForceSource source) {
  const SlaveModel body{.mass_kg = 0.05};
  SlaveForce::Params params;
  params.source = source;
  params.inverse_model.mass_kg = body.mass_kg;
  params.inverse_model.friction = {};
  params.disturbance_observer.model = body;
  params.momentum_observer.model = body;
  params.kalman.model = body;
  return params;
}

/// That body, held forces, integrated in closed form; it starts away from zero.
struct Body {
  double position_m = 0.3;
  double velocity_m_per_s = 0.0;
  void step(double force_N) {
    const double acceleration = force_N / 0.05;
    position_m += tick_s * (velocity_m_per_s + 0.5 * tick_s * acceleration);
    velocity_m_per_s += tick_s * acceleration;
  }
};

SlaveForce make(const SlaveForce::Params& params) { return SlaveForce::make(params, Seconds{tick_s}).value(); }

TEST(SlaveForce, TheSensorsReadingPassesUnchanged) {
  SlaveForce force = make({});
  for (const double reading_N : {0.0, -0.0, 1e-300, 0.1, -7.0, 1e300}) {
    EXPECT_EQ(force.step({.acted_N = 3.0, .motor_position_m = 0.2, .tip_force_N = reading_N}), reading_N);
  }
}

TEST(SlaveForce, WhatHoldsAPushedBodyInPlaceIsAPositiveTipForceOfThatSize) {
  for (const SlaveForceSource source : estimators) {
    SlaveForce force = make(exact(source));
    double told_N = 0.0;
    // The motor pushes toward the environment, the environment lets nothing move.
    for (int tick = 0; tick < 5000; ++tick) told_N = force.step({.acted_N = 0.7, .motor_position_m = 0.3});
    EXPECT_NEAR(told_N, 0.7, 1e-3) << name_of(source);
  }
}

TEST(SlaveForce, ABodyThatMovesFreelyFeelsNothingWhereverItStarts) {
  for (const SlaveForceSource source : estimators) {
    SlaveForce::Params params = exact(source);
    params.inverse_model.prediction.blocks = 0;
    params.inverse_model.derivative_filter_s = 2e-5;
    SlaveForce force = make(params);
    Body body;
    double largest_N = 0.0;
    double acted_N = 0.0;
    for (int tick = 0; tick < 5000; ++tick) {
      largest_N = std::max(largest_N, std::abs(force.step({.acted_N = acted_N, .motor_position_m = body.position_m})));
      acted_N = 0.5 * std::sin(2.0 * 3.14159265358979 * 2.0 * tick * tick_s);
      body.step(acted_N);
    }
    EXPECT_LT(largest_N, 0.05 * 0.5) << name_of(source);
  }
}

/// The tip force that a slave told while it hung free or was held, its motor driven by `command_m` through a gate.
double largest_false_force(SlaveForceSource source, const SafetyGate::Params& gate, double command_m) {
  ControlParams params;
  params.slave_force = exact(source);
  params.slave_force.inverse_model.prediction.blocks = 0;
  params.slave_force.inverse_model.derivative_filter_s = 2e-5;
  params.slave_gate = gate;
  SlaveSite site = make_sites(params, Seconds{tick_s}).value().slave;
  Body body;
  double largest_N = 0.0;
  for (int tick = 0; tick < 500; ++tick) {
    const SlaveOutput output =
        site.step({.motor_position_m = body.position_m,
                   .tip_force_N = 99.0,
                   .arrival = {.message = {.position_m = tick < 50 ? 0.3 : command_m}, .fresh = true}});
    largest_N = std::max(largest_N, std::abs(output.message.force_N));
    body.step(output.motor_force_N);
  }
  return largest_N;
}

TEST(EstimatingSlave, AGateThatClipsTheCommandDoesNotShowAsFalseForce) {
  // The servo wants 10 N and more at once; the gate gives 0.2 N, and slowly.
  const SafetyGate::Params gate{.force_limit_N = 0.2, .rate_limit_N_per_s = 20.0};
  for (const SlaveForceSource source : estimators) {
    EXPECT_LT(largest_false_force(source, gate, 0.4), 0.1 * 0.2) << name_of(source);
  }
}

TEST(EstimatingSlave, ACopyContinuesWithTheForceThatActedLast) {
  ControlParams params;
  params.slave_force.source = SlaveForceSource::momentum_observer;
  SlaveSite site = make_sites(params, Seconds{tick_s}).value().slave;
  const auto input = [](int tick) {
    return SlaveInput{.motor_position_m = 1e-3 * std::sin(0.01 * tick),
                      .arrival = {.message = {.position_m = 2e-3}, .fresh = true}};
  };
  for (int tick = 0; tick < 100; ++tick) (void)site.step(input(tick));
  SlaveSite copy = site;
  SlaveSite fresh = site;
  fresh.reset();
  const SlaveSite made = make_sites(params, Seconds{tick_s}).value().slave;
  SlaveSite again = made;
  for (int tick = 100; tick < 200; ++tick) {
    ASSERT_EQ(copy.step(input(tick)).message.force_N, site.step(input(tick)).message.force_N);
    ASSERT_EQ(fresh.step(input(tick)).message.force_N, again.step(input(tick)).message.force_N);
  }
}

TEST(Architecture, RefusesAnEstimateThatNobodyWouldListenTo) {
  for (const char* architecture : {"position-position", "wave-variables"}) {
    ControlParams params;
    params.architecture = architecture;
    EXPECT_TRUE(make_sites(params, Seconds{tick_s})) << architecture;
    params.slave_force.source = SlaveForceSource::kalman;
    const auto sites = make_sites(params, Seconds{tick_s});
    ASSERT_FALSE(sites) << architecture;
    EXPECT_EQ(sites.error().parameter, "slave_force.source");
    EXPECT_NE(sites.error().message.find(architecture), std::string::npos);
  }
}

TEST(Architecture, NamesTheKeyOfTheEstimatorThatCannotBe) {
  ControlParams params;
  params.slave_force.source = SlaveForceSource::disturbance_observer;
  params.slave_force.disturbance_observer.cutoff_Hz = 2400.0;
  const auto sites = make_sites(params, Seconds{tick_s});
  ASSERT_FALSE(sites);
  EXPECT_EQ(sites.error().parameter, "slave_force.disturbance_observer.cutoff_Hz");
}

}  // namespace slave_force_test
}  // namespace tactus::control
