// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/sign_probe.hpp>
#include <tactus/kernel/control/support_law.hpp>

#include <algorithm>
#include <cmath>

#include "tests/control/rubbing_device.hpp"
#include <gtest/gtest.h>

/// The trial of a motor whose joint is damped: how fast and how far it moves the joint, whatever its mass.
namespace tactus::control {
namespace gentle_trial_test {

using test::Device;

constexpr double tick_s = 200e-6;
constexpr Seconds tick{tick_s};

struct Tried {
  ProbeVerdict verdict = ProbeVerdict::none;
  double fastest_rad_per_s = 0.0;
  double farthest_rad = 0.0;
};

/// `leans_N_m`: what friction bears before the trial.
Tried try_motor(const SignProbe::Params& params, Device joint, double leans_N_m = 0.0) {
  SignProbe probe = SignProbe::make(params, tick).value();
  Tried tried;
  for (int i = 0; i < 100000 && probe.verdict() == ProbeVerdict::none; ++i) {
    joint.push(probe.step({.probing = true, .position_m = joint.read_m()}), leans_N_m);
    tried.fastest_rad_per_s = std::max(tried.fastest_rad_per_s, std::fabs(joint.velocity_m_per_s));
    tried.farthest_rad = std::max(tried.farthest_rad, std::fabs(joint.position_m));
  }
  tried.verdict = probe.verdict();
  return tried;
}

/// Joint 4 of a YAM with the torque of an OpenArm's: 1.5 N m, and a drive that damps by 1.5 N m s/rad.
constexpr SignProbe::Params asked{.force_N = 1.5, .duration_s = 0.3, .least_m = 0.0015, .most_m = 0.3};
SupportCheck::Params held_by(double damping_limit) {
  return with_holding_law(
      {.raise_s = 4.0},
      {.damping_limit_N_s_per_m = damping_limit, .force_limit_N = 3.0, .trial_force_N = asked.force_N}, tick);
}

TEST(GentleTrial, ADampedJointMovesAtForceOverDampingAndNoFasterThanThreeQuartersOfWhatIsJudged) {
  const SupportCheck::Params held = held_by(1.5);
  const SignProbe::Params gentle = with_gentle_trial(asked, held, 0.01);
  EXPECT_NEAR(gentle.force_N, 0.75 * 0.4 * 1.5, 1e-12);
  EXPECT_EQ(gentle.most_force_N, asked.force_N);
  for (const double inertia : {1e-4, 1e-3, 0.01, 0.05}) {
    for (const double friction : {0.0, 0.06, 0.2}) {
      const Device joint{.mass_kg = inertia, .friction_N = friction, .damper_N_s_per_m = 1.5};
      const Tried tried = try_motor(gentle, joint);
      EXPECT_EQ(tried.verdict, ProbeVerdict::passed) << inertia << ' ' << friction;
      const double most = friction == 0.0 ? gentle.force_N / 1.5 + 1e-6 : held.most_m_per_s;
      EXPECT_LE(tried.fastest_rad_per_s, most) << inertia << ' ' << friction;
      EXPECT_LE(tried.farthest_rad, 0.5 * held.most_m) << inertia << ' ' << friction;
    }
  }
  // What was asked for throws such a joint: faster than any may be before it is released.
  const Tried thrown = try_motor(asked, {.mass_kg = 0.02, .friction_N = 0.06, .damper_N_s_per_m = 1.5});
  EXPECT_GT(thrown.fastest_rad_per_s, 0.5);
  EXPECT_GT(thrown.farthest_rad, held.most_m);
}

TEST(GentleTrial, ATrialIsShortenedWhereTheTorqueThatIsAskedForGoesTooFar) {
  // F·T/(10·B) = 20 mrad/2.
  EXPECT_NEAR(with_gentle_trial(asked, held_by(3.3), 0.01).duration_s, 0.22, 1e-12);
  EXPECT_EQ(with_gentle_trial(asked, held_by(1.5), 0.01).duration_s, 0.2) << "and no further";
  EXPECT_NEAR(with_gentle_trial(asked, held_by(1.5), 0.3).duration_s, std::sqrt(200.0 * 0.0015 * 0.3 / 1.5), 1e-12)
      << "long enough for its inertia";
  EXPECT_EQ(with_gentle_trial(asked, held_by(8.0), 0.01).duration_s, asked.duration_s);
}

TEST(GentleTrial, AJointThatRubsIsTriedUpToTheTorqueThatWasAskedFor) {
  const SignProbe::Params gentle = with_gentle_trial(asked, held_by(1.5), 0.01);
  const auto rubbing = [](double friction) {
    return Device{.mass_kg = 0.01, .friction_N = friction, .damper_N_s_per_m = 1.5};
  };
  const Tried tried = try_motor(gentle, rubbing(0.6));
  EXPECT_EQ(tried.verdict, ProbeVerdict::passed);
  EXPECT_LT(tried.fastest_rad_per_s, 0.5);
  EXPECT_EQ(try_motor(gentle, rubbing(1.6)).verdict, ProbeVerdict::still);
  Device reversed = rubbing(0.6);
  reversed.gain = -1.0;
  EXPECT_EQ(try_motor(gentle, reversed).verdict, ProbeVerdict::reversed);
}

TEST(GentleTrial, AJointThatLeansOnItsFrictionMovesBothWaysUnderALargerTorque) {
  // 0.45 N m overcomes 0.3 N m of friction one way alone while 0.2 N m lean on it.
  const Device leaning{.mass_kg = 0.01, .friction_N = 0.3, .damper_N_s_per_m = 1.5};
  const SignProbe::Params gentle = with_gentle_trial(asked, held_by(1.5), 0.01);
  SignProbe::Params once = gentle;
  once.most_force_N = 0.0;
  EXPECT_EQ(try_motor(once, leaning, 0.2).verdict, ProbeVerdict::astray);
  EXPECT_EQ(try_motor(gentle, leaning, 0.2).verdict, ProbeVerdict::passed);
}

TEST(GentleTrial, WithoutADamperOrATrialNothingChanges) {
  EXPECT_EQ(with_gentle_trial(asked, held_by(0.0), 0.01).force_N, asked.force_N);
  SignProbe::Params none = asked;
  none.force_N = 0.0;
  EXPECT_EQ(with_gentle_trial(none, held_by(1.5), 0.01).force_N, 0.0);
}

}  // namespace gentle_trial_test
}  // namespace tactus::control
