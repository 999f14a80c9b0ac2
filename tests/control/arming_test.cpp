// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/supervision.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace tactus::control {
namespace arming_test {

constexpr double tick_s = 1e-3;

/// Two sites whose packets take a few ticks, and that can be cut off from one another either way. A site aligns by
/// itself; the person at the master presses the dead-man switch as soon as it is armed.
class TwoSites {
 public:
  /// Where motors are tried on arming, they move springs.
  explicit TwoSites(bool tried = false) : tried_(tried) {}
  bool to_slave = true, to_master = true;
  bool slave_fault = false;
  /// The session and the number of each arming under which the slave was armed.
  std::vector<std::pair<std::int64_t, std::int64_t>> followed;

  void run(int ticks, bool arm = false) {
    for (int i = 0; i < ticks; ++i) {
      deliver(master_, from_slave_, to_master);
      deliver(slave_, from_master_, to_slave);
      step(master_, arm && i == 0, false);
      const SiteState before = slave_.site.state();
      step(slave_, false, slave_fault);
      const bool from_rest = before == SiteState::align || before == SiteState::hold;
      if (from_rest && slave_.site.state() == SiteState::armed) {
        followed.emplace_back(slave_.site.record().applied_session, slave_.site.record().armings);
      }
      from_master_.push_back(master_.site.packet({}));
      from_slave_.push_back(slave_.site.packet({}));
    }
  }
  void restart_slave() { slave_ = Site(SiteRole::slave, ++slave_session_, tried_); }
  void restart_master() { master_ = Site(SiteRole::master, ++master_session_, tried_); }
  [[nodiscard]] SiteState master() const { return master_.site.state(); }
  [[nodiscard]] SiteState slave() const { return slave_.site.state(); }
  [[nodiscard]] SiteCause master_cause() const { return static_cast<SiteCause>(master_.site.record().cause); }
  [[nodiscard]] SiteCause slave_cause() const { return static_cast<SiteCause>(slave_.site.record().cause); }
  [[nodiscard]] bool both_active() const { return master() == SiteState::active && slave() == SiteState::active; }
  [[nodiscard]] bool none_follows() const { return !follows(master()) && !follows(slave()); }

 private:
  struct Site {
    Site(SiteRole role, std::int64_t session, bool tried)
        : site(Supervision::make(params(tried), role, session, Seconds{tick_s}).value()) {}
    static SupervisionParams params(bool tried) {
      SupervisionParams params;
      params.probe.force_N = tried ? 0.5 : 0.0;
      return params;
    }
    Supervision site;
    double position_m = 0.0;
    bool born = true;
  };
  static constexpr std::size_t delay_ticks = 5;

  static bool follows(SiteState state) { return state == SiteState::armed || state == SiteState::active; }
  static void deliver(Site& to, std::deque<Packet>& way, bool open) {
    if (way.size() < delay_ticks) return;
    if (open) to.site.take(way.front());
    way.pop_front();
  }
  static void step(Site& at, bool arm, bool fault) {
    const bool guards = follows(at.site.state());
    at.site.decide({.requests = {.align = !at.born, .arm = arm, .dead_man = guards && !arm},
                    .fault = fault ? GateFault::not_finite : GateFault::none});
    at.position_m = 1e-3 * at.site.probe(at.position_m, false);
    at.born = false;
  }

  std::int64_t master_session_ = 1, slave_session_ = 1001;
  bool tried_;
  Site master_{SiteRole::master, 1, tried_};
  Site slave_{SiteRole::slave, 1001, tried_};
  std::deque<Packet> from_master_, from_slave_;
};

TEST(Arming, SitesThatHearEachOtherStandUntilAPersonArms) {
  TwoSites sites;
  sites.run(1000);
  EXPECT_EQ(sites.master(), SiteState::align);
  EXPECT_EQ(sites.slave(), SiteState::align);
  sites.run(50, true);
  EXPECT_TRUE(sites.both_active());
  sites.run(10000);
  EXPECT_TRUE(sites.both_active());
}

TEST(Arming, ASlaveWhoseMotorIsTriedAnswersOnceItWasSoTheMasterWaits) {
  TwoSites sites(true);
  sites.run(50);
  sites.run(90, true);
  EXPECT_EQ(sites.master(), SiteState::armed);
  EXPECT_EQ(sites.slave(), SiteState::armed);
  sites.run(40);
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
    EXPECT_EQ(sites.master(), SiteState::hold);
    EXPECT_EQ(sites.slave(), SiteState::hold);
    sites.to_slave = sites.to_master = true;
    sites.run(5000);
    EXPECT_EQ(sites.master(), SiteState::hold);
    EXPECT_EQ(sites.slave(), SiteState::hold) << "a slave that was cut off does not come back alone";
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

TEST(Arming, ARestartOfEitherSiteEndsItAndNeedsArming) {
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
    EXPECT_TRUE(sites.none_follows());
    EXPECT_EQ(master_restarts ? sites.slave_cause() : sites.master_cause(), SiteCause::other_session);
    sites.run(5000);
    EXPECT_TRUE(sites.none_follows());
    sites.run(50, true);
    EXPECT_TRUE(sites.both_active());
  }
}

TEST(Arming, AnArmingThatTheSlaveDoesNotAnswerIsGivenUp) {
  TwoSites sites;
  sites.run(50);
  sites.run(50, true);
  sites.slave_fault = true;
  sites.run(50);
  EXPECT_EQ(sites.slave(), SiteState::fault);
  EXPECT_EQ(sites.master_cause(), SiteCause::peer);
  sites.run(900, true);
  EXPECT_EQ(sites.master(), SiteState::armed);
  sites.run(110);
  EXPECT_EQ(sites.master(), SiteState::hold);
  EXPECT_EQ(sites.master_cause(), SiteCause::unanswered);
  EXPECT_EQ(sites.slave(), SiteState::fault);
}

TEST(Arming, ASecondArmingWaitsAsLongAsTheFirst) {
  TwoSites sites;
  sites.slave_fault = true;
  sites.run(50);
  sites.run(900, true);
  sites.run(900, true);
  EXPECT_EQ(sites.master(), SiteState::armed);
  sites.run(110);
  EXPECT_EQ(sites.master_cause(), SiteCause::unanswered);
}

TEST(Arming, AWayThatOpensAfterAnArmingWasGivenUpBringsNobodyBack) {
  TwoSites sites;
  sites.run(50);
  sites.to_slave = false;
  sites.run(1100, true);
  EXPECT_EQ(sites.master(), SiteState::hold);
  sites.to_slave = true;
  sites.run(2000);
  EXPECT_TRUE(sites.none_follows());
}

TEST(Arming, WithoutTheOtherSiteThereIsNoArming) {
  TwoSites sites;
  sites.to_master = false;
  sites.run(50);
  sites.run(50, true);
  EXPECT_EQ(sites.master(), SiteState::align);
}

// A master that was armed a second time holds under a number that its slave never heard.
TEST(Arming, ASlaveDoesNotStayArmedWhileAMasterThatWasArmedAgainHolds) {
  TwoSites sites;
  sites.run(20);
  sites.to_master = false;
  sites.run(28, true);
  ASSERT_EQ(sites.slave(), SiteState::armed);
  sites.to_slave = false;
  sites.run(80, true);
  ASSERT_EQ(sites.master(), SiteState::hold);
  ASSERT_EQ(sites.slave(), SiteState::armed);
  sites.to_slave = sites.to_master = true;
  sites.run(20);
  EXPECT_EQ(sites.slave(), SiteState::hold);
  EXPECT_EQ(sites.slave_cause(), SiteCause::peer);
}

// Each time that the slave is armed it is under another arming: another number, or the number of another session. And
// whatever happened, in peace and without a person neither site goes on following one that does not.
TEST(Arming, NeverDoesTheSlaveFollowAnArmingThatIsOver) {
  EXPECT_TRUE(rc::check([] {
    TwoSites sites(*rc::gen::arbitrary<bool>());
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
    sites.to_slave = sites.to_master = true;
    sites.run(1200);
    RC_ASSERT(sites.both_active() || sites.none_follows());
  }));
}

// A master that is restarted within a round trip of an arming, and armed before the slave has heard of it, may take
// what the slave still says of the old arming for its answer. The slave holds as soon as it hears the new session, and
// the master with it, whatever the number; what the slave hears first of a session it does not follow.
TEST(Arming, AMasterRestartedAndArmedWithinARoundTripIsNotLeftAloneWithAnAnswerToTheOldArming) {
  for (int restart = 1; restart < 12; ++restart) {
    for (int arm = 2; arm < 12; ++arm) {
      TwoSites sites;
      sites.run(20);
      sites.run(restart, true);
      sites.restart_master();
      sites.run(arm);
      sites.to_slave = false;  // until what was sent before the arming is lost
      sites.run(6, true);
      sites.to_slave = true;
      sites.run(30);
      EXPECT_TRUE(sites.both_active() || sites.master() != SiteState::active) << restart << " and " << arm;
      sites.run(1200);
      EXPECT_TRUE(sites.both_active() || sites.none_follows()) << restart << " and " << arm;
      sites.run(50, true);
      EXPECT_TRUE(sites.both_active()) << restart << " and " << arm;
    }
  }
}

}  // namespace arming_test
}  // namespace tactus::control
