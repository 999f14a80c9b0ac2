// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>
#include <tactus/hardware/wire/join.hpp>

#include <cstring>
#include <string>

#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <rapidcheck.h>
#include <tests/wire/scripted_end.hpp>

namespace tactus::emulation::damiao {
namespace peer_test {

using wire::testing::Bytes;
using wire::testing::ScriptedEnd;
constexpr std::int64_t us = 1'000, ms = 1'000'000;

Bytes text(const std::string& line) { return {line.begin(), line.end()}; }

Bytes structure(std::uint32_t id, const std::array<std::uint8_t, 8>& data) {
  can_frame frame{};
  frame.can_id = id;
  frame.len = 8;
  std::memcpy(frame.data, data.data(), 8);
  Bytes bytes(sizeof(frame));
  std::memcpy(bytes.data(), &frame, sizeof(frame));
  return bytes;
}
Bytes refresh(std::uint8_t id) { return structure(0x7ff, {id, 0, 0xcc}); }

std::unique_ptr<DamiaoPeer> peer_with(AdapterType adapter, std::vector<Fault> faults = {}, std::uint64_t seed = 1) {
  PeerSettings settings{.adapter = adapter, .motors = {}, .faults = std::move(faults), .seed = seed};
  for (std::uint32_t id = 1; id <= 3; ++id) settings.motors.push_back({.id = id, .feedback_id = id + 0x10});
  auto peer = DamiaoPeer::make(settings);
  EXPECT_TRUE(peer.ok());
  return *std::move(peer);
}

/// What comes back within 20 ms from what is said at this time.
std::vector<ScriptedEnd::Heard> answers(DamiaoPeer& peer, const std::vector<Bytes>& said, std::int64_t at_ns = 0) {
  ScriptedEnd driver;
  for (const Bytes& bytes : said) driver.script.emplace_back(at_ns, bytes);
  wire::join(driver, peer, at_ns, at_ns + 20 * ms);
  return driver.heard;
}

TEST(DamiaoPeer, EachAdapterAnswersInItsOwnBytes) {
  const Bytes dongle{0x55, 0xaa, 0x1e, 0x03, 0x01, 0x00, 0x00, 0x00, 0x0a, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00,
                     0x00, 0x00, 0x00, 0x08, 0x00, 0x00, 0x7f, 0xff, 0x7f, 0xf0, 0x00, 0x00, 0x07, 0xff, 0x00};
  const auto by_dongle = answers(*peer_with(AdapterType::usb2can), {dongle});
  ASSERT_EQ(by_dongle.size(), 1U);
  EXPECT_EQ(by_dongle[0].bytes, (Bytes{0xaa, 0x11, 0x08, 0x11, 0, 0, 0, 0x01, 0x80, 0, 0x80, 0x08, 0, 30, 28, 0x55}));
  const auto by_text = answers(*peer_with(AdapterType::slcan), {text("S8\rO\rt00187FFF7FF0000007FF\r")});
  ASSERT_EQ(by_text.size(), 1U);
  EXPECT_EQ(by_text[0].bytes, text("t0118018000800800"
                                   "1E1C\r"));
  const auto by_linux = answers(*peer_with(AdapterType::socketcan), {refresh(2)});
  ASSERT_EQ(by_linux.size(), 1U);
  EXPECT_EQ(by_linux[0].bytes, structure(0x12, {0x02, 0x80, 0, 0x80, 0x08, 0, 30, 28}));
}

TEST(DamiaoPeer, AnSlcanAdapterThatIsClosedPassesNothing) {
  EXPECT_TRUE(answers(*peer_with(AdapterType::slcan), {text("t00187FFF7FF0000007FF\r")}).empty());
  EXPECT_TRUE(answers(*peer_with(AdapterType::slcan), {text("O\rC\rt00187FFF7FF0000007FF\r")}).empty());
}

TEST(DamiaoPeer, BytesMayBeCutAnywhereAndGarbageMayStandBefore) {
  const Bytes line = text("O\rt00187FFF7FF0000007FF\r");
  const Bytes dongle{0x55, 0xaa, 0x1e, 0x03, 0x01, 0x00, 0x00, 0x00, 0x0a, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00,
                     0x00, 0x00, 0x00, 0x08, 0x00, 0x00, 0x7f, 0xff, 0x7f, 0xf0, 0x00, 0x00, 0x07, 0xff, 0x00};
  for (std::size_t cut = 0; cut < 30; ++cut) {
    const auto at = static_cast<std::ptrdiff_t>(cut);
    EXPECT_EQ(answers(*peer_with(AdapterType::usb2can), {{0x55, 0x55, 0xaa, 7},
                                                         Bytes(dongle.begin(), dongle.begin() + at),
                                                         Bytes(dongle.begin() + at, dongle.end())})
                  .size(),
              1U);
    if (cut > line.size()) continue;
    EXPECT_EQ(answers(*peer_with(AdapterType::slcan),
                      {text("t7\r"), Bytes(line.begin(), line.begin() + at), Bytes(line.begin() + at, line.end())})
                  .size(),
              1U);
  }
}

TEST(DamiaoPeer, AFrameTakesItsBitsOnTheBus) {
  EXPECT_TRUE(rc::check([] {
    const Frame frame{.id = *rc::gen::inRange(0U, 0x800U), .bytes = *rc::gen::arbitrary<std::array<std::uint8_t, 8>>()};
    const std::int64_t bits = frame_ns(frame, false) / us;
    RC_ASSERT(bits >= 111 && bits <= 135);
  }));
  // Nothing to stuff but in what stands around the data, and as much as can be.
  EXPECT_LE(frame_ns({0x555, {0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55}}, false), 114 * us);
  EXPECT_GE(frame_ns({0, {}}, false), 126 * us);
  EXPECT_EQ(frame_ns({}, true), 66 * us);
}

TEST(DamiaoPeer, ASingleAnswerTakesTwoFramesAndTheMotorsDelay) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto heard = answers(*peer_with(AdapterType::socketcan, {}, seed), {refresh(1)});
    ASSERT_EQ(heard.size(), 1U);
    EXPECT_GE(heard[0].at_ns, (2 * 111 + 60) * us);
    EXPECT_LE(heard[0].at_ns, (2 * 135 + 250) * us);
  }
}

TEST(DamiaoPeer, TheBusIsNeverIdleWhileFramesWaitAndTheLowestIdentifierGoesFirst) {
  const auto heard = answers(*peer_with(AdapterType::socketcan), {refresh(3), refresh(2), refresh(1)});
  ASSERT_EQ(heard.size(), 3U);
  // Three questions of at most 135 µs, the last motor's delay, then no gap longer than a frame between answers.
  EXPECT_LE(heard[2].at_ns, (6 * 135 + 250) * us);
  for (std::size_t i = 1; i < 3; ++i) EXPECT_GE(heard[i].at_ns - heard[i - 1].at_ns, 111 * us);
}

TEST(DamiaoPeer, TheSameSeedAnswersAlikeHoweverLateItIsCalled) {
  const auto run = [](std::int64_t step_ns) {
    auto peer = peer_with(AdapterType::usb2can, {{.kind = FaultKind::garbage}, {.kind = FaultKind::split}}, 7);
    Bytes all;
    const Bytes ask{0x55, 0xaa, 0x1e, 3, 1, 0, 0, 0, 10,   0, 0, 0, 0, 0xff, 7,
                    0,    0,    0,    8, 0, 0, 2, 0, 0xcc, 0, 0, 0, 0, 0,    0};
    for (std::int64_t at_ns = 0; at_ns < 110 * ms; at_ns += step_ns) {
      if (at_ns % ms == 0 && at_ns < 100 * ms) peer->hear(ask, at_ns);
      for (auto said = peer->say(at_ns); !said.empty(); said = peer->say(at_ns))
        all.insert(all.end(), said.begin(), said.end());
    }
    return all;
  };
  const Bytes often = run(10 * us);
  EXPECT_GT(often.size(), 100U * 16U);
  EXPECT_EQ(run(ms), often);
}

TEST(DamiaoPeer, FaultsBeginAndEndWhenTheyShould) {
  const auto at = [](FaultKind kind) {
    return Fault{.kind = kind, .motor = 2, .from_ns = 5 * ms, .until_ns = 10 * ms};
  };
  auto peer = peer_with(AdapterType::socketcan, {at(FaultKind::silence), at(FaultKind::hot_drive)});
  ScriptedEnd driver;
  for (const std::int64_t at_ns : {1 * ms, 6 * ms, 11 * ms}) {
    driver.script.emplace_back(at_ns, refresh(2));
    driver.script.emplace_back(at_ns, refresh(3));
  }
  wire::join(driver, *peer, 0, 20 * ms);
  ASSERT_EQ(driver.heard.size(), 5U);
  const auto first_byte = [&driver](std::size_t i) { return driver.heard[i].bytes[8]; };
  EXPECT_EQ(first_byte(0) & 0xf0, 0x00);
  EXPECT_EQ(first_byte(2), 0x03);
  // It recovered, and nobody cleared it.
  EXPECT_EQ(std::max(first_byte(3), first_byte(4)), 0xb2);
}

TEST(DamiaoPeer, BusOffIsToldAndNothingPasses) {
  const auto heard = answers(*peer_with(AdapterType::socketcan, {{.kind = FaultKind::bus_off}}), {refresh(1)});
  ASSERT_EQ(heard.size(), 1U);
  can_frame frame{};
  std::memcpy(&frame, heard[0].bytes.data(), sizeof(frame));
  EXPECT_EQ(frame.can_id, CAN_ERR_FLAG | CAN_ERR_BUSOFF);
}

TEST(DamiaoPeer, AnotherVelocityScaleIsInTheRegisterAndInTheFrames) {
  auto peer = peer_with(AdapterType::socketcan, {{.kind = FaultKind::wrong_scale, .motor = 1}});
  const auto heard = answers(*peer, {structure(0x7ff, {1, 0, 0x33, 22}), structure(0x7ff, {2, 0, 0x33, 22})});
  ASSERT_EQ(heard.size(), 2U);
  EXPECT_EQ(heard[0].bytes, structure(0x11, {1, 0, 0x33, 22, 0x00, 0x00, 0x34, 0x42}));  // 45.0F
  EXPECT_EQ(heard[1].bytes, structure(0x12, {2, 0, 0x33, 22, 0x00, 0x00, 0xf0, 0x41}));  // 30.0F
}

TEST(DamiaoPeer, AFaultThatIsInjectedCountsFromThenOn) {
  auto peer = peer_with(AdapterType::socketcan, {});
  const auto status = [&peer](std::int64_t now_ns) {
    const auto heard = answers(*peer, {refresh(2)}, now_ns);
    if (heard.empty()) return -1;
    can_frame frame{};
    std::memcpy(&frame, heard[0].bytes.data(), sizeof(frame));
    return frame.data[0] >> 4;
  };
  peer->advance(3'000 * ms);
  EXPECT_EQ(status(3'000 * ms), 0);
  ASSERT_FALSE(peer->inject(
      {.kind = FaultKind::status, .motor = 2, .from_ns = 20 * ms, .until_ns = 40 * ms, .status = 7}, 3'020 * ms));
  EXPECT_EQ(status(3'020 * ms), 0);
  EXPECT_EQ(status(3'040 * ms), 7);
  EXPECT_EQ(status(3'060 * ms), 0);
  for (const FaultKind kind : {FaultKind::wrong_scale, FaultKind::wrap, FaultKind::heartbeat}) {
    const Check refused = peer->inject({.kind = kind}, 3'080 * ms);
    ASSERT_TRUE(refused) << name_of(kind);
    EXPECT_NE(refused->message.find("start them with it"), std::string::npos);
  }
}

TEST(DamiaoPeer, AFaultIsReadFromAWord) {
  const auto silence = parse_fault("silence:2@5+0.1");
  ASSERT_TRUE(silence) << describe(silence.error());
  EXPECT_EQ(silence->kind, FaultKind::silence);
  EXPECT_EQ(silence->motor, 2U);
  EXPECT_EQ(silence->from_ns, 5'000 * ms);
  EXPECT_EQ(silence->until_ns, 5'100 * ms);
  const auto all = parse_fault("hot-winding");
  ASSERT_TRUE(all);
  EXPECT_EQ(all->motor, 0U);
  EXPECT_EQ(all->until_ns, wire::never_ns);
  const auto status = parse_fault("status=0xe:2@5");
  ASSERT_TRUE(status) << describe(status.error());
  EXPECT_EQ(status->kind, FaultKind::status);
  EXPECT_EQ(status->status, 0xe);
  EXPECT_EQ(status->motor, 2U);
  EXPECT_EQ(parse_fault("status=7")->status, 7);
  EXPECT_EQ(parse_fault("ignores-disable:1")->kind, FaultKind::ignores_disable);
  for (const char* wrong : {"", "silent", "silence:", "silence:x", "silence:16", "silence@-1", "silence@1e9",
                            "silence+x", "status", "status=", "status=0x10", "status=x", "silence=1"}) {
    const auto fault = parse_fault(wrong);
    ASSERT_FALSE(fault) << wrong;
    EXPECT_NE(fault.error().message.find("KIND[:MOTOR][@SECONDS][+SECONDS]"), std::string::npos);
  }
}

}  // namespace peer_test
}  // namespace tactus::emulation::damiao
