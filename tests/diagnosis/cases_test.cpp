// SPDX-License-Identifier: Apache-2.0
// Kinds of recordings that were once diagnosed wrongly, simulated here by a few lines each.
#include <tactus/identification/diagnosis/columns.hpp>
#include <tactus/identification/diagnosis/diagnosis.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace tactus::diagnosis {
namespace cases_test {

constexpr double two_pi = 2.0 * std::numbers::pi;
constexpr double step_s = 1e-4;

double counted(double value, double step) { return std::round(value / step) * step; }

/// Columns that are filled sample by sample.
struct Recorded {
  explicit Recorded(double dt_s) { signals.sample_time = Seconds{dt_s}; }
  void add(Role role, double value) { columns[index_of(role)].push_back(value); }
  Signals done() {
    for (const Role role : all_roles) {
      auto& values = columns[index_of(role)];
      if (values.empty()) continue;
      signals.samples = values.size();
      const double step = resolution_of(role, values);
      signals.channels[index_of(role)] = Channel{.name = "x", .values = std::move(values), .step = step};
    }
    return std::move(signals);
  }
  Signals signals{.channels = {}, .sample_time = Seconds{0.0}, .samples = 0, .rotary = false};
  std::array<std::vector<double>, role_count> columns = {};
};

/// A handle that a hand presses into a wall which its controller switches at 100 Hz: 5 N beyond 0, else none. `gives`:
/// the cosine of the angle between the force and the velocity at the main line of the last 3 s, from the simulation
/// itself.
Signals switched_wall(double sample_time_s, double& gives) {
  Recorded recorded(sample_time_s);
  const auto each = std::lround(sample_time_s / step_s);
  double x = -0.02, v = 0.0, force = 0.0;
  std::vector<double> speeds, forces;
  for (long n = 0; n < 60'000; ++n) {
    const double t = static_cast<double>(n) * step_s;
    const double hand = std::min(-0.02 + 0.015 * t, 0.004);
    if (n % 100 == 0) force = x > 0.0 ? 5.0 : 0.0;
    if (n % each == 0) {
      recorded.add(Role::master_position, counted(x, 5e-5));
      recorded.add(Role::displayed_force, force);
    }
    if (n >= 30'000) speeds.push_back(v), forces.push_back(-force);
    v += step_s * (250.0 * (hand - x) - 4.0 * v - force) / 0.25;
    x += step_s * v;
  }
  double largest = 0.0;
  for (int line = 10; line < 100; ++line) {
    std::complex<double> of_speed, of_force;
    for (std::size_t i = 0; i < speeds.size(); ++i) {
      const auto turn = std::polar(1.0, -two_pi * line * static_cast<double>(i) / static_cast<double>(speeds.size()));
      of_speed += speeds[i] * turn, of_force += forces[i] * turn;
    }
    if (std::abs(of_speed) < largest) continue;
    largest = std::abs(of_speed);
    gives = std::cos(std::arg(of_force / of_speed));
  }
  return recorded.done();
}

/// Two devices coupled by position, 40 ms each way, in a light grip. `contact_m`: where the follower meets a soft wall.
Signals delayed_coupling(double contact_m) {
  constexpr double stiffness = 150.0, damping = 1.5, limit_N = 8.0;
  constexpr std::size_t late = 400;
  Recorded recorded(2e-3);
  signal::Random random(5);
  std::vector<double> xs(60'000, -0.02), ys(60'000, -0.02);
  double x = -0.02, v = 0.0, y = -0.02, w = 0.0;
  for (std::size_t n = 0; n < 60'000; ++n) {
    const double t = static_cast<double>(n) * step_s;
    const double hand = t < 1.0 ? -0.02 : std::min(-0.02 + 0.05 * (t - 1.0), 0.0);
    xs[n] = counted(x, 1e-5), ys[n] = counted(y, 1e-5);
    const std::size_t before = n - std::min(n, late);
    const double displayed = std::clamp(stiffness * (xs[n] - ys[before]), -limit_N, limit_N);
    const double motor = std::clamp(stiffness * (xs[before] - ys[n]) - damping * w, -limit_N, limit_N);
    const double tip = y > contact_m ? std::max(0.0, 250.0 * (y - contact_m) + 0.5 * w) : 0.0;
    if (n % 20 == 0) {
      recorded.add(Role::master_position, xs[n]);
      recorded.add(Role::slave_position, ys[n]);
      recorded.add(Role::displayed_force, counted(displayed, 2e-3));
      recorded.add(Role::tip_force, tip + 6e-3 * random.normal());
      recorded.add(Role::slave_force, counted(motor, 2e-3));
    }
    v += step_s * (100.0 * (hand - x) - 1.5 * v - displayed) / 0.2;
    x += step_s * v;
    w += step_s * (motor - tip - 0.3 * w) / 0.25;
    y += step_s * w;
  }
  return recorded.done();
}

/// A person who leads at one frequency, and a follower with a servo of 10 Hz. `exchanged`: the columns of leader and
/// follower.
Signals led(double frequency_Hz, double sample_time_s, bool exchanged = false) {
  constexpr double stiffness = 800.0, damping = 18.0, mass = 0.2;
  Recorded recorded(sample_time_s);
  const auto each = std::lround(sample_time_s / step_s);
  signal::Random random(9);
  double y = 0.0, w = 0.0, drift = 0.0;
  for (long n = 0; n < 100'000; ++n) {
    const double t = static_cast<double>(n) * step_s;
    drift += 2e-3 * (random.normal() - drift);
    const double turns = two_pi * frequency_Hz, size = 0.02 * (1.0 + drift);
    const double x = size * std::sin(turns * t), v = size * turns * std::cos(turns * t);
    const double motor = stiffness * (x - y) + damping * (v - w);
    if (n % each == 0) {
      recorded.add(exchanged ? Role::slave_position : Role::master_position, counted(x, 1e-5));
      recorded.add(exchanged ? Role::master_position : Role::slave_position, counted(y, 1e-5));
      // With a coupling both motors have the same force, and the one at the hand opposes it.
      recorded.add(Role::slave_force, counted(exchanged ? -motor : motor, 2e-3));
    }
    w += step_s * (motor - 3.0 * w) / mass;
    y += step_s * w;
  }
  return recorded.done();
}

TEST(Cases, AWallThatIsSwitchedAtALowRateIsAMechanismOfOneDevice) {
  for (const double sample_time_s : {1e-3, 2e-3}) {
    double gives = 0.0;
    const Diagnosis found = diagnose(switched_wall(sample_time_s, gives));
    ASSERT_EQ(found.findings.size(), 1U);
    const Finding& one = found.findings.front();
    EXPECT_EQ(one.decision.mechanism, Mechanism::virtual_wall) << found.verdict;
    ASSERT_TRUE(one.evidence.actuator_gives);
    EXPECT_GT(gives, 0.2);
    EXPECT_NEAR(*one.evidence.actuator_gives, gives, 0.06);
    ASSERT_TRUE(one.evidence.own_wall);
    EXPECT_TRUE(one.evidence.own_wall->switched);
    EXPECT_GT(one.evidence.own_wall->explained, 0.8);
  }
}

TEST(Cases, APositionCouplingOverADelayIsNoTremorHoweverLowItsFrequency) {
  const Diagnosis found = diagnose(delayed_coupling(1.0));
  ASSERT_EQ(found.findings.size(), 1U) << found.verdict;
  const Finding& one = found.findings.front();
  EXPECT_EQ(one.decision.mechanism, Mechanism::delay) << found.verdict;
  EXPECT_LT(one.oscillation.frequency_Hz, 12.0) << "in the band of a tremor";
  // The follower is damped by its own velocity alone, which the fit takes for some more delay.
  EXPECT_NEAR(*one.evidence.delay_there_s, 0.04, 0.015);
  EXPECT_NEAR(*one.evidence.delay_back_s, 0.04, 0.004);
}

TEST(Cases, AFollowerThatTouchesSomethingInPassingDoesNotMakeADelayInducedMotion) {
  const Diagnosis found = diagnose(delayed_coupling(0.01));
  ASSERT_FALSE(found.findings.empty()) << found.verdict;
  const Finding& one = found.findings.front();
  EXPECT_GT(*one.evidence.contact, 0.1) << "the follower does touch the wall";
  EXPECT_GT(*one.evidence.coupling_explains, *one.evidence.tip_explains);
  EXPECT_EQ(one.decision.mechanism, Mechanism::delay) << found.verdict;
}

TEST(Cases, NoiseOfAForceSensorAndSlowMotionThroughCountsAreNoOscillation) {
  signal::Random random(4);
  for (const double speed_m_per_s : {4e-4, 8e-4, 3e-3}) {
    Recorded recorded(4e-3);
    double ringing = 0.0, before = 0.0;
    for (int i = 0; i < 2500; ++i) {
      const double at = counted(0.01 + speed_m_per_s * 4e-3 * i, 1.6e-5);
      // Noise with a broad peak at 24 Hz, as of a sensor on a mount.
      const double next = 1.78 * std::cos(two_pi * 24.0 * 4e-3) * ringing - 0.79 * before + 4e-3 * random.normal();
      before = std::exchange(ringing, next);
      recorded.add(Role::master_position, at);
      recorded.add(Role::slave_position, at);
      recorded.add(Role::tip_force, 3.0 + ringing);
      recorded.add(Role::displayed_force, counted(0.75 + 0.25 * ringing, 2e-3));
    }
    const Diagnosis found = diagnose(recorded.done());
    EXPECT_TRUE(found.findings.empty()) << speed_m_per_s << ": " << found.verdict;
  }
}

TEST(Cases, APersonWhoLeadsIsNoFaultAtAnyRate) {
  for (const double frequency_Hz : {0.5, 1.0, 2.0, 3.0}) {
    for (const double sample_time_s : {1e-3, 1e-2, 0.0333}) {
      const Diagnosis found = diagnose(led(frequency_Hz, sample_time_s));
      for (const Finding& one : found.findings) {
        EXPECT_EQ(one.decision.mechanism, Mechanism::unknown) << frequency_Hz << " Hz, " << found.verdict;
      }
      ASSERT_TRUE(found.following) << frequency_Hz << " Hz, every " << sample_time_s << " s";
      EXPECT_GT(found.following->lag_s.value, 0.0);
    }
  }
}

TEST(Cases, ExchangedColumnsOrAReversedForceAreNoticedAndNothingIsNamed) {
  const Diagnosis exchanged = diagnose(led(2.0, 1e-3, true));
  EXPECT_NE(exchanged.verdict.find("--slave-force-sign -1"), std::string::npos) << exchanged.verdict;
  EXPECT_NE(exchanged.verdict.find("before the leader"), std::string::npos) << exchanged.verdict;
  for (const Finding& one : exchanged.findings) EXPECT_EQ(one.decision.mechanism, Mechanism::unknown);

  Signals reversed = led(2.0, 1e-3);
  EXPECT_EQ(diagnose(reversed).verdict.find("--slave-force-sign"), std::string::npos);
  for (double& force : reversed.channels[index_of(Role::slave_force)]->values) force = -force;
  EXPECT_NE(diagnose(reversed).verdict.find("--slave-force-sign -1"), std::string::npos);
}

}  // namespace cases_test
}  // namespace tactus::diagnosis
