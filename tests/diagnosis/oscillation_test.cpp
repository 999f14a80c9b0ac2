// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/evidence.hpp>
#include <tactus/identification/diagnosis/oscillation.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace {

/// Eight seconds at 1 kHz of a master and a slave, in counts of 10 um.
Signals recorded(const std::function<double(double)>& master_m, const std::function<double(double)>& slave_m) {
  Signals signals{.channels = {}, .sample_time = Seconds{1e-3}, .samples = 8000, .rotary = false};
  const auto channel = [&](const std::function<double(double)>& position_m) {
    Channel made{.name = "x", .values = {}, .step = 1e-5};
    for (std::size_t i = 0; i < signals.samples; ++i) {
      made.values.push_back(1e-5 * std::round(1e5 * position_m(1e-3 * static_cast<double>(i))));
    }
    return made;
  };
  signals.channels[0] = channel(master_m);
  signals.channels[1] = channel(slave_m);
  return signals;
}

double at_rest(double) { return 0.01; }

TEST(FindOscillations, TellsFrequencyAndTimeOfWhatBegins) {
  const auto slave = [](double t) {
    return 0.01 + (t > 3.0 ? 1e-3 * std::sin((2.0 * std::numbers::pi) * 37.0 * t) : 0.0);
  };
  const auto found = find_oscillations(recorded(at_rest, slave));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].frequency_Hz, 37.0, 0.2);
  EXPECT_NEAR(found[0].from_s, 3.0, 0.1);
  EXPECT_NEAR(found[0].to_s, 8.0, 0.1);
  EXPECT_GT(found[0].share, 0.9);
}

TEST(FindOscillations, RingingThatFadesIsNone) {
  const auto slave = [](double t) {
    const double since = std::fmod(t, 1.0);
    return 0.01 + 1e-3 * std::exp(-since / 0.08) * std::sin((2.0 * std::numbers::pi) * 37.0 * since);
  };
  EXPECT_TRUE(find_oscillations(recorded(at_rest, slave)).empty());
}

TEST(FindOscillations, NoiseAndReachesAreNone) {
  signal::Random random(7);
  const auto master = [](double t) { return 0.02 * std::tanh(8.0 * (t - 2.0)) - 0.03 * std::tanh(6.0 * (t - 5.0)); };
  const auto slave = [&](double t) { return master(t - 0.01) + 2e-5 * random.normal(); };
  EXPECT_TRUE(find_oscillations(recorded(master, slave)).empty());
}

TEST(FindOscillations, ASquareWaveIsOneOscillationAndNotItsHarmonics) {
  const auto slave = [](double t) { return std::sin((2.0 * std::numbers::pi) * 13.0 * t) > 0.0 ? 1e-3 : -1e-3; };
  const auto found = find_oscillations(recorded(at_rest, slave));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_NEAR(found[0].frequency_Hz, 13.0, 0.2);
}

TEST(PositionScale, IsThatOfSlowMotionAndNotOfTheOscillation) {
  const auto master = [](double t) {
    return 0.03 * std::sin((2.0 * std::numbers::pi) * 0.3 * t) + 2e-3 * std::sin((2.0 * std::numbers::pi) * 20.0 * t);
  };
  const auto slave = [](double t) {
    return 0.015 * std::sin((2.0 * std::numbers::pi) * 0.3 * t) - 4e-3 * std::sin((2.0 * std::numbers::pi) * 20.0 * t);
  };
  EXPECT_NEAR(position_scale(recorded(master, slave)), 0.5, 0.01);
}

TEST(FitCoupling, FindsTheDelayOfAForce) {
  signal::Random random(3);
  std::vector<double> lead, own, force;
  double slow = 0.0, other = 0.0;
  for (int i = 0; i < 6000; ++i) {
    slow += 0.02 * (random.normal() - slow);
    other += 0.02 * (random.normal() - other);
    lead.push_back(1e-2 * slow);
    own.push_back(1e-2 * other);
  }
  for (std::size_t i = 0; i < lead.size(); ++i)
    force.push_back(80.0 * (lead[i - std::min<std::size_t>(i, 31)] - own[i]));
  const Coupling found = fit_coupling(force, lead, own, 0.2, Seconds{1e-3});
  EXPECT_NEAR(found.delay_s, 0.031, 0.002);
  EXPECT_GT(found.explained, 0.9);
}

}  // namespace
}  // namespace tactus::diagnosis
