// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/port.hpp>

#include <array>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <tests/scratch_path.hpp>
#include <tests/wire/scripted_end.hpp>
#include <unistd.h>

namespace tactus::wire {
namespace {

using testing::Bytes;

/// So many bytes, or what came of them within a second.
Bytes read_from(const Port& port, std::size_t count) {
  Bytes all;
  std::array<std::uint8_t, 512> some{};
  pollfd there{.fd = port.descriptor(), .events = POLLIN, .revents = 0};
  while (all.size() < count && poll(&there, 1, 1000) > 0) {
    const ssize_t size = read(port.descriptor(), some.data(), some.size());
    if (size <= 0) break;
    all.insert(all.end(), some.begin(), some.begin() + size);
  }
  return all;
}

/// The kernel passes bytes on by a thread of its own.
void wait_for_byte_at(const std::string& path) {
  pollfd there{.fd = open(path.c_str(), O_RDONLY | O_NOCTTY | O_CLOEXEC), .events = POLLIN, .revents = 0};
  poll(&there, 1, 1000);
  close(there.fd);
}

Bytes every_byte() {
  Bytes bytes(256);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

std::string refusal(const Result<Port>& port) { return port ? std::string("no error") : describe(port.error()); }

TEST(Port, APseudoTerminalPassesEveryByteBothWaysAndEchoesNone) {
  const auto device = Port::pseudo_terminal();
  ASSERT_TRUE(device) << describe(device.error());
  const auto driver = Port::serial(device->path(), 4'000'000);
  ASSERT_TRUE(driver) << describe(driver.error());
  ASSERT_EQ(driver->write(every_byte()), 256U);
  EXPECT_EQ(read_from(*device, 256), every_byte());
  ASSERT_EQ(device->write(every_byte()), 256U);
  EXPECT_EQ(read_from(*driver, 256), every_byte());
}

TEST(Port, APseudoTerminalEchoesNothingBeforeADriverHasCome) {
  const auto device = Port::pseudo_terminal();
  ASSERT_TRUE(device);
  ASSERT_EQ(device->write(Bytes{1, 2, 3}), 3U);
  std::array<std::uint8_t, 8> some{};
  EXPECT_EQ(read(device->descriptor(), some.data(), some.size()), -1);
}

TEST(Port, APseudoTerminalStaysWhenADriverLeavesAndBytesFromBeforeAreThrownAway) {
  const auto device = Port::pseudo_terminal();
  ASSERT_TRUE(device);
  for (int visit = 0; visit < 3; ++visit) {
    ASSERT_EQ(device->write(Bytes{0xee}), 1U);
    wait_for_byte_at(device->path());
    const auto driver = Port::serial(device->path(), 921'600);
    ASSERT_TRUE(driver) << describe(driver.error());
    ASSERT_EQ(device->write(Bytes{7}), 1U);
    EXPECT_EQ(read_from(*driver, 1), Bytes{7});
  }
}

TEST(Port, TwoProgramsDoNotGetTheSamePort) {
  const auto device = Port::pseudo_terminal();
  ASSERT_TRUE(device);
  auto first = Port::serial(device->path(), 921'600);
  ASSERT_TRUE(first);
  const std::string why = refusal(Port::serial(device->path(), 921'600));
  EXPECT_NE(why.find(device->path() + ": another program has it open"), std::string::npos) << why;
  { const Port moved = *std::move(first); }
  EXPECT_TRUE(Port::serial(device->path(), 921'600).ok());
}

TEST(Port, WhatIsNotThereOrNoSerialPortIsNamedWithTheRemedy) {
  const std::string missing = refusal(Port::serial("/dev/ttyUSB-nobody", 921'600));
  EXPECT_NE(missing.find("/dev/ttyUSB-nobody: there is no such port"), std::string::npos) << missing;
  const std::string null = refusal(Port::serial("/dev/null", 921'600));
  EXPECT_NE(null.find("/dev/null: this is no serial port"), std::string::npos) << null;
  const auto rate = Port::serial("/dev/null", 7);
  ASSERT_FALSE(rate);
  EXPECT_EQ(rate.error().code, ErrorCode::out_of_bounds);
}

TEST(Port, NoRightToOpenItSaysHowToGetIt) {
  if (geteuid() == 0) GTEST_SKIP() << "the superuser has every right";
  const auto file = scratch_path();
  std::ofstream(file) << "x";
  std::filesystem::permissions(file, std::filesystem::perms::none);
  const std::string why = refusal(Port::serial(file.string(), 921'600));
  std::filesystem::remove(file);
  EXPECT_NE(why.find("dialout"), std::string::npos) << why;
}

TEST(Port, APairKeepsPacketsApartAndAClosedEndDoesNotKill) {
  auto ends = Port::pair();
  ASSERT_TRUE(ends) << describe(ends.error());
  ASSERT_EQ(ends->first.write(Bytes{1, 2}), 2U);
  ASSERT_EQ(ends->first.write(Bytes{3}), 1U);
  std::array<std::uint8_t, 8> some{};
  EXPECT_EQ(read(ends->second.descriptor(), some.data(), some.size()), 2);
  EXPECT_EQ(read(ends->second.descriptor(), some.data(), some.size()), 1);
  { const Port gone = std::move(ends->second); }
  EXPECT_EQ(ends->first.write(Bytes{1}), 0U);
}

TEST(Port, ACanInterfaceThatIsNotThereIsRefusedWithTheRemedy) {
  const auto port = Port::can("can-nobody", false);
  ASSERT_FALSE(port);
  const std::string why = refusal(port);
  EXPECT_NE(why.find(port.error().code == ErrorCode::missing ? "ip link set" : "modprobe can_raw"), std::string::npos)
      << why;
}

}  // namespace
}  // namespace tactus::wire
