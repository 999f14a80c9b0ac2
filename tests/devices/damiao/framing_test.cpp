// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/damiao/framing.hpp>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <linux/can.h>
#include <rapidcheck.h>

namespace tactus::devices::damiao {
namespace framing_test {

using Bytes = std::vector<std::uint8_t>;

Bytes bytes_of(const Wrapped& wrapped) { return {wrapped.view().begin(), wrapped.view().end()}; }
Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

std::vector<CanFrame> frames_in(FrameReader& reader, const Bytes& bytes) {
  std::vector<CanFrame> found;
  reader.take(bytes, [&found](const CanFrame& frame) { found.push_back(frame); });
  return found;
}
std::vector<CanFrame> frames_in(Framing framing, const Bytes& bytes) {
  FrameReader reader(framing);
  return frames_in(reader, bytes);
}

/// What the adapter makes of a frame from the bus, as the page says.
Bytes received(Framing framing, const CanFrame& frame) {
  if (framing != Framing::usb2can) return bytes_of(wrap(framing, frame));
  Bytes bytes{
      0xaa, 0x11, frame.size, static_cast<std::uint8_t>(frame.id & 0xff), static_cast<std::uint8_t>(frame.id >> 8),
      0,    0};
  bytes.insert(bytes.end(), frame.data.begin(), frame.data.end());
  bytes.push_back(0x55);
  return bytes;
}

CanFrame any_frame() {
  CanFrame frame;
  frame.id = *rc::gen::inRange<std::uint16_t>(0, 0x800);
  frame.data = *rc::gen::arbitrary<std::array<std::uint8_t, 8>>();
  return frame;
}

const CanFrame feedback{0x11, 8, {0x11, 0x8a, 0x3c, 0x7f, 0xf8, 0x66, 0x1e, 0x1c}};
const CanFrame zero{1, 8, {0x7f, 0xff, 0x7f, 0xf0, 0x00, 0x00, 0x07, 0xff}};
constexpr std::array serial_framings{Framing::usb2can, Framing::slcan, Framing::slcan_fd};

TEST(DamiaoFraming, TheVectorsOfTheProtocolPageGoOut) {
  EXPECT_EQ(bytes_of(wrap(Framing::usb2can, zero)),
            (Bytes{0x55, 0xaa, 0x1e, 0x03, 0x01, 0x00, 0x00, 0x00, 0x0a, 0x00, 0x00, 0x00, 0x00, 0x01, 0x00,
                   0x00, 0x00, 0x00, 0x08, 0x00, 0x00, 0x7f, 0xff, 0x7f, 0xf0, 0x00, 0x00, 0x07, 0xff, 0x00}));
  EXPECT_EQ(bytes_of(wrap(Framing::slcan, zero)), bytes_of("t00187FFF7FF0000007FF\r"));
  EXPECT_EQ(bytes_of(wrap(Framing::slcan_fd, zero)), bytes_of("b00187FFF7FF0000007FF\r"));
}

TEST(DamiaoFraming, TheVectorsOfTheProtocolPageComeIn) {
  const Bytes dongle{0xaa, 0x11, 0x08, 0x11, 0x00, 0x00, 0x00, 0x11, 0x8a, 0x3c, 0x7f, 0xf8, 0x66, 0x1e, 0x1c, 0x55};
  EXPECT_EQ(frames_in(Framing::usb2can, dongle), std::vector{feedback});
  for (const char* line : {"t0118118A3C7FF8661E1C\r", "d0118118A3C7FF8661E1C\r", "b0118118a3c7ff8661e1c\r"}) {
    EXPECT_EQ(frames_in(Framing::slcan, bytes_of(line)), std::vector{feedback}) << line;
  }
  EXPECT_TRUE(frames_in(Framing::slcan, bytes_of("t01188118A3C7FF8661E1C\r")).empty());
}

TEST(DamiaoFraming, LinuxStructuresHaveZerosWhereNothingIsWritten) {
  const Wrapped classic = wrap(Framing::socketcan, zero);
  ASSERT_EQ(classic.size, sizeof(can_frame));
  can_frame expected;
  std::memset(&expected, 0, sizeof(expected));
  expected.can_id = 1;
  expected.can_dlc = 8;
  std::copy(zero.data.begin(), zero.data.end(), expected.data);
  EXPECT_EQ(std::memcmp(classic.bytes.data(), &expected, sizeof(expected)), 0);
  const Wrapped flexible = wrap(Framing::socketcan_fd, zero);
  ASSERT_EQ(flexible.size, sizeof(canfd_frame));
  canfd_frame expected_fd;
  std::memset(&expected_fd, 0, sizeof(expected_fd));
  expected_fd.can_id = 1;
  expected_fd.len = 8;
  expected_fd.flags = CANFD_BRS;
  std::copy(zero.data.begin(), zero.data.end(), expected_fd.data);
  EXPECT_EQ(std::memcmp(flexible.bytes.data(), &expected_fd, sizeof(expected_fd)), 0);
}

TEST(DamiaoFraming, AnSlcanAdapterIsClosedThenGivenItsBitRateThenOpened) {
  EXPECT_EQ(bytes_of(opening(Framing::slcan)), bytes_of("C\rS8\rO\r"));
  EXPECT_EQ(bytes_of(opening(Framing::slcan_fd)), bytes_of("C\rS8\rY5\rM0\rO\r"));
  EXPECT_EQ(opening(Framing::usb2can).size, 0U);
}

TEST(DamiaoFraming, EveryFrameComesBackAsItWasCutAtEveryByte) {
  for (const Framing framing : serial_framings) {
    EXPECT_TRUE(rc::check([framing] {
      const std::vector<CanFrame> sent{any_frame(), any_frame(), any_frame()};
      Bytes all;
      for (const CanFrame& frame : sent) {
        const Bytes some = received(framing, frame);
        all.insert(all.end(), some.begin(), some.end());
      }
      for (std::size_t cut = 0; cut <= all.size(); ++cut) {
        FrameReader reader(framing);
        auto found = frames_in(reader, Bytes(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(cut)));
        const auto rest = frames_in(reader, Bytes(all.begin() + static_cast<std::ptrdiff_t>(cut), all.end()));
        found.insert(found.end(), rest.begin(), rest.end());
        RC_ASSERT(found == sent);
      }
    }));
  }
  for (const Framing framing : {Framing::socketcan, Framing::socketcan_fd}) {
    EXPECT_TRUE(rc::check([framing] {
      const CanFrame frame = any_frame();
      RC_ASSERT(frames_in(framing, bytes_of(wrap(framing, frame))) == std::vector{frame});
    }));
  }
}

TEST(DamiaoFraming, AfterAnyGarbageFramesAreFoundAgain) {
  for (const Framing framing : serial_framings) {
    EXPECT_TRUE(rc::check([framing] {
      const auto garbage = *rc::gen::container<Bytes>(
          rc::gen::oneOf(rc::gen::arbitrary<std::uint8_t>(),
                         rc::gen::element<std::uint8_t>(0xaa, 0x11, 0x55, 't', '0', '8', '\r', 7)));
      FrameReader reader(framing);
      frames_in(reader, garbage);
      // What the garbage began can swallow no more than what is as long as a frame.
      frames_in(reader, received(framing, feedback));
      frames_in(reader, received(framing, feedback));
      RC_ASSERT(frames_in(reader, received(framing, feedback)) == std::vector{feedback});
    }));
  }
}

TEST(DamiaoFraming, GarbageWithoutTheFirstByteOfAFrameCostsNoFrame) {
  for (const Framing framing : serial_framings) {
    EXPECT_TRUE(rc::check([framing] {
      auto garbage = *rc::gen::arbitrary<Bytes>();
      std::erase_if(garbage,
                    [](std::uint8_t byte) { return byte == 0xaa || byte == 't' || byte == 'b' || byte == 'd'; });
      FrameReader reader(framing);
      frames_in(reader, garbage);
      const CanFrame frame = any_frame();
      RC_ASSERT(frames_in(reader, received(framing, frame)) == std::vector{frame});
    }));
  }
}

TEST(DamiaoFraming, AFrameWhoseDataLooksLikeAnotherFrameIsOne) {
  const CanFrame looks{0x55, 8, {0x55, 0xaa, 0x11, 0x08, 0x11, 0x00, 0x55, 0xaa}};
  Bytes all;
  for (int copy = 0; copy < 5; ++copy) {
    const Bytes some = received(Framing::usb2can, looks);
    all.insert(all.end(), some.begin(), some.end());
  }
  EXPECT_EQ(frames_in(Framing::usb2can, all), std::vector(5, looks));
}

TEST(DamiaoFraming, NoticesOfTheAdapterAreNoFramesAndCostNone) {
  Bytes all;
  for (const std::uint8_t notice : Bytes{0x00, 0x01, 0x02, 0x03, 0x12, 0x13, 0xee}) {
    Bytes some = received(Framing::usb2can, feedback);
    some[1] = notice;
    all.insert(all.end(), some.begin(), some.end());
    const Bytes good = received(Framing::usb2can, feedback);
    all.insert(all.end(), good.begin(), good.end());
  }
  EXPECT_EQ(frames_in(Framing::usb2can, all), std::vector(7, feedback));
  EXPECT_EQ(frames_in(Framing::slcan, bytes_of("\r\r\az\rt0018")), std::vector<CanFrame>{});
  EXPECT_EQ(frames_in(Framing::slcan, bytes_of("\rz\r\at0118118A3C7FF8661E1C\r\r")), std::vector{feedback});
}

TEST(DamiaoFraming, RemoteExtendedAndErrorFramesAreLeftOut) {
  for (const std::uint8_t upper : Bytes{0x40, 0x80}) {
    Bytes some = received(Framing::usb2can, feedback);
    some[2] = static_cast<std::uint8_t>(some[2] | upper);
    EXPECT_TRUE(frames_in(Framing::usb2can, some).empty());
  }
  EXPECT_TRUE(frames_in(Framing::slcan, bytes_of("r0118\rT000000118118A3C7FF8661E1C\r")).empty());
  can_frame structure{};
  structure.len = 8;
  for (const canid_t flag : {CAN_EFF_FLAG, CAN_RTR_FLAG, CAN_ERR_FLAG}) {
    structure.can_id = flag | 0x11;
    Bytes some(sizeof(structure));
    std::memcpy(some.data(), &structure, sizeof(structure));
    EXPECT_TRUE(frames_in(Framing::socketcan, some).empty());
  }
  EXPECT_TRUE(frames_in(Framing::socketcan, Bytes(15)).empty());
}

TEST(DamiaoFraming, AFlexibleInterfaceMayHearClassicFrames) {
  EXPECT_EQ(frames_in(Framing::socketcan_fd, bytes_of(wrap(Framing::socketcan, feedback))), std::vector{feedback});
}

}  // namespace framing_test
}  // namespace tactus::devices::damiao
