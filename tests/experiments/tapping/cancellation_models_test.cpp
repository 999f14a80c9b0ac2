// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <vector>

#include "tests/default_experiment.hpp"
#include <gtest/gtest.h>

// What the fidelity of the cancelling model decides in the closed loop: docs/theory/cancellation-models.md.
namespace tactus::experiments {
namespace cancellation_models_test {

using control::CancellationMode;
using control::ModelFidelity;

TappingMetrics taps(double force_gain, CancellationMode mode, ModelFidelity fidelity) {
  auto params = experiment_file<TappingParams>("tapping");
  params.control.force_gain = force_gain;
  params.control.cancellation = mode;
  params.control.cancellation_model = fidelity;
  const auto ensemble = TappingEnsemble::make(params).value();
  std::vector<TapResult> results;
  for (std::size_t i = 0; i < ensemble.size(); ++i) results.push_back(ensemble.run(i));
  return summarise(results);
}

TEST(CancellationModels, TheLinkageIsWhatALinearModelMustHave) {
  const auto without = taps(3.0, CancellationMode::off, ModelFidelity::second_order);
  const auto second = taps(3.0, CancellationMode::on, ModelFidelity::second_order);
  EXPECT_GT(second.settled_fraction, without.settled_fraction + 0.3);
  EXPECT_LT(second.settled_fraction, 0.95);
  for (const double force_gain : {3.0, 15.0}) {
    const auto fourth = taps(force_gain, CancellationMode::on, ModelFidelity::fourth_order);
    EXPECT_EQ(fourth.settled_fraction, 1.0) << force_gain;
    EXPECT_LT(fourth.settling_time_median_s, 0.05) << force_gain;
  }
}

/// The force in N on the wall at the end of a long press into it, with the displayed force at its limit.
double pressed_N(double stiffening) {
  simulation::Teleoperator::Params params = experiment_file<TappingParams>("tapping");
  params.person.tremor_amplitude_m = 0.0;
  params.person.correction.gain_per_s = 0.0;
  params.slave.force_sensor.noise_rms_N = 0.0;
  for (auto* chain : {&params.master.mechanism, &params.slave.mechanism}) {
    chain->motor.friction_N = 0.0;
    chain->drum.friction_N = 0.0;
    chain->linkage.hysteretic_fraction = 0.0;
  }
  params.control.force_gain = 15.0;
  params.control.cancellation_model = ModelFidelity::fourth_order;
  params.control.model.linear_hand_stiffening = stiffening;
  const mechanics::MinimumJerk press{.start_m = -0.008, .end_m = 0.05, .start_time_s = 0.02, .duration_s = 0.5};
  auto teleoperator = simulation::Teleoperator::make(params, press.start_m).value();
  simulation::Teleoperator::Record last;
  for (int tick = 0; tick < 20000; ++tick) {
    const double time_s = tick * teleoperator.tick_s();
    last = teleoperator.step(press.position_m(time_s), press.position_m(time_s + teleoperator.tick_s()));
  }
  EXPECT_EQ(last.displayed_force_N, params.control.force_limit_N);
  return last.contact_force_N;
}

TEST(CancellationModels, WhatALinearModelAddsToASlowPushIsTheServosStiffnessTimesTheModelsDeflection) {
  // The handle is where person and displayed force hold it, whatever the model says; the model's deflection is added to
  // the command, and the slave's 100 N/m make a force of it, through its own springs and the wall's.
  const double servo_N_per_m = 1.0 / (1.0 / 100.0 + 1.0 / 39500.0 + 1.0 / 3950.0 + 1.0 / 40000.0);
  const double own_N = pressed_N(1.0), stiffened_N = pressed_N(10.0);
  EXPECT_NEAR(own_N - stiffened_N, servo_N_per_m * (1.0 / 40.0 - 1.0 / 400.0), 0.01);
}

}  // namespace cancellation_models_test
}  // namespace tactus::experiments
