// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/datagram.hpp>
#include <tactus/runtime/link/inbound.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tests/link/any_datagram.hpp>

namespace tactus::link {
namespace {

using testing::alike;
using testing::any_datagram;
using testing::any_joint_datagram;
using testing::room_for;

TEST(Datagram, EveryDatagramIsReadAsItWasWritten) {
  EXPECT_TRUE(rc::check([] {
    const Datagram written = *any_datagram();
    Datagram read;
    RC_ASSERT(decode(encode(written), read) == Refusal::none);
    RC_ASSERT(alike(read, written));
  }));
}

TEST(Datagram, TheBytesAreThoseOfTheReferencePage) {
  const DatagramBytes bytes = encode(
      {.site = SiteRole::slave,
       .packet = {.session = 0x1817161514131211,
                  .sequence = 0x3837363534333231,
                  .state = control::SiteState::hold,
                  .armings = 0x0807060504030201,
                  .message = {.position_m = 1.0, .force_N = -2.0},
                  .agreement = {.digest = 0x7877767574737271, .cell = 0x8887868584838281, .value = 0x9897969594939291}},
       .peer_session = 0x2827262524232221,
       .sent_ns = 0x4847464544434241,
       .echo_sent_ns = 0x5857565554535251,
       .echo_hold_ns = 0x6867666564636261});
  std::vector<unsigned> expected{'T', 'C', 'T', '1', 3, 0, 2, 4, 1, 2, 3, 4, 5, 6, 7, 8};
  for (unsigned high = 0x10; high <= 0x60; high += 0x10) {
    for (unsigned low = 1; low <= 8; ++low) expected.push_back(high + low);
  }
  expected.resize(104, 0);
  expected[64 + 6] = 0xf0;  // 1.0 is 0x3ff0000000000000
  expected[64 + 7] = 0x3f;
  expected[80 + 7] = 0xc0;  // -2.0 is 0xc000000000000000
  for (unsigned high = 0x70; high <= 0x90; high += 0x10) {
    for (unsigned low = 1; low <= 8; ++low) expected.push_back(high + low);
  }
  ASSERT_EQ(bytes.size(), expected.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    EXPECT_EQ(std::to_integer<unsigned>(bytes[i]), expected[i]) << "at byte " << i;
  }
}

TEST(Datagram, EveryOtherSizeIsRefused) {
  const DatagramBytes bytes = encode(testing::ordinary());
  std::vector<std::byte> longer(bytes.begin(), bytes.end());
  longer.resize(2000);
  for (std::size_t size = 0; size < longer.size(); ++size) {
    Datagram read;
    EXPECT_EQ(decode({longer.data(), size}, read), size == datagram_bytes ? Refusal::none : Refusal::size) << size;
  }
}

TEST(Datagram, OneOfAnotherVersionIsKnownByItWhateverItsSize) {
  const DatagramBytes bytes = encode(testing::ordinary());
  std::vector<std::byte> other(bytes.begin(), bytes.end());
  other[4] = std::byte{2};
  for (const std::size_t size : {std::size_t{6}, std::size_t{104}, datagram_bytes, std::size_t{1500}}) {
    other.resize(size);
    Datagram read;
    EXPECT_EQ(decode(other, read), Refusal::version) << size;
    EXPECT_EQ(version_of(other), 2) << size;
  }
}

TEST(Datagram, EachWrongFieldIsRefusedByItsName) {
  const auto refusal_with = [](std::size_t at, std::byte value) {
    DatagramBytes bytes = encode(testing::ordinary());
    bytes[at] = value;
    Datagram read;
    return decode(bytes, read);
  };
  EXPECT_EQ(refusal_with(0, std::byte{'t'}), Refusal::magic);
  EXPECT_EQ(refusal_with(4, std::byte{1}), Refusal::version);
  EXPECT_EQ(refusal_with(6, std::byte{0}), Refusal::site);
  EXPECT_EQ(refusal_with(6, std::byte{3}), Refusal::site);
  EXPECT_EQ(refusal_with(7, std::byte{6}), Refusal::state);
  EXPECT_EQ(refusal_with(40 + 7, std::byte{0x80}), Refusal::time);
  EXPECT_EQ(refusal_with(48 + 7, std::byte{0x80}), Refusal::time);
  EXPECT_EQ(refusal_with(56 + 7, std::byte{0xff}), Refusal::time);

  const auto refusal_of = [](auto&& change) {
    Datagram datagram = testing::ordinary();
    change(datagram);
    Datagram read;
    return decode(encode(datagram), read);
  };
  EXPECT_EQ(refusal_of([](Datagram& d) { d.packet.session = 0; }), Refusal::session);
  EXPECT_EQ(refusal_of([](Datagram& d) { d.packet.sequence = 0; }), Refusal::session);
  EXPECT_EQ(refusal_of([](Datagram& d) { d.packet.sequence = -1; }), Refusal::session);
}

TEST(Datagram, ARefusedDatagramLeavesTheOldOneUntouched) {
  EXPECT_TRUE(rc::check([] {
    const auto bytes = *rc::gen::container<std::vector<std::uint8_t>>(rc::gen::arbitrary<std::uint8_t>());
    Datagram read = testing::ordinary();
    RC_ASSERT(decode(std::as_bytes(std::span(bytes)), read) != Refusal::none);
    RC_ASSERT(alike(read, testing::ordinary()));
  }));
}

TEST(Datagram, WhatIsReadFromDamagedBytesIsWrittenBackAsThoseBytes) {
  EXPECT_TRUE(rc::check([] {
    DatagramBytes bytes = encode(*any_datagram());
    const auto flips =
        *rc::gen::container<std::vector<std::size_t>>(rc::gen::inRange<std::size_t>(0, 8 * bytes.size()));
    for (const std::size_t bit : flips) bytes[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    Datagram read;
    if (decode(bytes, read) != Refusal::none) return;
    RC_ASSERT(encode(read) == bytes);
  }));
}

TEST(JointDatagram, IsReadAsItWasWrittenByOneOfAsManyJointsAlone) {
  EXPECT_TRUE(rc::check([] {
    const auto joints = *rc::gen::inRange<std::size_t>(1, most_joints + 1);
    const JointDatagram written = *any_joint_datagram(joints);
    const JointDatagramBytes bytes = encode(written);
    RC_ASSERT(bytes.size == datagram_bytes_of(joints));
    for (std::size_t other = 1; other <= most_joints; ++other) {
      JointDatagram read = room_for(other);
      const Refusal refusal = decode(bytes.bytes(), read);
      if (other != joints) {
        RC_ASSERT(refusal == Refusal::joints);
        RC_ASSERT(joints_in(bytes.bytes()) == joints);
        RC_ASSERT(read.packet.session == 0);  // untouched
        continue;
      }
      RC_ASSERT(refusal == Refusal::none);
      RC_ASSERT(read.packet.message.size() == joints);
      for (std::size_t i = 0; i < joints; ++i)
        RC_ASSERT(alike(testing::joint_of(read, i), testing::joint_of(written, i)));
    }
  }));
}

TEST(JointDatagram, OfOneJointHasTheBytesOfOneAxis) {
  EXPECT_TRUE(rc::check([] {
    const JointDatagram written = *any_joint_datagram(1);
    const JointDatagramBytes bytes = encode(written);
    const DatagramBytes of_axis = encode(testing::joint_of(written, 0));
    RC_ASSERT(std::ranges::equal(bytes.bytes(), of_axis));
  }));
}

TEST(JointDatagram, TheBytesAreThoseOfTheReferencePage) {
  JointDatagram datagram = room_for(2);
  datagram.packet.session = 1;
  datagram.packet.sequence = 2;
  datagram.packet.message[0].position_m = 1.0;
  datagram.packet.message[1].energy_J = -2.0;
  datagram.packet.agreement.digest = 0x7877767574737271;
  const JointDatagramBytes bytes = encode(datagram);
  ASSERT_EQ(bytes.size, 168U);
  const auto at = [&bytes](std::size_t place) { return std::to_integer<unsigned>(bytes.data[place]); };
  EXPECT_EQ(at(0), 'T');
  EXPECT_EQ(at(3), '2');
  EXPECT_EQ(at(4), 3U);
  EXPECT_EQ(at(64 + 7), 0x3fU);            // position of joint 1
  EXPECT_EQ(at(64 + 40 + 32 + 7), 0xc0U);  // energy of joint 2
  EXPECT_EQ(at(64 + 80), 0x71U);           // digest
  // The largest, in a record of DTLS and a packet of IPv6, is below the 1280 bytes that every network of IPv6 carries.
  EXPECT_EQ(longest_datagram_bytes, 408U);
  EXPECT_LE(longest_datagram_bytes + 29 + 48, 1280U);
}

TEST(JointDatagram, OfNoOrTooManyJointsAndOfEveryOtherSizeIsRefused) {
  for (std::size_t joints = 1; joints <= most_joints; ++joints) {
    JointDatagram whole = room_for(joints);
    whole.packet.session = whole.packet.sequence = 1;
    const JointDatagramBytes encoded = encode(whole);
    std::vector<std::byte> bytes(encoded.bytes().begin(), encoded.bytes().end());
    bytes.resize(1500);
    JointDatagram read = room_for(joints);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      EXPECT_EQ(decode({bytes.data(), size}, read), size == encoded.size ? Refusal::none : Refusal::size) << size;
    }
    for (const char digit : {'0', '9', '/', '\0', '\xff'}) {
      bytes[3] = static_cast<std::byte>(digit);
      for (std::size_t size = 6; size < bytes.size(); ++size) {
        EXPECT_EQ(decode({bytes.data(), size}, read), Refusal::magic) << digit;
      }
    }
  }
}

TEST(JointDatagram, WhatIsReadFromDamagedBytesIsWrittenBackAsThoseBytes) {
  EXPECT_TRUE(rc::check([] {
    const auto joints = *rc::gen::inRange<std::size_t>(1, most_joints + 1);
    JointDatagramBytes bytes = encode(*any_joint_datagram(joints));
    const auto flips = *rc::gen::container<std::vector<std::size_t>>(rc::gen::inRange<std::size_t>(0, 8 * bytes.size));
    for (const std::size_t bit : flips) bytes.data[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    JointDatagram read = room_for(joints);
    if (decode(bytes.bytes(), read) != Refusal::none) return;
    RC_ASSERT(std::ranges::equal(encode(read).bytes(), bytes.bytes()));
  }));
}

/// Bytes of other sizes, of none, nine and other joints, cut short, damaged, and with numbers that are none: nothing of
/// it is applied, and the genuine ones between are.
TEST(JointDatagram, AFloodOfHostileOnesIsNeitherAppliedNorInTheWayOfGenuineOnes) {
  constexpr std::int64_t own_session = 5, session = 7;
  constexpr std::size_t joints = 7;
  constexpr int packets = 100'000;
  using Judge = control::PacketJudgeOf<Joints<control::Message>>;
  auto judge = Judge::make(Joints<control::PacketJudgeParams>(joints), Seconds{1e-3}).value();
  Inbound inbound(SiteRole::master, own_session);
  std::mt19937 random(3);
  const auto any = [&random](std::size_t below) { return random() % below; };
  JointDatagram genuine = room_for(joints);
  genuine.site = SiteRole::slave;
  genuine.packet.session = session;
  genuine.peer_session = own_session;
  genuine.sent_ns = genuine.echo_sent_ns = 1000;
  std::int64_t now_ns = 2000;
  int applied = 0, hostile_applied = 0;
  for (int i = 1; i <= packets; ++i) {
    now_ns += 1000;
    genuine.packet.sequence = i;
    genuine.sent_ns += 1000;
    genuine.echo_sent_ns += 1000;
    JointDatagram sent = genuine;
    const std::size_t kind = any(6);
    const double none[]{std::nan(""), HUGE_VAL, -HUGE_VAL};
    if (kind == 0) {
      const std::size_t member = any(5);
      std::size_t at = 0;
      for_each_signal<control::Message>([&](const auto& each) {
        if (at++ == member) sent.packet.message[any(joints)].*each.member = none[any(3)];
      });
    }
    const JointDatagramBytes encoded = encode(sent);
    std::vector<std::byte> bytes(encoded.bytes().begin(), encoded.bytes().end());
    if (kind == 1) bytes.resize(any(bytes.size()));
    if (kind == 2) bytes.resize(bytes.size() + 1 + any(1000));
    if (kind == 3) bytes[3] = static_cast<std::byte>('0' + (any(2) == 0 ? 0 : 9));
    if (kind == 4) bytes[3] = static_cast<std::byte>('1' + any(joints - 1));
    JointDatagram read = room_for(joints);
    if (decode(bytes, read) != Refusal::none) {
      ASSERT_TRUE(kind >= 1 && kind <= 4) << kind;
      continue;
    }
    ASSERT_TRUE(kind == 0 || kind == 5) << kind;
    ASSERT_EQ(inbound.take(read, now_ns), Inbound::Verdict::counted);
    if (judge.step(read.packet) != control::PacketVerdict::applied) continue;
    kind == 5 ? ++applied : ++hostile_applied;
  }
  EXPECT_EQ(hostile_applied, 0);
  EXPECT_GT(applied, packets / 7);
}

}  // namespace
}  // namespace tactus::link
