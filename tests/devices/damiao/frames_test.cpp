// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/damiao/frames.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace tactus::devices::damiao {
namespace {

using Data = std::array<std::uint8_t, 8>;

/// The field of so many bits whose highest is number `first`, counted from the highest bit of byte 0.
std::uint32_t bits_of(const Data& data, int first, int count) {
  std::uint64_t all = 0;
  for (const std::uint8_t byte : data) all = all << 8 | byte;
  return static_cast<std::uint32_t>(all << first >> (64 - count));
}

double uniform(double lower, double upper) {
  constexpr int parts = 1'000'000;
  return lower + (upper - lower) * *rc::gen::inRange(0, parts + 1) / parts;
}

const Scale any_scale() {
  return scale_of(
      *rc::gen::elementOf(std::vector{Model::dm3507, Model::dm4310, Model::dm4340, Model::dm8009, Model::dm10010}));
}

TEST(DamiaoFrames, TheVectorsOfTheProtocolPageAreSent) {
  const Scale dm4310 = scale_of(Model::dm4310);
  EXPECT_EQ(mit_frame(1, dm4310, {}).data, (Data{0x7f, 0xff, 0x7f, 0xf0, 0x00, 0x00, 0x07, 0xff}));
  const MitTarget target{.position_rad = 1.0,
                         .velocity_rad_per_s = 0.0,
                         .stiffness_Nm_per_rad = 24.0,
                         .damping_Nms_per_rad = 0.2,
                         .torque_Nm = 0.5};
  EXPECT_EQ(mit_frame(1, dm4310, target).data, (Data{0x8a, 0x3c, 0x7f, 0xf0, 0xc4, 0x0a, 0x38, 0x65}));
  const CanFrame pulled = mit_frame(7, scale_of(Model::dm8009), {.torque_Nm = -3.0});
  EXPECT_EQ(pulled.data, (Data{0x7f, 0xff, 0x7f, 0xf0, 0x00, 0x00, 0x07, 0x8d}));
  EXPECT_EQ(pulled.id, 7U);
  EXPECT_EQ(pulled.size, 8U);
}

TEST(DamiaoFrames, OrdersAndQuestionsAreThoseOfTheProtocolPage) {
  EXPECT_EQ(order_frame(3, Order::enable), (CanFrame{3, 8, {255, 255, 255, 255, 255, 255, 255, 0xfc}}));
  EXPECT_EQ(order_frame(3, Order::disable).data[7], 0xfd);
  EXPECT_EQ(order_frame(3, Order::set_zero).data[7], 0xfe);
  EXPECT_EQ(order_frame(3, Order::clear_fault).data[7], 0xfb);
  EXPECT_EQ(refresh_frame(0x0123), (CanFrame{0x7ff, 8, {0x23, 0x01, 0xcc}}));
  EXPECT_EQ(read_frame(0x0123, Register::velocity_scale), (CanFrame{0x7ff, 8, {0x23, 0x01, 0x33, 22}}));
  EXPECT_EQ(write_frame(1, Register::timeout, 8000), (CanFrame{0x7ff, 8, {1, 0, 0x55, 9, 0x40, 0x1f, 0, 0}}));
}

TEST(DamiaoFrames, TheFeedbackOfTheProtocolPageIsUnderstood) {
  const CanFrame frame{0x11, 8, {0x11, 0x8a, 0x3c, 0x7f, 0xf8, 0x66, 0x1e, 0x1c}};
  const auto told = feedback_of(frame, scale_of(Model::dm4310));
  ASSERT_TRUE(told);
  EXPECT_EQ(told->status, status_enabled);
  EXPECT_EQ(told->motor, 1);
  EXPECT_NEAR(told->position_rad, 0.999657, 5e-7);
  EXPECT_NEAR(told->velocity_rad_per_s, -0.007326, 5e-7);
  EXPECT_NEAR(told->torque_Nm, 0.500611, 5e-7);
  EXPECT_EQ(told->drive_C, 30.0);
  EXPECT_EQ(told->winding_C, 28.0);
  EXPECT_FALSE(feedback_of({0x11, 7, frame.data}, scale_of(Model::dm4310)));
}

TEST(DamiaoFrames, EachNumberStandsInItsBitsAndIsCutByLessThanAStep) {
  EXPECT_TRUE(rc::check([] {
    const Scale scale = any_scale();
    const MitTarget target{.position_rad = uniform(-scale.position_rad, scale.position_rad),
                           .velocity_rad_per_s = uniform(-scale.velocity_rad_per_s, scale.velocity_rad_per_s),
                           .stiffness_Nm_per_rad = uniform(0.0, 500.0),
                           .damping_Nms_per_rad = uniform(0.0, 5.0),
                           .torque_Nm = uniform(-scale.torque_Nm, scale.torque_Nm)};
    const CanFrame frame = mit_frame(2, scale, target);
    const auto cut = [&frame](double sent, double lower, double upper, int first, int count) {
      const double step = (upper - lower) / (std::pow(2.0, count) - 1.0);
      const double lost = sent - (lower + step * bits_of(frame.data, first, count));
      RC_ASSERT(lost >= -1e-9 * step);
      RC_ASSERT(lost <= step * (1.0 + 1e-9));
    };
    cut(target.position_rad, -scale.position_rad, scale.position_rad, 0, 16);
    cut(target.velocity_rad_per_s, -scale.velocity_rad_per_s, scale.velocity_rad_per_s, 16, 12);
    cut(target.stiffness_Nm_per_rad, 0.0, 500.0, 28, 12);
    cut(target.damping_Nms_per_rad, 0.0, 5.0, 40, 12);
    cut(target.torque_Nm, -scale.torque_Nm, scale.torque_Nm, 52, 12);
  }));
}

TEST(DamiaoFrames, NumbersBeyondTheScaleAreSentAsItsEnds) {
  const Scale scale = scale_of(Model::dm4310);
  const CanFrame high = mit_frame(1, scale, {1e9, 1e9, 1e9, 1e9, 1e9});
  EXPECT_EQ(high.data, (Data{255, 255, 255, 255, 255, 255, 255, 255}));
  const CanFrame low = mit_frame(1, scale, {-1e9, -1e9, -1e9, -1e9, -1e9});
  EXPECT_EQ(low.data, Data{});
}

TEST(DamiaoFrames, EachNumberOfFeedbackIsReadFromItsBits) {
  EXPECT_TRUE(rc::check([] {
    const auto data = *rc::gen::arbitrary<Data>();
    const Scale scale = any_scale();
    const auto told = feedback_of({0x15, 8, data}, scale);
    RC_ASSERT(told.has_value());
    const auto agrees = [&data](double value, double end, int first, int count) {
      const double step = 2.0 * end / (std::pow(2.0, count) - 1.0);
      RC_ASSERT(std::fabs(value - (step * bits_of(data, first, count) - end)) < 1e-9 * end);
    };
    RC_ASSERT(told->status == bits_of(data, 0, 4));
    RC_ASSERT(told->motor == bits_of(data, 4, 4));
    agrees(told->position_rad, scale.position_rad, 8, 16);
    agrees(told->velocity_rad_per_s, scale.velocity_rad_per_s, 24, 12);
    agrees(told->torque_Nm, scale.torque_Nm, 36, 12);
    RC_ASSERT(told->drive_C == data[6]);
    RC_ASSERT(told->winding_C == data[7]);
  }));
}

TEST(DamiaoFrames, EveryStatusHasAMeaning) {
  constexpr MotorFault unknown = MotorFault::unknown_status;
  const std::array<MotorFault, 16> expected{MotorFault::none,
                                            MotorFault::none,
                                            unknown,
                                            unknown,
                                            unknown,
                                            unknown,
                                            unknown,
                                            unknown,
                                            MotorFault::voltage,
                                            MotorFault::voltage,
                                            MotorFault::current,
                                            MotorFault::hot,
                                            MotorFault::hot,
                                            MotorFault::lost_master,
                                            MotorFault::overload,
                                            unknown};
  for (std::uint8_t status = 0; status < 16; ++status) EXPECT_EQ(fault_of(status), expected[status]) << int{status};
  // What the protocol does not have counts as power.
  for (std::uint8_t status = 0; status < 16; ++status) {
    EXPECT_EQ(means_off(status), status != status_enabled && expected[status] != unknown) << int{status};
  }
  EXPECT_EQ(status_text(0x7), "status 0x7 (unknown)");
  EXPECT_EQ(status_text(0x1), "status 0x1 (enabled)");
  EXPECT_EQ(status_text(0xd), "status 0xd (communication lost)");
  EXPECT_EQ(status_text(no_status), "no status");
}

TEST(DamiaoFrames, ARegisterAnswerIsUnderstoodAndFeedbackOfAMotorThatRestsIsNone) {
  const auto answer = register_answer_of({0x11, 8, {1, 0, 0x33, 21, 0, 0, 0x48, 0x41}});
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->motor, 1U);
  EXPECT_FALSE(answer->written);
  EXPECT_EQ(answer->which, 21);
  EXPECT_EQ(std::bit_cast<float>(answer->value), 12.5F);
  const auto written = register_answer_of({0x11, 8, {1, 0, 0x55, 9, 0xe8, 3, 0, 0}});
  ASSERT_TRUE(written);
  EXPECT_TRUE(written->written);
  EXPECT_EQ(written->value, 1000U);
  EXPECT_TRUE(rc::check([] {
    // At rest the code of velocity is 7ff or 800, so no register has the number that its upper byte would be.
    auto data = *rc::gen::arbitrary<Data>();
    const bool above = *rc::gen::arbitrary<bool>();
    data[3] = above ? 0x80 : 0x7f;
    RC_ASSERT(!register_answer_of({0x11, 8, data}));
  }));
}

}  // namespace
}  // namespace tactus::devices::damiao
