// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/motion_check.hpp>
#include <tactus/kernel/control/safety_gate.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

/// Whether a position that contradicts the velocity of its drive is found in time, and a true one never is: joints in
/// virtual time behind a bus that quantises, filters, and answers late.
namespace tactus::control {
namespace motion_check_test {

static_assert(Element<MotionCheck>);

constexpr Seconds tick{0.002};

/// How a bus measures: steps of velocity and position, the time of a cycle, and the filter of its drives' velocity.
struct Bus {
  const char* name;
  double velocity_step, position_step, cycle_s, filter_s;
};
constexpr Bus buses[]{{"damiao", 2.0 * 45.0 / 4095.0, 25.0 / 65535.0, 0.002, 0.002},
                      {"dynamixel", 0.02398, 2.0 * std::numbers::pi / 4096.0, 0.004, 0.004},
                      {"feetech", 0.07666, 2.0 * std::numbers::pi / 4096.0, 0.008, 0.005}};

/// How late answers are: hardly; polled, one in a hundred by up to 50 ms; or kept by an adapter that hands over all at
/// once.
enum class Host { idle, late, bursts };
enum class Fault { none, frozen, stuck, half, twice, reversed, late };

int seeds() {
  const char* asked = std::getenv("TACTUS_MOTION_SEEDS");
  return asked != nullptr ? std::max(1, std::atoi(asked)) : 40;
}

/// A joint that swings, its bus, and a fault of its position.
class Swinging {
 public:
  Swinging(const Bus& bus, Host host, Fault fault, std::uint64_t seed)
      : bus_(bus),
        host_(host),
        fault_(fault),
        random_(signal::Random(seed).fork(static_cast<std::uint64_t>(fault) * 8 + static_cast<std::uint64_t>(host))),
        // Half of a wrong travel is only seen where it is fast beside the step of the velocity.
        most_rad_per_s_(random_.uniform(fault == Fault::none ? 0.05 : 0.6, 3.0)),
        swings_Hz_(random_.uniform(0.2, 1.5)),
        phase_(random_.uniform(0.0, 6.2)),
        begins_s_(random_.uniform(1.0, 3.0)),
        late_s_(random_.uniform(0.15, 0.4)),
        check_(MotionCheck::make({.velocity_step_m_per_s = bus.velocity_step}, tick).value()) {}

  /// Runs for so long or until the check trips. Whether it did.
  bool run(double duration_s) {
    for (double now_s = 0.0, burst_s = 0.0, heard_s = 0.0; now_s < duration_s;) {
      double arrives_s = now_s + random_.uniform(0.0003, 0.0006);
      if (host_ == Host::late && random_.uniform() < 0.01) arrives_s += random_.uniform(0.0, 0.05);
      if (host_ == Host::bursts) {
        if (arrives_s > burst_s && random_.uniform() < 0.005) burst_s = arrives_s + random_.uniform(0.0, 0.06);
        arrives_s = std::max({arrives_s, burst_s, heard_s + 3e-6});
      }
      const double reported = reported_rad_per_s(now_s);
      const MotionFault found = check_.step({.position_m = position_rad(now_s),
                                             .tells = {.velocity_m_per_s = reported, .force_N = random_.uniform()},
                                             .force_limit_N = 1.0,
                                             .between_s = arrives_s - heard_s});
      heard_s = arrives_s;
      if (fault_ != Fault::none && now_s >= begins_s_) {
        travelled_rad_ = std::max(travelled_rad_, std::fabs(true_rad(now_s) - true_rad(begins_s_)));
      }
      if (found != MotionFault::none) {
        tripped_s_ = now_s;
        return true;
      }
      now_s = host_ == Host::bursts ? now_s + bus_.cycle_s : std::max(now_s + bus_.cycle_s, arrives_s + 1e-4);
    }
    return false;
  }
  /// The farthest from where it was when the fault began.
  [[nodiscard]] double travelled_rad() const { return travelled_rad_; }
  [[nodiscard]] bool before_the_fault() const { return tripped_s_ < begins_s_; }
  [[nodiscard]] const MotionCheck::Evidence& evidence() const { return check_.evidence(); }

 private:
  [[nodiscard]] double true_rad(double time_s) const {
    const double per_s = 2.0 * std::numbers::pi * swings_Hz_;
    return most_rad_per_s_ / per_s * (std::cos(phase_) - std::cos(per_s * time_s + phase_));
  }
  double position_rad(double now_s) {
    const double true_now = true_rad(now_s), at = true_rad(begins_s_);
    double read = true_now;
    if (now_s >= begins_s_) {
      if (fault_ == Fault::frozen || fault_ == Fault::stuck) read = at;
      if (fault_ == Fault::half) read = at + 0.5 * (true_now - at);
      if (fault_ == Fault::twice) read = at + 2.0 * (true_now - at);
      if (fault_ == Fault::reversed) read = at - (true_now - at);
      if (fault_ == Fault::late) read = true_rad(std::max(begins_s_, now_s - late_s_));
    }
    double count = std::round(read / bus_.position_step);
    const bool frozen = fault_ == Fault::frozen && now_s >= begins_s_;
    if (!frozen && random_.uniform() < 0.2) count += random_.uniform() < 0.5 ? 1.0 : -1.0;
    return bus_.position_step * count;
  }
  double reported_rad_per_s(double now_s) {
    const double per_s = 2.0 * std::numbers::pi * swings_Hz_;
    const double filtered = most_rad_per_s_ * std::sin(per_s * (now_s - bus_.filter_s) + phase_);
    return bus_.velocity_step * std::trunc((filtered + 0.02 * random_.normal()) / bus_.velocity_step);
  }

  Bus bus_;
  Host host_;
  Fault fault_;
  signal::Random random_;
  double most_rad_per_s_, swings_Hz_, phase_, begins_s_, late_s_;
  MotionCheck check_;
  double travelled_rad_ = 0.0, tripped_s_ = 0.0;
};

TEST(MotionCheck, AVirtualHourOfTrueReadingsIsNeverContradictedHoweverLateTheyCome) {
  // Three buses, three hosts, 10 joints of 40 s: an hour.
  for (const Bus& bus : buses) {
    for (const Host host : {Host::idle, Host::late, Host::bursts}) {
      for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        Swinging joint(bus, host, Fault::none, seed);
        ASSERT_FALSE(joint.run(40.0)) << bus.name << ", host " << static_cast<int>(host) << ", seed " << seed << ": "
                                      << joint.evidence().travelled_m << " rad by position, "
                                      << joint.evidence().reported_m << " rad by velocity";
      }
    }
  }
}

TEST(MotionCheck, AFrozenStuckScaledReversedOrLatePositionIsFoundWithinAFifthOfARadian) {
  for (const Bus& bus : buses) {
    for (const Fault fault : {Fault::frozen, Fault::stuck, Fault::half, Fault::twice, Fault::reversed, Fault::late}) {
      // Half of the travel, and a lateness at low speed, differ by less than the coarsest step of a velocity.
      if ((fault == Fault::half || fault == Fault::late) && bus.velocity_step > 0.05) continue;
      for (int seed = 1; seed <= seeds(); ++seed) {
        Swinging joint(bus, Host::idle, fault, static_cast<std::uint64_t>(seed));
        ASSERT_TRUE(joint.run(30.0) || joint.travelled_rad() < 0.2)
            << bus.name << ", fault " << static_cast<int>(fault) << ", seed " << seed;
        ASSERT_FALSE(joint.travelled_rad() > 0.0 && joint.before_the_fault());
        EXPECT_LT(joint.travelled_rad(), 0.2) << bus.name << ", fault " << static_cast<int>(fault) << ", seed " << seed;
      }
    }
  }
}

TEST(MotionCheck, ABusyHostDelaysItByNoMoreThanAnotherFifth) {
  for (const Host host : {Host::late, Host::bursts}) {
    for (const Fault fault : {Fault::frozen, Fault::twice, Fault::reversed}) {
      for (int seed = 1; seed <= seeds(); ++seed) {
        Swinging joint(buses[0], host, fault, static_cast<std::uint64_t>(seed));
        ASSERT_TRUE(joint.run(30.0)) << static_cast<int>(fault) << ' ' << seed;
        ASSERT_FALSE(joint.before_the_fault()) << static_cast<int>(fault) << ' ' << seed;
        EXPECT_LT(joint.travelled_rad(), 0.4) << static_cast<int>(fault) << ' ' << seed;
      }
    }
  }
}

TEST(MotionCheck, ItSaysWhatItComparedAndADriveThatReportsNoVelocityIsNotJudged) {
  MotionCheck judged = MotionCheck::make({.velocity_step_m_per_s = 0.01}, tick).value(),
              unjudged = MotionCheck::make({}, tick).value();
  bool found = false;
  for (int i = 0; i < 500 && !found; ++i) {
    const MotionCheck::Input input{.position_m = 0.3,
                                   .tells = {.velocity_m_per_s = 1.0, .force_N = 0.01 * i},
                                   .force_limit_N = 1.0,
                                   .between_s = 0.002};
    found = judged.step(input) == MotionFault::contradicted;
    ASSERT_EQ(unjudged.step(input), MotionFault::none);
  }
  ASSERT_TRUE(found);
  EXPECT_EQ(judged.evidence().travelled_m, 0.0);
  EXPECT_GT(judged.evidence().reported_m, 0.04);
  EXPECT_LT(judged.evidence().reported_m, 0.1);
  EXPECT_NEAR(judged.evidence().reported_m, judged.evidence().time_s, 1e-9) << "1 rad/s";
}

// ---- the same answer over and over ----

/// Ticks until a drive that repeats itself from tick 100 on is found, its force growing by `grows_N` a tick.
int repeated_after(double grows_N, bool force_is_reported, double velocity_m_per_s = 0.0) {
  MotionCheck check = MotionCheck::make({.velocity_step_m_per_s = 0.01}, tick).value();
  for (int i = 0; i < 1000; ++i) {
    const int seen = std::min(i, 100);
    const MotionFault found =
        check.step({.position_m = velocity_m_per_s * 0.002 * seen,
                    .tells = {.velocity_m_per_s = velocity_m_per_s, .force_N = force_is_reported ? 1e-3 * seen : 0.0},
                    .acted_N = std::min(1.0, grows_N * i),
                    .force_limit_N = 1.0,
                    .between_s = 0.002});
    if (found == MotionFault::repeated) return i - 100;
    if (found != MotionFault::none) return -2;
  }
  return -1;
}

TEST(MotionCheck, ADriveThatRepeatsItsAnswerWhileItsForceGoesOnIsFound) {
  const int slow = repeated_after(0.001, true), quick = repeated_after(0.009, true);
  EXPECT_GE(slow, 100) << "not before the force went on by a tenth of its limit";
  EXPECT_LE(slow, 100 + 20);
  EXPECT_GE(quick, 15) << "not within 30 ms";
  EXPECT_EQ(repeated_after(0.0, true), -1) << "a joint that rests under a steady force";
  EXPECT_EQ(repeated_after(0.001, false), -1) << "a drive that never reported a force";
  MotionCheck moving = MotionCheck::make({.velocity_step_m_per_s = 0.01}, tick).value();
  EXPECT_EQ(moving.step({}), MotionFault::none);
}

TEST(MotionCheck, OneBitThatChangesIsAnAnswer) {
  MotionCheck check = MotionCheck::make({.velocity_step_m_per_s = 0.01}, tick).value();
  for (int i = 0; i < 2000; ++i) {
    ASSERT_EQ(check.step({.position_m = 0.1,
                          .tells = {.velocity_m_per_s = 0.0, .force_N = i / 10 % 2 == 0 ? 0.5 : 0.501},
                          .acted_N = std::sin(0.01 * i),
                          .force_limit_N = 1.0,
                          .between_s = 0.002}),
              MotionFault::none);
  }
}

// ---- in the gate ----

TEST(SafetyGate, APositionThatContradictsTheReportedVelocityLatchesAndTheSameReadingTwiceCountsOnce) {
  SafetyGate::Params params{.force_limit_N = 2.0, .rate_limit_N_per_s = 100.0};
  params.motion.velocity_step_m_per_s = 0.02;
  for (const bool frozen : {false, true}) {
    SafetyGate gate = SafetyGate::make(params, tick).value();
    double true_m = 0.0;
    // The bus measures every third tick; in between the gate reads the old answer, older by a tick each time.
    for (int i = 0; i < 900; ++i) {
      const int measured = i / 3 * 3;
      true_m = 0.5 * 0.002 * measured;
      gate.believe(frozen && i > 300 ? 0.3 : true_m, 1, std::nullopt, 0.002 * (i - measured),
                   {.velocity_m_per_s = 0.5, .force_N = 0.01 * measured});
      gate.pass(0.1);
      if (gate.fault() != GateFault::none) break;
    }
    EXPECT_EQ(gate.fault(), frozen ? GateFault::contradicted : GateFault::none);
    if (!frozen) continue;
    EXPECT_LT(true_m - 0.3, 0.1);
    const double reported_m = gate.evidence().reported_m;
    EXPECT_GT(reported_m, 0.04);
    // What goes on after that is no part of the evidence.
    for (int i = 0; i < 300; ++i)
      gate.believe(0.3, 1, std::nullopt, 0.0, {.velocity_m_per_s = -0.5, .force_N = 0.02 * i});
    EXPECT_EQ(gate.evidence().reported_m, reported_m);
    gate.rearm();
    EXPECT_EQ(gate.fault(), GateFault::none);
  }
}

}  // namespace motion_check_test
}  // namespace tactus::control
