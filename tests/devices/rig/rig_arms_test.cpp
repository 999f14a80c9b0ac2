// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>
#include <tests/devices/rig/arms_bench.hpp>
#include <tests/devices/rig/rig_files.hpp>

namespace tactus::devices {
namespace rig_arms_test {

double mm_between(const arm::Vector3& one, const arm::Vector3& other) { return 1e3 * (one - other).norm(); }

TEST(RigArms, AlignCarryThemselvesTryEachMotorAndTheFollowerGoesToItsLeader) {
  Bench bench;
  bench.run(0.05);
  EXPECT_TRUE(bench.leader_link->arm->held());
  const auto leader_m = Bench::tool_m(*bench.leader_link);
  ASSERT_TRUE(bench.couple()) << name_of(bench.last.cause) << " " << name_of(bench.last.leader) << " "
                              << name_of(bench.last.fault) << bench.last.fault_joint << " "
                              << name_of(bench.last.support.fault) << " of joint " << bench.last.support.joint
                              << " at share " << bench.last.support.share << ": moved " << bench.last.support.moved_m
                              << " at " << bench.last.support.speed_m_per_s << ", excess "
                              << bench.last.support.excess_N << " of " << bench.last.support.weight_N;
  EXPECT_FALSE(bench.leader_link->arm->held()) << "its motors carry it";
  EXPECT_FALSE(bench.follower_link->arm->held());
  bench.run(3.0);
  EXPECT_EQ(bench.last.follower, SiteState::active);
  EXPECT_EQ(bench.loop->totals().armings, 1);
  EXPECT_EQ(bench.loop->totals().holds, 0);
  EXPECT_LT(bench.apart(), 0.03) << "it began 0.15 rad away";
  EXPECT_LT(mm_between(Bench::tool_m(*bench.leader_link), leader_m), 40.0) << "nobody holds the leader";
  EXPECT_GT(Bench::torques(*bench.leader_link).cwiseAbs().maxCoeff(), 1.0) << "it has a weight";
}

TEST(RigArms, AnArmingBeforeTheFirstReadingsWaitsForThem) {
  Bench bench;
  bench.start({.listen_before_arming_s = 0.1});
  ASSERT_TRUE(bench.exchange.words.try_push(runtime::SiteWord::arm));
  EXPECT_TRUE(bench.couple()) << "typed before the first control cycle";
}

/// The arm with masses and lengths that are so many times as large.
arm::Chain::Params scaled(double masses, double lengths) {
  arm::Chain::Params model = setup_of().leader.arm.chain;
  for (auto& joint : model.joints) {
    joint.body.mass_kg *= masses;
    for (double* of : {&joint.origin.x_m, &joint.origin.y_m, &joint.origin.z_m, &joint.body.centre_x_m,
                       &joint.body.centre_y_m, &joint.body.centre_z_m}) {
      *of *= lengths;
    }
  }
  return model;
}

TEST(RigArms, AUrdfInMillimetresGetsNoPower) {
  Bench bench({}, scaled(1.0, 1000.0));
  for (int i = 0; i < 20; ++i) {
    bench.run(0.1);
    for (std::size_t motor = 0; motor <= joints; ++motor) {
      EXPECT_FALSE(bench.leader_link->peer->motor(motor).enabled()) << motor;
      EXPECT_FALSE(bench.follower_link->peer->motor(motor).enabled()) << motor;
    }
  }
  EXPECT_EQ(bench.last.leader, SiteState::configure);
  EXPECT_EQ(bench.last.follower, SiteState::configure);
  EXPECT_EQ(bench.last.cause, control::SiteCause::weight);
  EXPECT_EQ(bench.last.support.fault, control::SupportFault::weight);
  EXPECT_TRUE(bench.last.support_of_leader);
  EXPECT_GT(std::fabs(bench.last.support.weight_N), bench.last.support.limit_N);
}

TEST(RigArms, AnArmWhoseModelIsHalfAsHeavyAgainIsReleasedBeforeAJointLeaps) {
  Bench bench({}, scaled(1.5, 1.0));
  const arm::JointVector began = Bench::positions(*bench.leader_link);
  double farthest_rad = 0.0;
  for (int i = 0; i < 4000 && bench.last.support.fault == control::SupportFault::none; ++i) {
    farthest_rad = std::max(farthest_rad, (Bench::positions(*bench.leader_link) - began).cwiseAbs().maxCoeff());
    bench.run(0.002);
    const auto& site = bench.loop->sites().master();
    if (site.state() == SiteState::hold) break;
  }
  bench.run(1.0);
  EXPECT_LT(farthest_rad, 0.03);
  EXPECT_EQ(bench.last.cause, control::SiteCause::support);
  EXPECT_GT(bench.last.support.share, 0.66);
  EXPECT_GT(bench.last.support.excess_N * bench.last.support.weight_N, 0.0) << "it rose";
  for (std::size_t motor = 0; motor <= joints; ++motor) {
    EXPECT_FALSE(bench.leader_link->peer->motor(motor).enabled()) << motor;
  }
}

TEST(RigArms, TheFollowerFollowsAHandAndItsContactComesBack) {
  Bench bench;
  ASSERT_TRUE(bench.couple());
  bench.run(2.0);
  const arm::Vector3 began_m = Bench::tool_m(*bench.leader_link);
  const arm::Vector3 follower_m = Bench::tool_m(*bench.follower_link);
  const auto move = [&](const arm::Vector3& from_m, const arm::Vector3& to_m) {
    for (int i = 1; i <= 100; ++i) {
      bench.hand_at_m = from_m + 0.01 * i * (to_m - from_m);
      bench.run(0.01);
    }
    bench.run(0.5);
  };
  const arm::Vector3 aside_m = began_m + arm::Vector3(0.0, 0.03, 0.03);
  move(began_m, aside_m);
  const arm::Vector3 went_m = Bench::tool_m(*bench.leader_link) - began_m;
  EXPECT_GT(went_m.norm(), 0.02);
  EXPECT_LT((Bench::tool_m(*bench.follower_link) - follower_m - went_m).norm(), 0.01);

  // Down onto a stiff surface, 10 mm below where the follower is now, and 15 mm beyond.
  bench.wall = arm_plants::Wall{.point_m = Bench::tool_m(*bench.follower_link) - 0.01 * arm::Vector3::UnitZ(),
                                .normal = arm::Vector3::UnitZ(),
                                .contact = *mechanics::Environment::make(
                                    {.stiffness_N_per_m = 20'000.0, .damping_N_s_per_m = 20.0}, Seconds{1e-3})};
  const auto displayed = [&] {
    const auto chain = *arm::Chain::make(bench.setup.follower.arm.chain);
    return (Bench::torques(*bench.leader_link) - chain.gravity_torque(Bench::positions(*bench.leader_link))).eval();
  };
  const arm::JointVector before = displayed();
  move(aside_m, aside_m - 0.025 * arm::Vector3::UnitZ());
  EXPECT_EQ(bench.last.follower, SiteState::active);
  const double contact_N = bench.contact.force_N.z();
  EXPECT_GT(contact_N, 1.0);
  EXPECT_LT(contact_N, 20.0);
  const auto chain = *arm::Chain::make(bench.setup.follower.arm.chain);
  const arm::JointVector of_contact =
      chain.jacobian(Bench::positions(*bench.follower_link), 6, bench.setup.follower.arm.tool_m)
          .topRows<3>()
          .transpose() *
      bench.contact.force_N;
  const double share = (displayed() - before).dot(of_contact) / of_contact.squaredNorm();
  // At a gain of 0.5, less what friction hides from the observer.
  RecordProperty("contact_N", std::to_string(contact_N));
  RecordProperty("displayed_share", std::to_string(share));
  // Between two readings a motor goes on by its law: its torque may leave the limit by the stiffness times the way.
  constexpr double way_rad = 0.01;
  double beyond_Nm = -1e9;
  for (const auto& [link, side] : {std::pair{bench.leader_link.get(), &*bench.pair.leader},
                                   std::pair{bench.follower_link.get(), &*bench.pair.follower}}) {
    for (std::size_t i = 0; i < joints; ++i) {
      const MotorJoint& joint = side->joints[i].joint;
      const auto& motor = link->peer->motor(i);
      const double most_Nm = std::max(motor.most_torque_Nm(), -motor.least_torque_Nm());
      beyond_Nm = std::max(beyond_Nm, most_Nm - joint.torque_limit_Nm);
      EXPECT_LE(most_Nm, joint.torque_limit_Nm + way_rad * joint.stiffness_limit_Nm_per_rad) << side->path << i;
    }
  }
  RecordProperty("beyond_Nm", std::to_string(beyond_Nm));
  EXPECT_GT(share, 0.1);
  EXPECT_LT(share, 0.8);
}

TEST(RigArms, LettingGoOfTheDeadManSwitchDropsNeither) {
  Bench bench;
  ASSERT_TRUE(bench.couple());
  bench.run(2.0);
  const auto leader_m = Bench::tool_m(*bench.leader_link), follower_m = Bench::tool_m(*bench.follower_link);
  ASSERT_TRUE(bench.exchange.words.try_push(runtime::SiteWord::release));
  bench.run(2.0);
  EXPECT_EQ(bench.last.leader, SiteState::armed);
  EXPECT_EQ(bench.last.follower, SiteState::armed);
  EXPECT_LT(mm_between(Bench::tool_m(*bench.leader_link), leader_m), 15.0);
  EXPECT_LT(mm_between(Bench::tool_m(*bench.follower_link), follower_m), 10.0);
}

TEST(RigArms, AFollowerThatIsNotHeardAnyMoreLosesItsPowerAndTheLeaderFloats) {
  Bench bench;
  ASSERT_TRUE(bench.couple());
  bench.run(2.0);
  const auto leader_m = Bench::tool_m(*bench.leader_link), follower_m = Bench::tool_m(*bench.follower_link);
  bench.follower_link->cut = true;
  bench.run(2.0);
  EXPECT_EQ(bench.last.leader, SiteState::hold);
  EXPECT_EQ(bench.last.follower, SiteState::hold);
  EXPECT_EQ(bench.last.cause, control::SiteCause::device);
  for (std::size_t i = 0; i < joints; ++i) {
    EXPECT_FALSE(bench.follower_link->peer->motor(i).enabled()) << "its own watchdog";
  }
  EXPECT_GT(mm_between(Bench::tool_m(*bench.follower_link), follower_m), 50.0) << "it falls, as an arm without a brake";
  EXPECT_LT(mm_between(Bench::tool_m(*bench.leader_link), leader_m), 15.0);
  EXPECT_TRUE(bench.leader_link->peer->motor(1).enabled());
}

TEST(RigArms, AGripperGoesToWhereItsTriggerIs) {
  Bench bench;
  ASSERT_TRUE(bench.couple());
  bench.run(2.0);
  // It was 0.2 rad away. What the trigger turned while its motor was tried is the offset that stays, as of every joint.
  const double trigger_rad = bench.leader_link->peer->motor(7).position_rad();
  const double gripper_rad = bench.follower_link->peer->motor(7).position_rad();
  EXPECT_NEAR(gripper_rad, trigger_rad, 0.06);
  EXPECT_GT(std::fabs(gripper_rad), 0.1) << "it moved";
}

/// Every fault of the emulated motors that begins while they are driven ends as docs/theory/safety.md says. The arm of
/// a follower that lets go falls, and so its hold becomes a fault.
TEST(RigArms, AFaultOfAMotorLetsItsArmGoAndTheOtherFloats) {
  using emulation::damiao::FaultKind;
  struct Case {
    FaultKind kind;
    std::uint32_t motor;
    bool goes_on;
  };
  for (const Case& c :
       {Case{FaultKind::silence, 2, false}, Case{FaultKind::silence, 0, false}, Case{FaultKind::bus_off, 0, false},
        Case{FaultKind::communication_lost, 2, false}, Case{FaultKind::over_voltage, 4, false},
        Case{FaultKind::hot_winding, 1, false}, Case{FaultKind::overload, 7, false},
        Case{FaultKind::register_answer, 0, true}, Case{FaultKind::garbage, 0, true}}) {
    Bench bench({{.kind = c.kind, .motor = c.motor, .from_ns = 14000 * ms}});
    ASSERT_TRUE(bench.couple());
    const auto leader_m = Bench::tool_m(*bench.leader_link);
    bench.run(14.5 - 1e-9 * static_cast<double>(bench.leader_link->now_ns));
    bench.run(1.0);
    const std::string what = std::string(name_of(c.kind)) + ":" + std::to_string(c.motor);
    if (c.goes_on) {
      EXPECT_EQ(bench.last.follower, SiteState::active) << what;
      EXPECT_EQ(bench.loop->totals().holds, 0) << what;
      continue;
    }
    EXPECT_EQ(bench.last.leader, SiteState::hold) << what;
    EXPECT_TRUE(bench.last.follower == SiteState::hold || bench.last.follower == SiteState::fault) << what;
    for (std::size_t i = 0; i <= joints; ++i) EXPECT_FALSE(bench.follower_link->peer->motor(i).enabled()) << what << i;
    EXPECT_LT(mm_between(Bench::tool_m(*bench.leader_link), leader_m), 15.0) << what;
  }
}

/// The motors' own laws would go on by themselves.
TEST(RigArms, WhenTicksStopTheMotorsLoseTheirPower) {
  Bench bench;
  ASSERT_TRUE(bench.couple());
  bench.advance(40 * ms);
  EXPECT_TRUE(bench.follower_link->peer->motor(1).enabled());
  bench.advance(20 * ms);
  for (std::size_t i = 0; i <= joints; ++i) {
    EXPECT_FALSE(bench.leader_link->peer->motor(i).enabled()) << i;
    EXPECT_FALSE(bench.follower_link->peer->motor(i).enabled()) << i;
  }
}

TEST(RigArms, ATickDoesNotAllocate) {
  Bench bench;
  ASSERT_TRUE(bench.couple());
  const std::int64_t now_ns = bench.leader_link->now_ns;
  const std::uint64_t before = laws::own_allocation_count();
  for (int i = 0; i < 5; ++i) {
    (*bench.loop)({.number = bench.number++, .deadline_ns = now_ns + i * tick_ns, .began_ns = now_ns + i * tick_ns});
  }
  EXPECT_EQ(laws::own_allocation_count(), before);
}

/// What is said of a rig and of what drives it.
std::string problem_of(const std::string& rig_text, const ArmPairSetup& setup) {
  const auto rig = Rig::parse(rig_text, "rig.toml");
  if (!rig) return describe(rig.error());
  const auto arms = as_arms(rig->pairs()[0], setup.params, setup);
  return arms ? std::string() : describe(rig->locate(arms.error()));
}

std::string rig_text(const std::string& follower_more, int count, const std::string& extra = {}) {
  std::string text;
  for (const std::string side : {"arm.leader", "arm.follower"}) {
    text += rig_test::damiao_side(side, "/dev/" + side);
    // From the last to the first: names tell which is which.
    for (int i = count; i >= 1; --i) {
      text +=
          rig_test::joint(side + ".joint_" + std::to_string(i), i, "DM4310",
                          "damping_limit_Nms_per_rad = 5.0\n" + (side == "arm.leader" ? std::string() : follower_more));
    }
    if (!extra.empty()) text += rig_test::joint(side + "." + extra, 8, "DM4310");
  }
  return text;
}

TEST(RigArms, LimitsFarBeyondThoseOfTheUrdfAreRefused) {
  const ArmPairSetup setup = setup_of();
  const std::string stiff = "stiffness_limit_Nm_per_rad = 240.0\n";
  const auto with = [&](const std::string& upper) {
    std::string text = rig_text(stiff, 7);
    const std::string line = "upper_rad = 1.5";
    text.replace(text.find(line, text.find("[arm.follower.joint_4]")), line.size(), "upper_rad = " + upper);
    return problem_of(text, setup);
  };
  EXPECT_EQ(with("3.1"), "");
  EXPECT_EQ(with("6.2"), "") << "half a turn beyond it";
  EXPECT_NE(
      with("10.0").find("arm.follower.joint_4.upper_rad: 10 rad is far beyond where "
                        "../../experiments/arms/openarm-class.urdf lets this joint be, from -3.1 to 3.1 rad: state "
                        "it in rad (10 degrees are 0.1745 rad), or name the joint that the motor moves"),
      std::string::npos)
      << with("10.0");
}

TEST(RigArms, JointsAreThoseOfTheArmByName) {
  const ArmPairSetup setup = setup_of();
  const std::string stiff = "stiffness_limit_Nm_per_rad = 240.0\n";
  EXPECT_EQ(problem_of(rig_text(stiff, 7), setup), "");
  const RigPair pair = *as_arms(Rig::parse(rig_text(stiff, 7), "rig.toml")->pairs()[0], setup.params, setup);
  EXPECT_EQ(pair.follower->joints[0].path, "arm.follower.joint_1");
  EXPECT_EQ(pair.follower->bus.motors[6].id, 7);
  // A joint beside the arm's comes last, whatever it is called.
  EXPECT_EQ(as_arms(pair_of(), setup.params, setup)->leader->joints[7].path, "arm.leader.gripper");
  EXPECT_NE(
      problem_of(rig_text(stiff, 6), setup)
          .find("rig.toml:1:1: arm.leader: the arm of ../../experiments/arms/openarm-class.urdf has a joint joint_7, "
                "and the rig has no such joint: write [arm.leader.joint_7]"),
      std::string::npos)
      << problem_of(rig_text(stiff, 6), setup);
  EXPECT_NE(
      problem_of(rig_text(stiff, 7, "gripper"),
                 setup_of({"rig.gripper.stiffness_N_m_per_rad=0", "rig.gripper.damping_N_m_s_per_rad=0"}))
          .find("arm.leader.gripper: the arm of ../../experiments/arms/openarm-class.urdf has no joint of this name "
                "but joint_1, joint_2, joint_3, joint_4, joint_5, joint_6, joint_7: call it as the arm does; or, where "
                "it is a gripper, write its gains under [rig.gripper] of the experiment"),
      std::string::npos)
      << problem_of(rig_text(stiff, 7, "gripper"),
                    setup_of({"rig.gripper.stiffness_N_m_per_rad=0", "rig.gripper.damping_N_m_s_per_rad=0"}));
}

TEST(RigArms, AFollowerThatIsAnotherArmHasItsOwnJointsAndItsOwnModel) {
  ArmPairSetup setup = setup_of();
  setup.follower.urdf = "other.urdf";
  setup.follower.joints[2] = "elbow";
  const std::string stiff = "stiffness_limit_Nm_per_rad = 240.0\n";
  EXPECT_NE(problem_of(rig_text(stiff, 7), setup)
                .find("arm.follower: the arm of other.urdf has a joint elbow, and the rig has no such joint: write "
                      "[arm.follower.elbow]"),
            std::string::npos)
      << problem_of(rig_text(stiff, 7), setup);
  setup = setup_of();
  setup.follower.arm.chain.joints[0].body.mass_kg = -1.0;
  const Joints<station::DeviceLimits> limits = [] {
    Joints<station::DeviceLimits> found(joints);
    for (std::size_t i = 0; i < joints; ++i) found[i] = pair_of().leader->joints[i].joint.limits();
    return found;
  }();
  const auto sites = arm_sites(setup.params, setup, limits, limits);
  ASSERT_FALSE(sites);
  EXPECT_TRUE(sites.error().parameter.starts_with("control.follower")) << describe(sites.error());
}

TEST(RigArms, ALawBeyondWhatTheRigAllowsIsRefusedBeforeAnythingMoves) {
  const ArmPairSetup setup = setup_of();
  EXPECT_NE(problem_of(rig_text("stiffness_limit_Nm_per_rad = 100.0\n", 7), setup)
                .find("arm.follower.joint_1.stiffness_limit_Nm_per_rad: 100 N m/rad is less than the 144 N m/rad that "
                      "the experiment asks of its motor's own law: write at least that, or lower the gain there"),
            std::string::npos);
  EXPECT_NE(problem_of(rig_text("", 7), setup).find("0 N m/rad is less than the 144 N m/rad"), std::string::npos);
  // Position-position gives the leader's drives a stiffness too.
  EXPECT_NE(
      problem_of(rig_text("stiffness_limit_Nm_per_rad = 500.0\n", 7), setup_of({"control.method=position-position"}))
          .find("arm.leader.joint_1.stiffness_limit_Nm_per_rad: 0 N m/rad is less than the 120 N m/rad"),
      std::string::npos);
  const RigPair pair = *as_arms(pair_of(), setup.params, setup);
  Joints<station::DeviceLimits> limits(joints);
  for (std::size_t i = 0; i < joints; ++i) limits[i] = pair.leader->joints[i].joint.limits();
  const auto refusal = [&](const std::string& key) {
    const ArmPairSetup changed = setup_of({key});
    const auto sites = arm_sites(changed.params, changed, limits, limits);
    return sites ? std::string() : describe(sites.error());
  };
  EXPECT_EQ(refusal("rig.follower_gate.force_limit_N=15"), "");
  EXPECT_EQ(refusal("rig.follower_gate.force_limit_N=10")
                .find("rig.follower_gate.force_limit_N: 10 N is the default, which protects no real device"),
            0U);
  EXPECT_EQ(
      refusal("rig.probe_torque.joint_3.torque_N_m=0").find("rig.supervision.probe.force_N: 0 N m tries no motor"), 0U);
  const std::string weak = refusal("rig.probe_torque.joint_2.torque_N_m=0.001");
  EXPECT_EQ(weak.find("rig.probe_torque.joint_2.torque_N_m: 0.001 N m cannot move joint_2, of "), 0U) << weak;
  EXPECT_NE(weak.find(" up to the gate's limit, "), std::string::npos) << weak;
  EXPECT_EQ(refusal("control.method=four-channel").find("control.method: four-channel control is tried in virtual"),
            0U);
}

}  // namespace rig_arms_test
}  // namespace tactus::devices
