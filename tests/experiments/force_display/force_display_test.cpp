// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/force_display/force_display.hpp>

#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "tests/default_experiment.hpp"
#include "tests/experiments/force_display/scratch.hpp"
#include <gtest/gtest.h>

namespace tactus::experiments {
namespace force_display_test {

using control::ModelFriction;

class Display : public Scratch {
 protected:
  static ForceDisplayParams default_params() { return experiment_file<ForceDisplayParams>("force-display"); }

  /// An impact as a force sensor records it: a half-sine of 8 ms at 2 kHz, after 20 ms of nothing.
  ForceDisplayParams impact_params() const {
    std::ostringstream text;
    text << "time [ms],force [N]\n";
    for (int i = 0; i < 300; ++i) {
      const double time_ms = 0.5 * i;
      const bool hit = time_ms > 20.0 && time_ms < 28.0;
      text << time_ms << "," << (hit ? 4.2 * std::sin(std::numbers::pi * (time_ms - 20.0) / 8.0) : 0.0) << "\n";
    }
    ForceDisplayParams params = default_params();
    params.profile.file = write("impact.csv", text.str());
    params.profile.variable = "force";
    params.profile.duration_s = 0.1;
    return params;
  }

  static ForceDisplay made(const ForceDisplayParams& params) {
    auto display = ForceDisplay::make(params);
    EXPECT_TRUE(display) << (display ? "" : describe(display.error()));
    return *std::move(display);
  }
};

ForceDisplayCase find(const std::vector<ForceDisplayCase>& cases, double scale, ModelFriction friction,
                      bool mismatched) {
  for (const ForceDisplayCase& one : cases) {
    if (one.scale == scale && one.friction == friction && one.mismatched == mismatched) return one;
  }
  ADD_FAILURE() << "no such case";
  return {};
}

TEST_F(Display, PlaysThreeScalesTwoFrictionsAndTwoModels) {
  const auto cases = made(default_params()).cases();
  EXPECT_EQ(cases.size(), 12U);
  for (const double scale : {0.25, 0.5, 1.0}) {
    for (const ModelFriction friction : {ModelFriction::at_rest, ModelFriction::total_velocity}) {
      for (const bool mismatched : {false, true}) {
        const auto one = find(cases, scale, friction, mismatched);
        EXPECT_TRUE(std::isfinite(one.kept_fraction));
        EXPECT_GT(one.induced_rms_m, 0.0);
      }
    }
  }
}

TEST_F(Display, OfAnImpactFrictionOnTotalVelocityKeepsNoMoreThanFifteenPercentAtHalfAndFullScale) {
  const auto cases = made(impact_params()).cases();
  for (const double scale : {0.5, 1.0}) {
    EXPECT_LE(find(cases, scale, ModelFriction::total_velocity, false).kept_fraction, 0.15) << scale;
  }
}

TEST_F(Display, OfASmallImpactFrictionAtRestKeepsClearlyMore) {
  const auto cases = made(impact_params()).cases();
  const double at_rest = find(cases, 0.25, ModelFriction::at_rest, false).kept_fraction;
  const double total = find(cases, 0.25, ModelFriction::total_velocity, false).kept_fraction;
  EXPECT_GT(at_rest, 1.3 * total);
  // The share that friction spoils falls as the force grows: friction itself does not grow.
  EXPECT_GT(at_rest, find(cases, 1.0, ModelFriction::at_rest, false).kept_fraction);
}

TEST_F(Display, AMismatchedModelKeepsMore) {
  for (const auto& params : {default_params(), impact_params()}) {
    const auto cases = made(params).cases();
    for (const double scale : {0.5, 1.0}) {
      EXPECT_GT(find(cases, scale, ModelFriction::total_velocity, true).kept_fraction,
                1.5 * find(cases, scale, ModelFriction::total_velocity, false).kept_fraction);
    }
  }
}

TEST_F(Display, BeforeTheForceBeginsTheEstimateIsTheMeasurement) {
  // 20 ms of the recording are silent: nothing is taken away, nothing is added.
  for (const ForceDisplayTrace& trace : made(impact_params()).traces()) {
    for (std::size_t i = 0; i < 90; ++i) {
      ASSERT_EQ(trace.force_N[i], 0.0);
      ASSERT_EQ(trace.estimate_m[i], trace.measured_m[i]) << i;
      ASSERT_NEAR(trace.measured_m[i], trace.without_m[i], 0.51e-5) << "more than half a count of the encoder";
    }
  }
}

TEST_F(Display, TracesShowTheForceAsPlayedPushingTheHandBack) {
  const auto traces = made(impact_params()).traces();
  ASSERT_EQ(traces.size(), 3U);
  for (const ForceDisplayTrace& trace : traces) {
    EXPECT_NEAR(trace.force_N[120], trace.scale, 1e-3);  // 24 ms, the top
    EXPECT_DOUBLE_EQ(trace.time_s[120], 0.024);
    // At the end of the pulse the motor is behind where it would be, and the estimate is not.
    const double induced_m = trace.measured_m[140] - trace.without_m[140];
    EXPECT_LT(induced_m, -2e-5);
    EXPECT_LT(std::fabs(trace.estimate_m[140] - trace.without_m[140]), 0.4 * std::fabs(induced_m));
  }
}

TEST_F(Display, TheEncodersOwnNoiseIsThatOfEvenRounding) {
  ForceDisplayParams params = default_params();
  // A speed that falls on no whole number of counts a tick.
  params.task.speed_m_per_s = 0.137;
  for (const ForceDisplayCase& one : made(params).cases()) {
    // Rounding to steps of 10 um is off by 10/sqrt(12) um RMS; above 20 Hz lies nearly all of it.
    EXPECT_NEAR(one.encoder_fraction * one.induced_rms_m, 1e-5 / std::sqrt(12.0), 0.2e-6);
  }
  params.master.encoder.resolution_m = 0.0;
  for (const ForceDisplayCase& one : made(params).cases()) EXPECT_EQ(one.encoder_fraction, 0.0);
}

TEST_F(Display, OfALinearMasterAPerfectModelKeepsNextToNothing) {
  // Without friction, hysteresis and rounding superposition holds, and what is left is the model's longer step.
  ForceDisplayParams params = default_params();
  params.master.encoder.resolution_m = 0.0;
  params.person.tremor_amplitude_m = 0.0;
  params.servo.computation_delay_s = 0.0;
  params.master.amplifier.bandwidth_Hz = 20000.0;
  params.master.mechanism.motor.friction_N = params.control.model.motor.friction_N = 0.0;
  params.master.mechanism.drum.friction_N = params.control.model.drum.friction_N = 0.0;
  params.master.mechanism.linkage.hysteretic_fraction = params.control.model.linkage.hysteretic_fraction = 0.0;
  for (const ForceDisplayCase& one : made(params).cases()) {
    if (one.mismatched) {
      EXPECT_GT(one.kept_fraction, 0.2);
    } else {
      EXPECT_LT(one.kept_fraction, 0.02) << one.scale << name_of(one.friction);
    }
  }
}

TEST_F(Display, OfALinearMasterTheInducedMotionIsProportionalToTheForce) {
  ForceDisplayParams params = default_params();
  params.master.mechanism.motor.friction_N = 0.0;
  params.master.mechanism.drum.friction_N = 0.0;
  params.master.mechanism.linkage.hysteretic_fraction = 0.0;
  const auto cases = made(params).cases();
  const double full = find(cases, 1.0, ModelFriction::at_rest, false).induced_rms_m;
  EXPECT_NEAR(find(cases, 0.5, ModelFriction::at_rest, false).induced_rms_m / full, 0.5, 1e-6);
  EXPECT_NEAR(find(cases, 0.25, ModelFriction::at_rest, false).induced_rms_m / full, 0.25, 1e-6);
}

TEST_F(Display, ATremorAtTheEndOfItsBoundsIsFineHoweverItsDrawsFall) {
  for (const double frequency_Hz : {1.0, 30.0}) {
    ForceDisplayParams params = default_params();
    params.person.tremor_frequency_Hz = frequency_Hz;
    EXPECT_EQ(made(params).cases().size(), 12U);
  }
}

TEST_F(Display, NamesTheKeyThatCannotBe) {
  const auto refused_key = [](auto&& change) {
    ForceDisplayParams params = default_params();
    change(params);
    const auto display = ForceDisplay::make(params);
    return display ? std::string("was made") : display.error().parameter;
  };
  EXPECT_EQ(refused_key([](auto& p) { p.person.grip.stiffness_N_per_m = 1e12; }), "operator.grip.stiffness_N_per_m");
  EXPECT_EQ(refused_key([](auto& p) { p.master.mechanism.cable.stiffness_N_per_m = 1e12; }),
            "master.mechanism.cable.stiffness_N_per_m");
  EXPECT_EQ(refused_key([](auto& p) {
              p.control.cancellation_step = control::CancellationStep::euler;
              p.control.model.cable.stiffness_N_per_m = 1e9;
            }),
            "control.cancellation_step");
  EXPECT_EQ(refused_key([](auto& p) { p.task.force_limit_N = -1.0; }), "task.force_limit_N");
  EXPECT_EQ(refused_key([](auto& p) { p.servo.computation_delay_s = 2e-4; }), "servo.computation_delay_s");
}

}  // namespace force_display_test
}  // namespace tactus::experiments
