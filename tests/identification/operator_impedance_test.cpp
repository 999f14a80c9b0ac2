// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/operator_impedance.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::identification {
namespace operator_impedance_test {

/// A person holds a rubbing master and moves it slowly while the motor gives it jolts, integrated at 10 kHz and
/// recorded at 1 kHz. Nothing of it is shared with the estimate.
struct Person {
  double stiffness_N_per_m = 300.0;
  double damping_N_s_per_m = 8.0;
  double mass_kg = 0.06;
  double firmer = 1.0;  ///< factor of stiffness and damping from half time on
  double intention = 1.0;
  double tremor_m = 0.0;  ///< of the intended position, at 11 and 17 Hz
  double jolt_N = 4.0;
  double last_jolt_s = 1e9;
  double friction_N = 0.1;  ///< of the device
  double duration_s = 10.0;
  double encoder_step_m = 2e-6;
  double force_noise_N = 0.01;
  unsigned seed = 1;
};

constexpr double device_mass_kg = 0.05;
constexpr double device_damping_N_s_per_m = 0.5;

AxisSignals record(const Person& person) {
  std::mt19937 random(person.seed);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::uniform_real_distribution<double> unit(0.0, 1.0);
  struct Wave {
    double amplitude_m, rad_per_s, phase;
  };
  std::vector<Wave> intended;
  for (const auto& [amplitude_m, frequency_Hz] :
       {std::pair{0.02 * person.intention, 0.37}, std::pair{0.008 * person.intention, 1.1},
        std::pair{0.002 * person.intention, 2.1}, std::pair{person.tremor_m, 11.0}, std::pair{person.tremor_m, 17.0}}) {
    const double w = 2.0 * std::numbers::pi * frequency_Hz;
    intended.push_back({amplitude_m, w, 2.0 * std::numbers::pi * unit(random)});
  }
  AxisSignals signals;
  signals.sample_time = Seconds{1e-3};
  constexpr int substeps = 10;
  constexpr double h = 1e-3 / substeps;
  const auto samples = static_cast<std::size_t>(person.duration_s / signals.sample_time.value);
  double x = 0.0;
  double v = 0.0;
  double jolt_from_s = 0.2;
  double jolt_N = person.jolt_N;
  double jolt_length_s = 0.01;
  for (std::size_t i = 0; i < samples * substeps; ++i) {
    const double t = h * static_cast<double>(i);
    if (t > jolt_from_s + jolt_length_s) {
      jolt_from_s = t + 0.02 + 0.15 * unit(random);
      jolt_N = person.jolt_N * (2.0 * unit(random) - 1.0);
      jolt_length_s = 0.006 + 0.03 * unit(random);
    }
    const bool jolted = t > jolt_from_s && jolt_from_s < person.last_jolt_s;
    const double motor = jolted ? jolt_N * std::sin(std::numbers::pi * (t - jolt_from_s) / jolt_length_s) : 0.0;
    double aim = 0.0;
    double aim_speed = 0.0;
    for (const Wave& wave : intended) {
      aim += wave.amplitude_m * std::sin(wave.rad_per_s * t + wave.phase);
      aim_speed += wave.amplitude_m * wave.rad_per_s * std::cos(wave.rad_per_s * t + wave.phase);
    }
    const double grip = t < 0.5 * person.duration_s ? 1.0 : person.firmer;
    const double stiffness = grip * person.stiffness_N_per_m;
    const double damping = grip * person.damping_N_s_per_m;
    const double mass = device_mass_kg + person.mass_kg;
    const double half = 0.5 * h * (damping + device_damping_N_s_per_m);  // damping at the implicit midpoint
    const double drive = motor + stiffness * (aim - x) + damping * aim_speed;
    const double free = ((mass - half) * v + h * drive) / (mass + half);
    const double most = h * person.friction_N / (mass + half);
    const double next = std::abs(free) <= most ? 0.0 : free - std::copysign(most, free);
    if (i % substeps == 0) {
      const double hand =
          stiffness * (aim - x) + damping * (aim_speed - 0.5 * (v + next)) - person.mass_kg * (next - v) / h;
      signals.position.push_back(person.encoder_step_m * std::round(x / person.encoder_step_m));
      signals.force.push_back(hand + person.force_noise_N * noise(random));
    }
    v = next;
    x += h * v;
  }
  return signals;
}

bool holds(const Estimate& estimate, double truth) { return estimate.lower <= truth && truth <= estimate.upper; }

bool tells_anything(const OperatorImpedance& found) {
  return found.determined(found.stiffness) || found.determined(found.damping) || found.determined(found.mass);
}

std::string refusal(const AxisSignals& signals, const OperatorImpedanceOptions& options = {}) {
  const auto found = estimate_operator_impedance(signals, options);
  return found ? "an estimate" : found.error().message;
}

bool says(std::string_view message, std::string_view words) { return message.find(words) != std::string_view::npos; }

TEST(OperatorImpedance, a_hand_that_is_jolted_shows_its_own_stiffness_damping_and_mass) {
  const auto found = estimate_operator_impedance(record({}));
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_TRUE(found->whole.determined(found->whole.stiffness));
  EXPECT_NEAR(found->whole.stiffness.value, 300.0, 30.0);
  EXPECT_NEAR(found->whole.damping.value, 8.0, 0.2);
  EXPECT_NEAR(found->whole.mass.value, 0.06, 0.003);
  EXPECT_GT(found->whole.explained, 0.95);
}

TEST(OperatorImpedance, intervals_hold_the_truth_of_different_hands) {
  int stiffness = 0;
  int damping = 0;
  int mass = 0;
  constexpr int people = 40;
  for (unsigned seed = 1; seed <= people; ++seed) {
    std::mt19937 random(1000 + seed);
    std::uniform_real_distribution<double> factor(0.5, 2.0);
    Person person{.duration_s = 6.0, .force_noise_N = 0.05, .seed = seed};
    person.stiffness_N_per_m *= factor(random);
    person.damping_N_s_per_m *= factor(random);
    person.mass_kg *= factor(random);
    const auto found = estimate_operator_impedance(record(person));
    ASSERT_TRUE(found) << found.error().message;
    stiffness += holds(found->whole.stiffness, person.stiffness_N_per_m) ? 1 : 0;
    damping += holds(found->whole.damping, person.damping_N_s_per_m) ? 1 : 0;
    mass += holds(found->whole.mass, person.mass_kg) ? 1 : 0;
  }
  EXPECT_GE(stiffness, 34);
  EXPECT_GE(damping, 34);
  EXPECT_GE(mass, 34);
}

TEST(OperatorImpedance, a_grip_that_becomes_firmer_is_followed) {
  const auto found = estimate_operator_impedance(record({.firmer = 3.0}));
  ASSERT_TRUE(found) << found.error().message;
  for (const OperatorImpedance& window : found->windows) {
    if (window.from_s < 5.0 && window.to_s > 5.0) continue;
    const double grip = window.to_s <= 5.0 ? 1.0 : 3.0;
    ASSERT_TRUE(window.determined(window.damping)) << window.from_s;
    EXPECT_NEAR(window.damping.value, 8.0 * grip, 0.1 * 8.0 * grip) << window.from_s;
  }
}

TEST(OperatorImpedance, after_the_last_jolt_nothing_is_determined) {
  const auto found = estimate_operator_impedance(record({.last_jolt_s = 5.0, .friction_N = 0.0}));
  ASSERT_TRUE(found) << found.error().message;
  int quiet = 0;
  for (const OperatorImpedance& window : found->windows) {
    if (window.to_s <= 5.0) {
      EXPECT_TRUE(window.determined(window.damping)) << window.from_s;
    } else if (window.from_s > 5.5) {
      EXPECT_FALSE(tells_anything(window)) << window.from_s;
      ++quiet;
    }
  }
  EXPECT_GE(quiet, 4);
}

TEST(OperatorImpedance, friction_that_lets_go_of_the_device_is_excitation_enough) {
  const auto found = estimate_operator_impedance(record({.jolt_N = 0.0}));
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_TRUE(found->whole.determined(found->whole.damping));
  EXPECT_TRUE(holds(found->whole.damping, 8.0)) << found->whole.damping.lower << " " << found->whole.damping.upper;
}

TEST(OperatorImpedance, a_hand_that_drives_the_device_is_not_taken_for_its_impedance) {
  const auto found = estimate_operator_impedance(record({.tremor_m = 2e-3, .jolt_N = 0.0}));
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->whole.verdict, ImpedanceVerdict::hand_drives);
  EXPECT_FALSE(tells_anything(found->whole));
  for (const OperatorImpedance& window : found->windows) EXPECT_FALSE(tells_anything(window));
}

TEST(OperatorImpedance, a_coarse_encoder_does_not_pull_the_mass_down) {
  const auto found = estimate_operator_impedance(record({.encoder_step_m = 1e-4}));
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->whole.mass.value, 0.06, 0.006);
}

TEST(OperatorImpedance, a_force_of_twice_the_size_is_of_twice_the_impedance) {
  auto signals = record({});
  const auto once = estimate_operator_impedance(signals);
  for (double& force : signals.force) force *= 2.0;
  const auto twice = estimate_operator_impedance(signals);
  ASSERT_TRUE(once && twice);
  EXPECT_NEAR(twice->whole.stiffness.value, 2.0 * once->whole.stiffness.value, 1e-6 * 600.0);
  EXPECT_NEAR(twice->whole.mass.upper, 2.0 * once->whole.mass.upper, 1e-6 * 0.12);
}

TEST(OperatorImpedance, a_force_of_the_wrong_sign_is_told_so_whether_the_hand_drives_or_is_driven) {
  for (const Person& person : {Person{}, Person{.tremor_m = 2e-3, .jolt_N = 0.0}}) {
    auto signals = record(person);
    for (double& force : signals.force) force = -force;
    EXPECT_TRUE(says(refusal(signals), "--force-sign -1")) << refusal(signals);
  }
}

TEST(OperatorImpedance, a_resting_hand_that_is_shaken_is_judged_when_the_sign_is_stated) {
  const auto signals = record({.intention = 0.0});
  EXPECT_TRUE(says(refusal(signals), "--force-sign 1")) << refusal(signals);
  const auto found = estimate_operator_impedance(signals, {.doubt_sign = false});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_NEAR(found->whole.damping.value, 8.0, 0.4);
}

TEST(OperatorImpedance, swapped_columns_are_told_so) {
  auto signals = record({});
  std::swap(signals.position, signals.force);
  EXPECT_TRUE(says(refusal(signals), "swapped")) << refusal(signals);
}

TEST(OperatorImpedance, a_bad_recording_gives_a_message) {
  const auto good = record({.duration_s = 4.0});
  auto bad = good;
  bad.force[100] = std::nan("");
  EXPECT_TRUE(says(refusal(bad), "finite")) << refusal(bad);
  bad = good;
  std::fill(bad.position.begin(), bad.position.end(), 0.1);
  EXPECT_TRUE(says(refusal(bad), "constant")) << refusal(bad);
  bad = good;
  for (std::size_t i = 2000; i < bad.position.size(); ++i) bad.position[i] += 0.05;
  EXPECT_TRUE(says(refusal(bad), "jumps")) << refusal(bad);
  bad = good;
  bad.sample_time = Seconds{1.0};
  EXPECT_TRUE(says(refusal(bad), "--sample-time-s")) << refusal(bad);
  bad = good;
  bad.sample_time = Seconds{0.01};
  EXPECT_TRUE(says(refusal(bad), "sample rate")) << refusal(bad);
  EXPECT_TRUE(says(refusal(record({.duration_s = 1.9})), "too short"));
}

TEST(OperatorImpedance, a_band_or_window_that_cannot_be_is_refused) {
  const auto signals = record({.duration_s = 3.0});
  for (const OperatorImpedanceOptions& options :
       {OperatorImpedanceOptions{.lower_Hz = 0.0}, OperatorImpedanceOptions{.lower_Hz = std::nan("")},
        OperatorImpedanceOptions{.upper_Hz = 10.0}, OperatorImpedanceOptions{.upper_Hz = 400.0},
        OperatorImpedanceOptions{.window_s = 0.5}, OperatorImpedanceOptions{.window_s = std::nan("")}}) {
    const auto found = estimate_operator_impedance(signals, options);
    ASSERT_FALSE(found);
    EXPECT_EQ(found.error().code, ErrorCode::out_of_bounds);
  }
}

}  // namespace operator_impedance_test
}  // namespace tactus::identification
