#include <tactus/link/datagram.hpp>

#include <bit>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <tests/link/any_datagram.hpp>

namespace tactus::link {
namespace {

using testing::alike;
using testing::any_datagram;

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

}  // namespace
}  // namespace tactus::link
