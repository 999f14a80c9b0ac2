// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/inverse_dynamics.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

namespace tactus::identification {
namespace inverse_dynamics_test {

constexpr double inertia = 1.5e-3;
constexpr double viscous = 4e-3;
constexpr double coulomb = 0.03;
constexpr double offset = -0.01;

/// A lever on a PD servo that follows a sum of sines, integrated at 20 times the sample rate; friction with exact
/// sticking, an encoder, noise on the torque. Nothing of it is shared with the fit.
struct Rig {
  double sample_rate_Hz = 2000.0;
  double duration_s = 6.0;
  double encoder_step = 2e-5;
  double torque_noise = 2e-3;
  double spring = 0.0;  ///< what the lever works against, in N m/rad
  unsigned seed = 1;
};

AxisSignals record(const Rig& rig) {
  std::mt19937 random(rig.seed);
  std::normal_distribution<double> noise(0.0, rig.torque_noise);
  std::uniform_real_distribution<double> any_phase(0.0, 2.0 * std::numbers::pi);
  const double first = any_phase(random);
  const double second = any_phase(random);
  const double third = any_phase(random);
  AxisSignals signals;
  signals.sample_time = Seconds{1.0 / rig.sample_rate_Hz};
  constexpr int substeps = 20;
  const double h = signals.sample_time.value / substeps;
  double x = 0.0;
  double v = 0.0;
  const auto samples = static_cast<std::size_t>(rig.duration_s * rig.sample_rate_Hz);
  for (std::size_t i = 0; i < samples; ++i) {
    double torque = 0.0;
    for (int k = 0; k < substeps; ++k) {
      const double t = (static_cast<double>(i) + static_cast<double>(k) / substeps) * signals.sample_time.value;
      const double w = 2.0 * std::numbers::pi;
      const double wanted = 0.05 * std::sin(0.9 * w * t + first) + 0.03 * std::sin(2.3 * w * t + second) +
                            0.01 * std::sin(5.1 * w * t + third);
      torque = 6.0 * (wanted - x) - 0.08 * v;
      if (k == 0) {
        signals.position.push_back(rig.encoder_step * std::round(x / rig.encoder_step));
        signals.force.push_back(torque + noise(random));
      }
      const double drive = torque - offset - viscous * v - rig.spring * x;
      const double free = v + h * drive / inertia;
      const double most = h * coulomb / inertia;
      v = std::abs(free) <= most ? 0.0 : free - std::copysign(most, free);
      x += h * v;
    }
  }
  return signals;
}

std::string refusal(const AxisSignals& signals) {
  const auto model = fit_inverse_dynamics(signals);
  return model ? "a model" : model.error().message;
}

bool says(std::string_view message, std::string_view words) { return message.find(words) != std::string_view::npos; }

TEST(InverseDynamics, a_simulated_lever_gives_its_own_inertia_and_friction) {
  for (const double rate : {500.0, 2000.0, 5000.0}) {
    const auto model = fit_inverse_dynamics(record({.sample_rate_Hz = rate}));
    ASSERT_TRUE(model) << model.error().message;
    EXPECT_NEAR(model->inertia.value, inertia, 0.03 * inertia) << rate;
    EXPECT_NEAR(model->coulomb.value, coulomb, 0.1 * coulomb) << rate;
    EXPECT_NEAR(model->offset.value, offset, 0.002) << rate;
    EXPECT_GT(model->explained, 0.95) << rate;
  }
}

TEST(InverseDynamics, intervals_hold_the_true_inertia_although_the_residual_is_coloured) {
  int held = 0;
  constexpr int runs = 40;
  for (unsigned seed = 1; seed <= runs; ++seed) {
    const auto model = fit_inverse_dynamics(record({.sample_rate_Hz = 1000.0, .seed = seed}));
    ASSERT_TRUE(model) << model.error().message;
    if (model->inertia.lower <= inertia && inertia <= model->inertia.upper) ++held;
    EXPECT_LT(model->inertia.upper - model->inertia.lower, 0.2 * inertia);
  }
  EXPECT_GE(held, 34);
}

TEST(InverseDynamics, instruments_keep_the_inertia_where_a_coarse_encoder_pulls_least_squares_down) {
  const auto model = fit_inverse_dynamics(record({.sample_rate_Hz = 500.0, .encoder_step = 2e-3}));
  ASSERT_TRUE(model) << model.error().message;
  EXPECT_LT(std::abs(model->inertia.value - inertia), std::abs(model->least_squares[0] - inertia));
}

TEST(InverseDynamics, a_force_of_the_wrong_sign_is_told_so) {
  auto signals = record({});
  for (double& force : signals.force) force = -force;
  EXPECT_TRUE(says(refusal(signals), "--force-sign")) << refusal(signals);
}

TEST(InverseDynamics, swapped_columns_give_no_model) {
  auto signals = record({});
  std::swap(signals.force, signals.position);
  EXPECT_TRUE(says(refusal(signals), "swapped")) << refusal(signals);
}

TEST(InverseDynamics, a_constant_signal_gives_no_model) {
  auto signals = record({});
  std::fill(signals.position.begin(), signals.position.end(), 0.25);
  EXPECT_TRUE(says(refusal(signals), "position is constant")) << refusal(signals);
}

TEST(InverseDynamics, samples_that_are_missing_give_no_model) {
  auto signals = record({});
  for (auto* column : {&signals.position, &signals.force}) {
    column->erase(column->begin() + 3000, column->begin() + 3400);
  }
  EXPECT_TRUE(says(refusal(signals), "jumps")) << refusal(signals);
}

TEST(InverseDynamics, a_sample_that_is_no_number_gives_no_model) {
  auto signals = record({});
  signals.force[77] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(says(refusal(signals), "finite")) << refusal(signals);
}

TEST(InverseDynamics, a_recording_that_is_too_short_gives_no_model) {
  auto signals = record({.duration_s = 0.3});
  EXPECT_TRUE(says(refusal(signals), "too short")) << refusal(signals);
}

TEST(InverseDynamics, motion_in_one_direction_gives_no_model) {
  const auto signals = record({.duration_s = 6.0});
  AxisSignals cut = signals;
  const auto slowest = static_cast<std::size_t>(2000);
  cut.position.resize(slowest);
  cut.force.resize(slowest);
  for (std::size_t i = 0; i < slowest; ++i) cut.position[i] = 1e-4 * static_cast<double>(i);
  EXPECT_TRUE(says(refusal(cut), "turns round")) << refusal(cut);
}

TEST(InverseDynamics, a_sample_time_in_milliseconds_gives_no_model) {
  auto signals = record({});
  signals.sample_time = Seconds{0.5};
  EXPECT_TRUE(says(refusal(signals), "--sample-time-s")) << refusal(signals);
}

TEST(InverseDynamics, a_lever_on_a_spring_gives_no_model) {
  const auto signals = record({.spring = 3.0});
  EXPECT_TRUE(says(refusal(signals), "follows the position")) << refusal(signals);
}

TEST(InverseDynamics, a_force_that_has_nothing_to_do_with_the_motion_gives_no_model) {
  auto signals = record({});
  std::mt19937 random(4);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (double& force : signals.force) force = noise(random);
  EXPECT_FALSE(fit_inverse_dynamics(signals)) << refusal(signals);
}

}  // namespace inverse_dynamics_test
}  // namespace tactus::identification
