// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/damiao/motor.hpp>

#include <bit>
#include <cmath>

#include <gtest/gtest.h>

namespace tactus::emulation::damiao {
namespace motor_test {

using Bytes = std::array<std::uint8_t, 8>;
constexpr std::int64_t ms = 1'000'000;

Frame order(std::uint8_t what) { return {1, {255, 255, 255, 255, 255, 255, 255, what}}; }
Frame ask(std::uint8_t what, std::uint8_t which = 0, std::uint32_t value = 0) {
  return {0x7ff, {1, 0, what, which, static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value >> 8)}};
}
/// MIT, DM4310: the torque's twelve bits, all else zero as the page has it.
Frame torque(std::uint32_t code) {
  return {1, {0x7f, 0xff, 0x7f, 0xf0, 0, 0, static_cast<std::uint8_t>(code >> 8), static_cast<std::uint8_t>(code)}};
}
constexpr std::uint32_t one_newton_metre = 2252;  // trunc((1 + 10) / 20 · 4095)
constexpr double torque_step_Nm = 20.0 / 4095.0;

Motor motor_with(const JointParams& joint) { return Motor({.id = 1, .feedback_id = 0x11, .joint = joint}); }

TEST(DamiaoMotor, FeedbackIsThatOfTheProtocolPage) {
  // At rest where the page's vector is; torque and temperatures are not to be had without a push.
  Motor motor = motor_with({.position_rad = 0.999657});
  const auto told = motor.answer(ask(0xcc), 0);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->id, 0x11U);
  EXPECT_EQ(told->bytes, (Bytes{0x01, 0x8a, 0x3c, 0x80, 0x08, 0x00, 30, 28}));
  ASSERT_TRUE(motor.answer(order(0xfc), ms));
  EXPECT_EQ(motor.answer(ask(0xcc), 2 * ms)->bytes[0], 0x11);
}

TEST(DamiaoMotor, AStatusThatIsNotItsOwnIsReportedAndChangesNothingElse) {
  Motor motor = motor_with({});
  motor.answer(order(0xfc), 0);
  motor.report(std::uint8_t{7});
  EXPECT_EQ(motor.answer(ask(0xcc), ms)->bytes[0], 0x71);
  EXPECT_EQ(motor.answer(ask(0x33, 10), ms)->bytes[0], 1) << "an answer of a register begins with the identifier";
  EXPECT_TRUE(motor.enabled());
  motor.answer(order(0xfd), 2 * ms);
  EXPECT_FALSE(motor.enabled());
  motor.report(std::nullopt);
  EXPECT_EQ(motor.answer(ask(0xcc), 3 * ms)->bytes[0], 0x01);
}

TEST(DamiaoMotor, OneThatIgnoresDisableAnswersItAndKeepsItsPowerUntilItsWatchdogTakesIt) {
  Motor motor = motor_with({});
  motor.answer(order(0xfc), 0);
  motor.ignore_disable(true);
  EXPECT_EQ(motor.answer(order(0xfd), ms)->bytes[0], 0x11);
  EXPECT_TRUE(motor.enabled());
  motor.live_until(500 * ms);  // its register says 400 ms
  EXPECT_EQ(motor.status(), 0xd);
}

TEST(DamiaoMotor, ATorqueTurnsItsJointAsItsInertiaSays) {
  Motor motor = motor_with({.inertia_kgm2 = 0.05, .damping_Nms_per_rad = 0.0, .friction_Nm = 0.0});
  motor.answer(order(0xfc), 0);
  motor.answer(torque(one_newton_metre), 0);
  motor.live_until(100 * ms);
  const double given_Nm = -10.0 + torque_step_Nm * one_newton_metre;
  EXPECT_NEAR(motor.torque_Nm(), given_Nm, 1e-9);
  EXPECT_NEAR(motor.velocity_rad_per_s(), given_Nm / 0.05 * 0.1, 1e-9);
  EXPECT_NEAR(motor.position_rad(), given_Nm / 0.05 * 0.1 * 0.1 / 2.0, 0.002);
}

TEST(DamiaoMotor, StiffnessAndDampingMakeAnOscillatorOfTheRightPeriod) {
  Motor motor = motor_with({.inertia_kgm2 = 0.05, .damping_Nms_per_rad = 0.0, .friction_Nm = 0.0, .position_rad = 0.2});
  motor.answer(order(0xfc), 0);
  // kp = 20: code trunc(20 / 500 · 4095) = 163 = 0a3; the page's zero for the rest.
  motor.answer({1, {0x7f, 0xff, 0x7f, 0xf0, 0xa3, 0x00, 0x07, 0xff}}, 0);
  const double stiffness = 163.0 * 500.0 / 4095.0, period_s = 2.0 * 3.14159265358979 * std::sqrt(0.05 / stiffness);
  motor.live_until(std::llround(period_s * 1e9));
  EXPECT_NEAR(motor.position_rad(), 0.2, 0.003);
  motor.answer({1, {0x7f, 0xff, 0x7f, 0xf0, 0xa3, 0x00, 0x07, 0xff}}, std::llround(period_s * 1e9));
  motor.live_until(std::llround(period_s * 1.5e9));
  EXPECT_NEAR(motor.position_rad(), -0.2, 0.004);
}

TEST(DamiaoMotor, ItStaysWithinItsFriction) {
  Motor motor = motor_with({.friction_Nm = 1.5});
  motor.answer(order(0xfc), 0);
  motor.answer(torque(one_newton_metre), 0);
  motor.live_until(300 * ms);
  EXPECT_EQ(motor.position_rad(), 0.0);
}

TEST(DamiaoMotor, WithoutPowerItTakesNoTorqueAndSwitchingOnGivesNoneFromBefore) {
  Motor motor = motor_with({});
  motor.answer(torque(one_newton_metre), 0);
  motor.live_until(10 * ms);
  EXPECT_EQ(motor.most_torque_Nm(), 0.0);
  motor.answer(order(0xfc), 10 * ms);
  motor.answer(torque(one_newton_metre), 11 * ms);
  motor.answer(order(0xfd), 12 * ms);
  motor.live_until(13 * ms);
  EXPECT_EQ(motor.torque_Nm(), 0.0);
  motor.answer(order(0xfc), 14 * ms);
  motor.live_until(15 * ms);
  EXPECT_EQ(motor.torque_Nm(), 0.0);
  EXPECT_NEAR(motor.most_torque_Nm(), 1.0, torque_step_Nm);
}

TEST(DamiaoMotor, SilenceLongerThanItsTimeoutTakesItsPower) {
  Motor motor = motor_with({});
  motor.answer(ask(0x55, 9, 400), 0);  // 20 ms
  motor.answer(order(0xfc), ms);
  motor.answer(torque(one_newton_metre), 2 * ms);
  motor.live_until(22 * ms);
  EXPECT_TRUE(motor.enabled());
  motor.live_until(22 * ms + ms / 5);
  EXPECT_EQ(motor.status(), 0xd);
  EXPECT_EQ(motor.torque_Nm(), 0.0);
  motor.answer(order(0xfc), 30 * ms);
  EXPECT_EQ(motor.status(), 0xd);
  motor.answer(order(0xfb), 31 * ms);
  EXPECT_EQ(motor.status(), 0);
  motor.answer(ask(0x55, 9, 0), 32 * ms);
  motor.answer(order(0xfc), 33 * ms);
  motor.live_until(10'000 * ms);
  EXPECT_TRUE(motor.enabled());
}

TEST(DamiaoMotor, AFaultThatStaysIsNotCleared) {
  Motor motor = motor_with({});
  motor.fail(0xb, true);
  motor.answer(order(0xfb), 0);
  EXPECT_EQ(motor.status(), 0xb);
  EXPECT_GT(motor.answer(ask(0xcc), 0)->bytes[6], 100);
  motor.recover();
  motor.answer(order(0xfb), 0);
  EXPECT_EQ(motor.status(), 0x0);
}

TEST(DamiaoMotor, RegistersAreReadAndWritten) {
  Motor motor({.id = 1, .feedback_id = 0x11, .type = MotorType::dm4340});
  const auto real = [&motor](std::uint8_t which) {
    const auto told = motor.answer(ask(0x33, which), 0);
    EXPECT_EQ((Bytes{told->bytes[0], told->bytes[1], told->bytes[2], told->bytes[3]}), (Bytes{1, 0, 0x33, which}));
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < 4; ++i) bits |= static_cast<std::uint32_t>(told->bytes[4 + i]) << (8 * i);
    return std::bit_cast<float>(bits);
  };
  EXPECT_EQ(real(21), 12.5F);
  EXPECT_EQ(real(22), 10.0F);
  EXPECT_EQ(real(23), 28.0F);
  EXPECT_EQ(motor.answer(ask(0x55, 9, 1000), 0)->bytes, (Bytes{1, 0, 0x55, 9, 0xe8, 3, 0, 0}));
  EXPECT_EQ(motor.answer(ask(0x33, 9), 0)->bytes, (Bytes{1, 0, 0x33, 9, 0xe8, 3, 0, 0}));
}

TEST(DamiaoMotor, AFrameForAnotherIsNotAnswered) {
  Motor motor = motor_with({});
  EXPECT_FALSE(motor.answer({2, {}}, 0));
  EXPECT_FALSE(motor.answer({0x7ff, {2, 0, 0xcc}}, 0));
  EXPECT_FALSE(motor.answer({0x7ff, {1, 1, 0xcc}}, 0));
  EXPECT_TRUE(motor.answer({0x201, {}}, 0));
}

TEST(DamiaoMotor, WithoutPowerItLosesItsTurnsOnce) {
  constexpr double turn_rad = 2.0 * 3.14159265358979;
  Motor motor = motor_with({.position_rad = turn_rad + 1.0});
  motor.answer(order(0xfc), 0);
  motor.lose_power(10 * ms);
  EXPECT_TRUE(motor.is_off(309 * ms));
  EXPECT_FALSE(motor.is_off(310 * ms));
  EXPECT_FALSE(motor.enabled());
  EXPECT_NEAR(motor.position_rad(), 1.0, 1e-9);
  motor.answer(order(0xfc), 400 * ms);
  motor.lose_power(500 * ms);
  EXPECT_TRUE(motor.enabled()) << "it happens once";
  // One of an arm is turned to where the arm is, and keeps what it lost.
  Motor of_arm = motor_with({});
  of_arm.turn_with_others();
  of_arm.turn_to(-turn_rad + 0.5, 0.0);
  of_arm.lose_power(10 * ms);
  of_arm.turn_to(-turn_rad + 0.6, 0.0);
  EXPECT_NEAR(of_arm.position_rad(), 0.6, 1e-9);
}

TEST(DamiaoMotor, ItsNumberOfThePositionGoesAroundAtItsEnd) {
  Motor motor = motor_with({.position_rad = 12.6});
  // −12.4 of ±12.5: the code round(0.1 / 25 · 65535) = 262.
  const auto told = motor.answer(ask(0xcc), 0);
  EXPECT_EQ(told->bytes[1] << 8 | told->bytes[2], 262);
}

}  // namespace motor_test
}  // namespace tactus::emulation::damiao
