// SPDX-License-Identifier: Apache-2.0
// How far the online estimate of a hand is from what its signals hold. Run alone, it prints the table of
// docs/theory/changing-grip.md:
//
//   build/release/bin/test_control --gtest_filter='GripEstimateBound.*'
#include <tactus/kernel/control/stages/grip_cancellation.hpp>
#include <tactus/kernel/signal/random.hpp>
#include <tactus/kernel/signal/second_order_filter.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::control {
namespace grip_estimate_bound_test {

constexpr double tick_s = 200e-6;
constexpr double encoder_m = 1e-5;
constexpr std::size_t draws = 200;
constexpr std::array looked_at_s{0.005, 0.01, 0.02};
constexpr std::size_t looks = looked_at_s.size();
constexpr std::size_t ticks = 250;
/// What the estimator knows before anything is displayed, as standard deviations of mobility and linkage.
constexpr double prior_mobility = 2.0, prior_linkage = 0.05;

/// The hand of a draw, and what the model has wrong beside it.
struct Truth {
  double mobility = 1.0, linkage = 0.0;
  std::array<double, 4> wrong{};  ///< shares of motor, drum, cable and handle
};

MasterModel master_of(const Truth& truth) {
  MasterModel master;
  master.hand.quintic_stiffness_N_per_m5 = 0.0;
  master.hand.stiffness_N_per_m /= truth.mobility;
  master.hand.damping_N_s_per_m /= truth.mobility;
  master.linkage.stiffness_N_per_m *= 1.0 + truth.linkage;
  master.motor.mass_kg *= 1.0 + truth.wrong[0];
  master.drum.mass_kg *= 1.0 + truth.wrong[1];
  master.cable.stiffness_N_per_m *= 1.0 + truth.wrong[2];
  master.handle.mass_kg *= 1.0 + truth.wrong[3];
  return master;
}

/// Where these forces move the motor, in m, at each tick.
std::vector<double> motion_m(const Truth& truth, const std::vector<double>& forces_N) {
  auto master = InducedMotionModel::make({.master = master_of(truth)}, Seconds{tick_s}).value();
  std::vector<double> path_m;
  for (const double force_N : forces_N) {
    path_m.push_back(master.motor_position_m());
    master.step({.motor_force_N = force_N});
  }
  return path_m;
}

/// An impact as a display of 10 N shows it: it rings down and leans.
std::vector<double> impact_N(signal::Random& draw) {
  const double first_N = draw.uniform(4.0, 10.0), frequency_Hz = draw.uniform(60.0, 120.0);
  const double decay_s = draw.uniform(0.01, 0.02), leaning_N = draw.uniform(0.5, 2.0);
  std::vector<double> forces_N(ticks);
  for (std::size_t i = 0; i < ticks; ++i) {
    const double time_s = static_cast<double>(i) * tick_s;
    const double ring = std::exp(-time_s / decay_s) * std::sin(2.0 * std::numbers::pi * frequency_Hz * time_s);
    forces_N[i] = -std::clamp(leaning_N * (1.0 - std::exp(-time_s / 0.01)) + first_N * ring, 0.0, 10.0);
  }
  return forces_N;
}

/// What is above 40 Hz of how a change of one parameter moves the motor, in m for a unit of it: by simulation, not by
/// the tangents of the estimator.
std::vector<double> slope_m(Truth truth, double Truth::*parameter, const std::vector<double>& forces_N) {
  constexpr double change = 1e-3;
  auto high_pass =
      signal::SecondOrderFilter::make(
          {.kind = signal::FilterKind::high_pass, .frequency_Hz = 40.0, .notch_width_Hz = 1.0}, Seconds{tick_s})
          .value();
  truth.*parameter += change;
  const auto above = motion_m(truth, forces_N);
  truth.*parameter -= 2.0 * change;
  const auto below = motion_m(truth, forces_N);
  std::vector<double> slope(ticks);
  for (std::size_t i = 0; i < ticks; ++i) slope[i] = high_pass.step((above[i] - below[i]) / (2.0 * change));
  return slope;
}

/// Standard deviation of the mobility that no unbiased estimate of both numbers goes below, the prior counted in, from
/// samples with the white noise of the encoder's steps (van Trees).
std::array<double, looks> bound(const Truth& truth, const std::vector<double>& forces_N) {
  const auto hand = slope_m(truth, &Truth::mobility, forces_N), linkage = slope_m(truth, &Truth::linkage, forces_N);
  const double variance_m2 = encoder_m * encoder_m / 12.0;
  double hh = 1.0 / (prior_mobility * prior_mobility), ll = 1.0 / (prior_linkage * prior_linkage), hl = 0.0;
  std::array<double, looks> deviation{};
  for (std::size_t i = 0; i < ticks; ++i) {
    hh += hand[i] * hand[i] / variance_m2;
    hl += hand[i] * linkage[i] / variance_m2;
    ll += linkage[i] * linkage[i] / variance_m2;
    for (std::size_t look = 0; look < looks; ++look) {
      if (i == static_cast<std::size_t>(std::lround(looked_at_s[look] / tick_s)))
        deviation[look] = std::sqrt(ll / (hh * ll - hl * hl));
    }
  }
  return deviation;
}

struct Found {
  std::array<double, looks> error{};      ///< root mean square over the draws of mobility, over the true one
  std::array<double, looks> bound{};      ///< the same of the bound
  std::array<double, looks> deviation{};  ///< that the estimator itself tells, over the true mobility
  double within_s = 0.0;                  ///< median time from which on the estimate is within 20 %
};

/// Over 200 hands of 1/4 to 4 times the mobility and linkages within 5 %; `wrong` is how far off the model's masses and
/// cable are, at most.
Found estimate(double wrong) {
  signal::Random draw(7);
  Found found;
  std::vector<double> within_s;
  for (std::size_t n = 0; n < draws; ++n) {
    Truth truth{.mobility = std::exp2(draw.uniform(-2.0, 2.0)), .linkage = draw.uniform(-0.05, 0.05)};
    for (double& share : truth.wrong) share = wrong * draw.uniform(-1.0, 1.0);
    const auto forces_N = impact_N(draw);
    const auto path_m = motion_m(truth, forces_N);
    const auto least = bound(truth, forces_N);
    const double offset_m = encoder_m * draw.uniform();
    auto cancellation =
        GripCancellation::make({.cancellation = {}, .estimate = OperatorEstimate::online}, Seconds{tick_s}).value();
    std::size_t last_outside = 0;
    for (std::size_t i = 0; i < ticks; ++i) {
      const double measured_m = encoder_m * std::round((path_m[i] + offset_m) / encoder_m);
      (void)cancellation.step({.measured_position_m = measured_m, .motor_force_N = forces_N[i]});
      const HandEstimate hand = cancellation.hand();
      const double mobility = 1.0 / hand.estimated_grip;
      const double error = mobility / truth.mobility - 1.0;
      if (std::fabs(error) > 0.2) last_outside = i + 1;
      for (std::size_t look = 0; look < looks; ++look) {
        if (i != static_cast<std::size_t>(std::lround(looked_at_s[look] / tick_s))) continue;
        const double deviation = hand.estimated_grip_deviation * mobility * mobility / truth.mobility;
        found.error[look] += error * error / draws;
        found.bound[look] += least[look] * least[look] / (truth.mobility * truth.mobility) / draws;
        found.deviation[look] += deviation * deviation / draws;
      }
    }
    within_s.push_back(static_cast<double>(last_outside) * tick_s);
  }
  for (std::size_t look = 0; look < looks; ++look) {
    for (double* square : {&found.error[look], &found.bound[look], &found.deviation[look]})
      *square = std::sqrt(*square);
  }
  std::nth_element(within_s.begin(), within_s.begin() + draws / 2, within_s.end());
  found.within_s = within_s[draws / 2];
  return found;
}

void print(const char* model, const Found& found) {
  for (std::size_t look = 0; look < looks; ++look) {
    std::printf("%s, %2.0f ms: error %5.1f %%, told %5.1f %%, bound %5.2f %%\n", model, 1e3 * looked_at_s[look],
                100.0 * found.error[look], 100.0 * found.deviation[look], 100.0 * found.bound[look]);
  }
  std::printf("%s: within 20 %% from %.1f ms on (median)\n", model, 1e3 * found.within_s);
}

TEST(GripEstimateBound, WithARightModelTheErrorFallsTowardWhatTheSignalsHoldAndNotBelow) {
  const Found found = estimate(0.0);
  print("right model", found);
  for (std::size_t look = 0; look < looks; ++look) {
    EXPECT_GT(found.error[look], 0.9 * found.bound[look]) << looked_at_s[look];
    EXPECT_LT(found.error[look], 2.0 * found.deviation[look]) << looked_at_s[look];
  }
  EXPECT_LT(found.error[2], found.error[0]);
}

TEST(GripEstimateBound, WithMassesAndCableTenPercentOffTheErrorStaysWithinTwiceWhatIsTold) {
  const Found found = estimate(0.1);
  print("10 % off", found);
  EXPECT_LT(found.error[2], 2.0 * found.deviation[2]);
}

}  // namespace grip_estimate_bound_test
}  // namespace tactus::control
