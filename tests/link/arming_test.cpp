#include <tactus/link/arming.hpp>
#include <tactus/link/following.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tests/laws.hpp>

namespace tactus::laws {

template <>
struct Subject<link::Following> {
  static constexpr double dt_s = 200e-6;
  static std::vector<link::Following::Params> parameters() { return {link::Following::Params{}}; }
  static void admit(link::Following::Input& input) { input.silence_s = std::fabs(input.silence_s); }
};

template <>
struct Doubles<link::Following::Input> {
  using Row = std::array<double, 8>;
  static link::Following::Input from(const Row& row) {
    return {.arrival = {.message = {row[0], row[1], row[2], row[3], row[4]}, .fresh = row[5] > 0.0},
            .silence_s = row[6],
            .standing = row[7] > -0.5 ? link::Standing::active : link::Standing::hold};
  }
  static Row to(const link::Following::Input& input) {
    const auto& message = input.arrival.message;
    return {message.position_m, message.velocity_m_per_s,
            message.force_N,    message.wave,
            message.energy_J,   input.arrival.fresh ? 1.0 : 0.0,
            input.silence_s,    input.standing == link::Standing::active ? 1.0 : -1.0};
  }
};

template <>
struct Doubles<control::Arrival> {
  using Row = std::array<double, 6>;
  static control::Arrival from(const Row& row) {
    return {.message = {row[0], row[1], row[2], row[3], row[4]}, .fresh = row[5] > 0.0};
  }
  static Row to(const control::Arrival& arrival) {
    const auto& message = arrival.message;
    return {message.position_m, message.velocity_m_per_s, message.force_N,
            message.wave,       message.energy_J,         arrival.fresh ? 1.0 : 0.0};
  }
};

INSTANTIATE_TYPED_TEST_SUITE_P(Link, ElementLaws, ::testing::Types<link::Following>);

}  // namespace tactus::laws

namespace tactus::link {
namespace {

constexpr double tick_s = 1e-3;
constexpr double hold_after_s = 0.1;

/// Two sites whose datagrams take a few ticks, and that can be cut off from one another either way.
class TwoSites {
 public:
  Arming master{SiteName::master, hold_after_s, tick_s};
  Arming slave{SiteName::slave, hold_after_s, tick_s};
  bool to_slave = true, to_master = true;
  bool slave_fault = false;
  /// The session and the number of each arming under which the slave became active.
  std::vector<std::pair<std::uint64_t, std::uint32_t>> followed;

  void run(int ticks, bool arm = false) {
    for (int i = 0; i < ticks; ++i) {
      deliver(at_master_, from_slave_, to_master);
      deliver(at_slave_, from_master_, to_slave);
      at_master_.arm = arm && i == 0;
      at_slave_.fault = slave_fault;
      master.step(at_master_);
      const bool was_active = slave.standing() == Standing::active;
      slave.step(at_slave_);
      if (!was_active && slave.standing() == Standing::active)
        followed.emplace_back(at_slave_.session, slave.armings());
      from_master_.push_back({master.standing(), master.armings(), master_session});
      from_slave_.push_back({slave.standing(), slave.armings(), slave_session});
    }
  }
  void restart_slave() {
    slave = Arming(SiteName::slave, hold_after_s, tick_s);
    at_slave_ = {};
    ++slave_session;
  }
  void restart_master() {
    master = Arming(SiteName::master, hold_after_s, tick_s);
    at_master_ = {};
    ++master_session;
  }
  [[nodiscard]] bool both_active() const {
    return master.standing() == Standing::active && slave.standing() == Standing::active;
  }
  [[nodiscard]] bool both_hold() const {
    return master.standing() == Standing::hold && slave.standing() == Standing::hold;
  }

 private:
  struct Told {
    Standing standing;
    std::uint32_t armings;
    std::uint64_t session;
  };
  static constexpr std::size_t delay_ticks = 5;

  static void deliver(Arming::Input& at, std::deque<Told>& way, bool open) {
    at.silence_s += tick_s;
    if (way.size() < delay_ticks) return;
    const Told told = way.front();
    way.pop_front();
    if (!open) return;
    at.heard = true;
    at.silence_s = 0.0;
    at.peer = told.standing;
    at.peer_armings = told.armings;
    at.session = told.session;
  }

  std::uint64_t master_session = 1, slave_session = 1001;
  Arming::Input at_master_, at_slave_;
  std::deque<Told> from_master_, from_slave_;
};

TEST(Arming, SitesThatHearEachOtherHoldUntilAPersonArms) {
  TwoSites sites;
  sites.run(1000);
  EXPECT_TRUE(sites.both_hold());
  sites.run(50, true);
  EXPECT_TRUE(sites.both_active());
  sites.run(10000);
  EXPECT_TRUE(sites.both_active());
}

TEST(Arming, ACutEitherWayOrBothEndsInHoldOnBothSitesWithinTwiceTheTimeOutAndNeedsArming) {
  for (const auto& [to_slave, to_master] : {std::pair(false, true), std::pair(true, false), std::pair(false, false)}) {
    TwoSites sites;
    sites.run(50);
    sites.run(50, true);
    ASSERT_TRUE(sites.both_active());
    sites.to_slave = to_slave;
    sites.to_master = to_master;
    sites.run(220);
    EXPECT_TRUE(sites.both_hold());
    sites.to_slave = sites.to_master = true;
    sites.run(5000);
    EXPECT_TRUE(sites.both_hold());
    sites.run(50, true);
    EXPECT_TRUE(sites.both_active());
  }
}

TEST(Arming, ACutShorterThanTheTimeOutChangesNothing) {
  TwoSites sites;
  sites.run(50);
  sites.run(50, true);
  for (int i = 0; i < 20; ++i) {
    sites.to_slave = sites.to_master = false;
    sites.run(90);
    EXPECT_TRUE(sites.both_active());
    sites.to_slave = sites.to_master = true;
    sites.run(10);
  }
}

TEST(Arming, ARestartOfEitherSiteEndsInHoldAndNeedsArming) {
  for (const bool master_restarts : {false, true}) {
    TwoSites sites;
    sites.run(50);
    sites.run(50, true);
    ASSERT_TRUE(sites.both_active());
    if (master_restarts) {
      sites.restart_master();
    } else {
      sites.restart_slave();
    }
    sites.run(50);
    EXPECT_TRUE(sites.both_hold());
    sites.run(5000);
    EXPECT_TRUE(sites.both_hold());
    sites.run(50, true);
    EXPECT_TRUE(sites.both_active());
  }
}

TEST(Arming, AFaultOfOneSiteHoldsTheOtherToo) {
  TwoSites sites;
  sites.run(50);
  sites.run(50, true);
  sites.slave_fault = true;
  sites.run(50);
  EXPECT_TRUE(sites.both_hold());
  EXPECT_EQ(sites.slave.cause(), HoldCause::fault);
  EXPECT_EQ(sites.master.cause(), HoldCause::peer_holds);
  sites.run(5000, true);  // as long as the fault lasts, an arming goes unanswered
  EXPECT_TRUE(sites.both_hold());
  EXPECT_EQ(sites.master.cause(), HoldCause::unanswered);
}

TEST(Arming, WithoutTheOtherSiteThereIsNoArming) {
  TwoSites sites;
  sites.to_master = false;
  sites.run(50);
  sites.run(50, true);
  EXPECT_EQ(sites.master.standing(), Standing::hold);
}

// Each time that the slave becomes active it is under another arming: another number, or the number of another session.
TEST(Arming, NeverIsTheSlaveActiveUnderAnArmingThatIsOver) {
  EXPECT_TRUE(rc::check([] {
    TwoSites sites;
    sites.run(20);
    for (const int what : *rc::gen::container<std::vector<int>>(rc::gen::inRange(0, 8))) {
      switch (what) {
        case 0:
          sites.to_slave = !sites.to_slave;
          break;
        case 1:
          sites.to_master = !sites.to_master;
          break;
        case 2:
          sites.restart_slave();
          break;
        case 3:
          sites.restart_master();
          break;
        default:
          break;
      }
      sites.run(*rc::gen::inRange(1, 150), what == 4);
    }
    auto followed = sites.followed;
    std::ranges::sort(followed);
    RC_ASSERT(std::ranges::adjacent_find(followed) == followed.end());
  }));
}

// A master that is restarted and armed before it has heard of the slave's number counts from one again. It then takes
// the slave's standing under the old session for its answer, and gives this arming up.
TEST(Arming, AnArmingOfAnotherSessionIsAnotherOneEvenUnderTheSameNumber) {
  TwoSites sites;
  sites.run(20);
  sites.run(6, true);  // the slave follows, and its answer is under way
  ASSERT_EQ(sites.followed.size(), 1U);
  sites.restart_master();
  sites.run(1);
  sites.run(50, true);
  EXPECT_TRUE(sites.both_hold());
  ASSERT_EQ(sites.followed.size(), 2U);
  EXPECT_NE(sites.followed[0].first, sites.followed[1].first);
  EXPECT_EQ(sites.followed[0].second, sites.followed[1].second);
  sites.run(50, true);
  EXPECT_TRUE(sites.both_active());
}

control::Arrival told(double position_m, double force_N, double energy_J = 0.0) {
  return {.message = {.position_m = position_m, .force_N = force_N, .energy_J = energy_J}, .fresh = true};
}

TEST(Following, InHoldThePositionStaysAndTheForceGoesToZeroNoFasterThanItsLimit) {
  const Following::Params params;
  auto following = Following::make(params, Seconds{tick_s}).value();
  for (int i = 0; i < 2000; ++i) following.step({told(0.05, 3.0), 0.0, Standing::active});
  double last_N = 3.0;
  for (int i = 0; i < 1000; ++i) {
    const auto arrival = following.step({told(0.2, 9.0), 0.0, Standing::hold});
    EXPECT_EQ(arrival.message.position_m, 0.05);
    EXPECT_FALSE(arrival.fresh);
    EXPECT_LE(last_N - arrival.message.force_N, params.catch_up_N_per_s * tick_s * (1.0 + 1e-12));
    last_N = arrival.message.force_N;
  }
  EXPECT_EQ(last_N, 0.0);
}

TEST(Following, ResumingMakesNoStepHoweverFarTheOtherSiteHasGone) {
  EXPECT_TRUE(rc::check([] {
    const Following::Params params;
    auto following = Following::make(params, Seconds{tick_s}).value();
    const double there_m = *rc::gen::inRange(-500, 500) * 1e-3, force_N = *rc::gen::inRange(-50, 50) * 0.2;
    double position_m = 0.0, last_N = 0.0;
    double largest_m = 0.0, largest_N = 0.0;
    for (int i = 0; i < 8000; ++i) {
      const auto message = following.step({told(there_m, force_N), 0.0, Standing::active}).message;
      largest_m = std::max(largest_m, std::fabs(message.position_m - position_m));
      largest_N = std::max(largest_N, std::fabs(message.force_N - last_N));
      position_m = message.position_m;
      last_N = message.force_N;
    }
    RC_ASSERT(largest_m <= params.catch_up_m_per_s * tick_s * (1.0 + 1e-9));
    RC_ASSERT(largest_N <= params.catch_up_N_per_s * tick_s * (1.0 + 1e-9));
    RC_ASSERT(position_m == there_m);
    RC_ASSERT(last_N == force_N);
    RC_ASSERT(following.caught_up());
  }));
}

TEST(Following, OnceCaughtUpEveryMessagePassesUnchanged) {
  auto following = Following::make({}, Seconds{tick_s}).value();
  for (int i = 0; i < 2000; ++i) following.step({told(0.05, 1.0), 0.0, Standing::active});
  for (int i = 0; i < 100; ++i) {
    const double position_m = 0.05 + 0.01 * (i % 7), force_N = 10.0 * (i % 3);
    const auto message = following.step({told(position_m, force_N), 0.019, Standing::active}).message;
    EXPECT_EQ(message.position_m, position_m);
    EXPECT_EQ(message.force_N, force_N);
  }
}

TEST(Following, BetweenStaleAndHoldTheForceFallsToZero) {
  const Following::Params params{.stale_after_s = 0.02, .hold_after_s = 0.1, .catch_up_N_per_s = 1e4};
  auto following = Following::make(params, Seconds{tick_s}).value();
  for (int i = 0; i < 2000; ++i) following.step({told(0.0, 4.0), 0.0, Standing::active});
  EXPECT_DOUBLE_EQ(following.step({told(0.0, 4.0), 0.02, Standing::active}).message.force_N, 4.0);
  EXPECT_DOUBLE_EQ(following.step({told(0.0, 4.0), 0.06, Standing::active}).message.force_N, 2.0);
  EXPECT_NEAR(following.step({told(0.0, 4.0), 0.1, Standing::active}).message.force_N, 0.0, 1e-12);
}

TEST(Following, ARestartedSiteThatCountsItsEnergyFromZeroTakesNoneAway) {
  auto following = Following::make({}, Seconds{tick_s}).value();
  following.step({told(0.0, 0.0, 5.0), 0.0, Standing::active});
  EXPECT_DOUBLE_EQ(following.step({told(0.0, 0.0, 7.0), 0.0, Standing::active}).message.energy_J, 2.0);
  following.step({told(0.0, 0.0, 0.0), 0.0, Standing::hold});  // another session
  following.step({told(0.0, 0.0, 0.5), 0.0, Standing::active});
  EXPECT_DOUBLE_EQ(following.step({told(0.0, 0.0, 1.0), 0.0, Standing::active}).message.energy_J, 2.5);
}

TEST(Following, AStaleTimeAtOrBeyondTheHoldTimeIsRefused) {
  const auto following = Following::make({.stale_after_s = 0.2, .hold_after_s = 0.2}, Seconds{tick_s});
  ASSERT_FALSE(following);
  EXPECT_EQ(following.error().parameter, "stale_after_s");
}

}  // namespace
}  // namespace tactus::link
