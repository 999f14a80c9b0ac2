// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/handshake_frame.hpp>
#include <tactus/runtime/link/internal/handshake_inbox.hpp>

#include <array>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>
#include <tests/link/handshake_attack.hpp>
#include <tests/link/pair.hpp>

namespace tactus::link {
namespace handshake_test {

using testing::HandshakeAttack;
using Kind = HandshakeAttack::Kind;
using Verdict = FrameTags::Verdict;

FrameTags tags_of(SiteRole site, unsigned char key = 1) {
  return FrameTags::make(testing::test_key(key), site).value();
}

class Attacked : public ::testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(Handshake, Attacked,
                         ::testing::Values(Kind::alert, Kind::junk_records, Kind::replayed, Kind::reflected,
                                           Kind::damaged, Kind::messages, Kind::noise, Kind::all),
                         [](const auto& kind) { return "kind" + std::to_string(static_cast<int>(kind.param)); });

TEST_P(Attacked, HandsAreShakenUnderTenThousandForgedPacketsASecondToBothSites) {
  HandshakeAttack attack(7);
  ASSERT_TRUE(attack.shake_hands({.kind = GetParam(), .per_second = 0.0}, 10.0)) << "to have something recorded";
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(attack.shake_hands({.kind = GetParam()}, 10.0))
        << HandshakeAttack::names[static_cast<std::size_t>(GetParam())];
  }
}

const std::vector<std::byte> records(200, std::byte{22});

TEST(HandshakeFrame, IsReadAsItWasWrittenByTheOtherSiteAlone) {
  FrameTags master = tags_of(SiteRole::master), slave = tags_of(SiteRole::slave),
            stranger = tags_of(SiteRole::slave, 2);
  FrameBytes bytes;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1}, records.size()}) {
    const auto written =
        master.write({.session = 5, .peer = 6, .number = 7, .records = std::span(records).first(size)}, bytes);
    EXPECT_EQ(written.size(), shortest_frame_bytes + size);
    HandshakeFrame read;
    ASSERT_EQ(slave.read(written, read), Verdict::genuine);
    EXPECT_EQ(read.session, 5U);
    EXPECT_EQ(read.peer, 6U);
    EXPECT_EQ(read.number, 7U);
    EXPECT_EQ(read.records.size(), size);
    EXPECT_EQ(master.read(written, read), Verdict::none) << "its own that comes back";
    EXPECT_EQ(stranger.read(written, read), Verdict::forged);
  }
}

TEST(HandshakeFrame, WithAnyBitChangedIsNone) {
  FrameTags master = tags_of(SiteRole::master), slave = tags_of(SiteRole::slave);
  FrameBytes bytes;
  const auto written = master.write({.session = 5, .peer = 6, .number = 7, .records = records}, bytes);
  std::vector<std::byte> changed(written.begin(), written.end());
  HandshakeFrame read;
  for (std::size_t bit = 0; bit < 8 * changed.size(); ++bit) {
    changed[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
    const Verdict verdict = slave.read(changed, read);
    EXPECT_TRUE(verdict == Verdict::none || verdict == Verdict::forged) << bit;
    changed[bit / 8] ^= static_cast<std::byte>(1U << (bit % 8));
  }
  for (std::size_t size = 0; size < changed.size(); ++size) {
    EXPECT_NE(slave.read(std::span(changed).first(size), read), Verdict::genuine);
  }
  EXPECT_EQ(slave.read(changed, read), Verdict::genuine);
}

TEST(HandshakeFrame, IsJudgedWithoutAllocating) {
  FrameTags master = tags_of(SiteRole::master), slave = tags_of(SiteRole::slave);
  FrameBytes bytes;
  const std::uint64_t before = laws::own_allocation_count();
  const auto written = master.write({.session = 5, .peer = 6, .number = 7, .records = records}, bytes);
  HandshakeFrame read;
  EXPECT_EQ(slave.read(written, read), Verdict::genuine);
  bytes[60] ^= std::byte{1};
  EXPECT_EQ(slave.read(written, read), Verdict::forged);
  EXPECT_EQ(laws::own_allocation_count(), before);
}

TEST(HandshakeFrame, OfAnotherVersionIsKnownByItsVersionAlone) {
  FrameTags master = tags_of(SiteRole::master), slave = tags_of(SiteRole::slave);
  FrameBytes bytes;
  const auto written = master.write({.session = 5, .peer = 6, .number = 7, .version = datagram_version + 1}, bytes);
  HandshakeFrame read;
  EXPECT_EQ(slave.read(written, read), Verdict::version);
  EXPECT_EQ(read.version, datagram_version + 1);
  EXPECT_EQ(read.session, 0U);
}

TEST(HandshakeInbox, RecordedBeginningsTakeNoRoomFromTheHandshakeUnderWay) {
  HandshakeInbox inbox(SiteRole::slave);
  inbox.expect(8, 9);
  for (std::uint64_t i = 0; i < 10'000; ++i) inbox.take({.session = 5, .peer = i % 2 == 0 ? 0U : 8U, .number = i});
  EXPECT_EQ(inbox.take({.session = 9, .peer = 8, .number = 20, .records = records}),
            HandshakeInbox::Verdict::passed_on);
  HandshakeLetter letter;
  ASSERT_TRUE(inbox.next_under_way(letter));
  EXPECT_EQ(letter.session, 9U);
  EXPECT_EQ(letter.number, 20U);
  EXPECT_EQ(letter.records().size(), records.size());
}

TEST(HandshakeInbox, OfTheHandshakeUnderWayEachFrameComesInOnce) {
  HandshakeInbox inbox(SiteRole::slave);
  inbox.expect(8, 9);
  const auto take = [&inbox](std::uint64_t number) { return inbox.take({.session = 9, .peer = 8, .number = number}); };
  EXPECT_EQ(take(20), HandshakeInbox::Verdict::passed_on);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(take(20), HandshakeInbox::Verdict::refused);
  EXPECT_EQ(take(22), HandshakeInbox::Verdict::passed_on);
  EXPECT_EQ(take(21), HandshakeInbox::Verdict::passed_on) << "late";
  EXPECT_EQ(take(21), HandshakeInbox::Verdict::refused);
  HandshakeLetter letter;
  EXPECT_FALSE(inbox.next_beginning(letter));
}

TEST(HandshakeInbox, AClientTakesOnlyWhatAnswersIt) {
  HandshakeInbox inbox(SiteRole::master);
  EXPECT_EQ(inbox.take({.session = 9, .peer = 0, .number = 1}), HandshakeInbox::Verdict::refused)
      << "it shakes no hands";
  inbox.expect(8, 0);
  EXPECT_EQ(inbox.take({.session = 9, .peer = 7, .number = 1}), HandshakeInbox::Verdict::refused);
  EXPECT_EQ(inbox.take({.session = 9, .peer = 8, .number = 2}), HandshakeInbox::Verdict::passed_on);
}

}  // namespace handshake_test
}  // namespace tactus::link
