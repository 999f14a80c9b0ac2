// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>
#include <tests/devices/rig/arms_bench.hpp>

/// What an operator, a page or a node asks of two arms that run.
namespace tactus::devices {
namespace rig_arms_test {

using control::SiteRole;
using control::TareState;
using runtime::RequestSource;
using runtime::SiteCommand;
using runtime::SiteWord;

/// The follower's tool is led onto a stiff surface, and stays in contact.
void press_on_a_wall(Bench& bench) {
  bench.run(2.0);
  bench.wall = arm_plants::Wall{.point_m = Bench::tool_m(*bench.follower_link) - 0.005 * arm::Vector3::UnitZ(),
                                .normal = arm::Vector3::UnitZ(),
                                .contact = *mechanics::Environment::make(
                                    {.stiffness_N_per_m = 20'000.0, .damping_N_s_per_m = 20.0}, Seconds{1e-3})};
  const arm::Vector3 from_m = Bench::tool_m(*bench.leader_link);
  for (int i = 1; i <= 50; ++i) {
    bench.hand_at_m = from_m - 0.0005 * i * arm::Vector3::UnitZ();
    bench.run(0.02);
  }
  bench.run(0.5);
}

std::string text_of(const Bench& bench) {
  std::string text;
  for (const auto& [side, tare] : {std::pair{"leader ", &bench.last.leader_tare.report},
                                   std::pair{"follower ", &bench.last.follower_tare.report}}) {
    text += std::string(side) + name_of(tare->state) + " at joint " + std::to_string(tare->joint) + ": " +
            std::to_string(tare->value) + "; ";
  }
  return text + name_of(bench.last.cause) + " " + name_of(bench.last.support.fault) + " moved " +
         std::to_string(bench.last.support.moved_m);
}

TEST(RigRequests, AForceGainThatChangesAThousandTimesInContactStepsNoTorque) {
  constexpr double limit = 2.0, rate_per_s = 1.0, tick_s = 1e-9 * tick_ns;
  Bench bench({}, {}, {"rig.supervision.force_gain.limit=2"});
  ASSERT_TRUE(bench.couple());
  press_on_a_wall(bench);
  ASSERT_GT(bench.contact.force_N.z(), 1.0);
  bench.run(2.0);
  const auto& leader = bench.loop->sites().master();
  const auto passed_Nm = [&] {
    arm::JointVector all(static_cast<Eigen::Index>(joints));
    for (std::size_t i = 0; i < joints; ++i) {
      all[static_cast<Eigen::Index>(i)] = leader.site().gates()[i].motor().passed_N();
    }
    return all;
  };
  signal::Random random(45);
  arm::JointVector before_Nm = passed_Nm();
  double gain = leader.force_gain().gain(), asked = gain, lowest = gain, highest = gain, most_step_Nm = 0.0;
  int limited_ticks = 0, in_contact = 0;
  EXPECT_EQ(gain, 0.5) << "that of the file";
  for (int change = 0; change < 1000; ++change) {
    asked = limit * random.uniform();
    ASSERT_TRUE(bench.exchange.ask(SiteCommand(SiteWord::set, asked)));
    for (int tick = 0; tick < 6; ++tick) {
      bench.run(tick_s);
      const arm::JointVector now_Nm = passed_Nm();
      most_step_Nm = std::max(most_step_Nm, (now_Nm - before_Nm).cwiseAbs().maxCoeff());
      before_Nm = now_Nm;
      EXPECT_LE(std::fabs(leader.force_gain().gain() - gain), rate_per_s * tick_s * (1.0 + 1e-9));
      gain = leader.force_gain().gain();
      lowest = std::min(lowest, gain);
      highest = std::max(highest, gain);
      limited_ticks += leader.site().limit() == control::ActiveLimit::rate ? 1 : 0;
      in_contact += bench.contact.force_N.z() > 0.0 ? 1 : 0;
    }
  }
  RecordProperty("most_step_Nm", std::to_string(most_step_Nm));
  RecordProperty("gains", std::to_string(lowest) + " to " + std::to_string(highest));
  EXPECT_GT(in_contact, 5900);
  EXPECT_GE(lowest, 0.0);
  EXPECT_LE(highest, limit);
  EXPECT_GT(highest - lowest, 0.2) << "it did change";
  constexpr double rate_limit_Nm_per_s = 400.0;
  EXPECT_LE(most_step_Nm, rate_limit_Nm_per_s * tick_s * (1.0 + 1e-9));
  EXPECT_EQ(limited_ticks, 0) << "and no gate had to hold a step back";
  EXPECT_EQ(bench.last.follower, SiteState::active);
  EXPECT_EQ(bench.loop->totals().holds, 0);
  bench.run(2.0);
  EXPECT_EQ(leader.force_gain().gain(), asked);
  EXPECT_EQ(bench.last.force_gain, asked);
}

TEST(RigRequests, AnArmingKeepsTheForceGainThatWasSet) {
  Bench bench;
  ASSERT_TRUE(bench.couple());
  ASSERT_TRUE(bench.exchange.ask(SiteCommand(SiteWord::set, 0.2)));
  bench.run(1.0);
  ASSERT_TRUE(bench.exchange.ask(SiteCommand(SiteWord::stop)));
  bench.run(1.0);
  EXPECT_EQ(bench.last.leader, SiteState::fault);
  ASSERT_TRUE(bench.exchange.ask(SiteCommand(SiteWord::clear)));
  bench.run(0.1);
  EXPECT_EQ(bench.loop->sites().master().site().force_gain(), 0.2);
  EXPECT_EQ(bench.loop->sites().master().force_gain().limit(), 0.5) << "without a limit that of the file";
}

/// The arm as its sites believe it to be, with masses that are wrong by a twentieth.
arm::Chain::Params too_light() {
  arm::Chain::Params model = setup_of().leader.arm.chain;
  for (auto& joint : model.joints) joint.body.mass_kg *= 0.95;
  return model;
}

TEST(RigRequests, ATareFindsWhatBothModelsOfGravityLackAndContactStaysFelt) {
  Bench bench({}, too_light());
  ASSERT_TRUE(bench.couple()) << text_of(bench);
  bench.run(1.0);
  const auto follower_N = [&](std::size_t joint) { return bench.loop->sites().slave().site().weight_N()[joint]; };
  const double carried_before_Nm = follower_N(1);
  ASSERT_TRUE(bench.exchange.ask("tare", SiteRole::master, RequestSource::operator_input).error().code ==
              ErrorCode::inconsistent)
      << "nobody allowed it";
  bench.exchange.allow({.most_force_gain = 0.5, .file_force_gain = 0.5, .tares = true});
  ASSERT_TRUE(bench.exchange.ask("tare", SiteRole::master, RequestSource::page));
  bench.run(2.5);
  EXPECT_EQ(bench.last.leader_tare.report.state, TareState::under_way);
  bench.run(3.5);
  EXPECT_EQ(bench.last.leader, SiteState::armed) << "until somebody presses the dead-man switch";
  ASSERT_EQ(bench.last.leader_tare.report.state, TareState::done) << text_of(bench);
  ASSERT_EQ(bench.last.follower_tare.report.state, TareState::done) << text_of(bench);
  const auto truth = *arm::Chain::make(bench.setup.leader.arm.chain), model = *arm::Chain::make(too_light());
  for (const auto& [link, tare] : {std::pair{bench.leader_link.get(), &bench.last.leader_tare},
                                   std::pair{bench.follower_link.get(), &bench.last.follower_tare}}) {
    const arm::JointVector at = Bench::positions(*link);
    const arm::JointVector lacking = truth.gravity_torque(at) - model.gravity_torque(at);
    EXPECT_GT(lacking.cwiseAbs().maxCoeff(), 0.15);
    for (std::size_t i = 0; i < joints; ++i) {
      EXPECT_NEAR(tare->found_Nm[i], lacking[static_cast<Eigen::Index>(i)], 0.08) << i;
    }
  }
  EXPECT_NEAR(follower_N(1) - carried_before_Nm, bench.last.follower_tare.found_Nm[1], 0.1) << "and it acts";
  // A contact that lasts is still reported as it was at first, for nothing follows it with time.
  ASSERT_TRUE(bench.exchange.ask(SiteCommand(SiteWord::press)));
  bench.run(1.0);
  press_on_a_wall(bench);
  EXPECT_EQ(bench.last.follower, SiteState::active);
  const auto told_Nm = [&] {
    double sum = 0.0;
    for (const auto& joint : bench.loop->sites().master().heard().message) sum += joint.force_N * joint.force_N;
    return std::sqrt(sum);
  };
  const double at_first_Nm = told_Nm();
  EXPECT_GT(at_first_Nm, 0.2);
  bench.run(5.0);
  EXPECT_NEAR(told_Nm(), at_first_Nm, 0.3 * at_first_Nm);
}

TEST(RigRequests, ATareThatIsInterruptedChangesNothing) {
  Bench bench({}, too_light());
  ASSERT_TRUE(bench.couple()) << text_of(bench);
  ASSERT_TRUE(bench.exchange.ask(SiteCommand(SiteWord::tare)));
  bench.run(1.5);
  EXPECT_EQ(bench.last.follower_tare.report.state, TareState::under_way);
  ASSERT_TRUE(bench.exchange.ask(SiteCommand(SiteWord::press)));
  bench.run(1.5);
  EXPECT_EQ(bench.last.follower, SiteState::active);
  EXPECT_EQ(bench.last.follower_tare.report.state, TareState::stopped);
  EXPECT_EQ(bench.last.leader_tare.report.state, TareState::stopped);
  for (const double found_Nm : bench.loop->sites().slave().site().tared_N()) EXPECT_EQ(found_Nm, 0.0);
}

TEST(RigRequests, AnOperatorsTareArmsAndAPagesDoesNot) {
  Bench bench;
  bench.start({.listen_before_arming_s = 0.1});
  ASSERT_TRUE(bench.exchange.ask(SiteCommand(SiteWord::tare, 0.0, RequestSource::page)));
  bench.run(2.0);
  EXPECT_EQ(bench.last.leader, SiteState::configure);
  ASSERT_TRUE(bench.exchange.ask(SiteCommand(SiteWord::tare)));
  for (int i = 0; i < 20 && bench.last.follower_tare.report.state != TareState::done; ++i) bench.run(1.0);
  EXPECT_EQ(bench.last.follower_tare.report.state, TareState::done) << text_of(bench);
  EXPECT_EQ(bench.last.leader_tare.report.state, TareState::done) << text_of(bench);
  EXPECT_EQ(bench.last.leader, SiteState::armed);
  EXPECT_EQ(bench.loop->totals().active_ticks, 0);
}

}  // namespace rig_arms_test
}  // namespace tactus::devices
