// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/latency_timer.hpp>

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <tests/scratch_path.hpp>

namespace tactus::wire {
namespace latency_timer_test {

TEST(LatencyTimer, OneThatIsTooSlowIsToldWithTheCommandThatMendsIt) {
  namespace fs = std::filesystem;
  const fs::path folder = scratch_path();
  // A machine with an adapter, which a person names by its link.
  const fs::path timer = folder / "sys/bus/usb-serial/devices/ttyUSB7/latency_timer";
  fs::create_directories(timer.parent_path());
  std::ofstream(folder / "ttyUSB7") << "";
  fs::create_symlink(folder / "ttyUSB7", folder / "by-id");
  std::ofstream(timer) << "16\n";
  const Check slow = check_latency_timer((folder / "by-id").string(), folder / "sys");
  ASSERT_TRUE(slow);
  EXPECT_EQ(slow->message,
            "the adapter holds received bytes for 16 ms before it hands it over, where 1 ms is needed: "
            "echo 1 | sudo tee " +
                timer.string());
  std::ofstream(timer) << "1\n";
  EXPECT_FALSE(check_latency_timer((folder / "by-id").string(), folder / "sys"));
  // An adapter of another make has none; a port that is not there is not its business.
  EXPECT_FALSE(check_latency_timer("/dev/null", folder / "sys"));
  EXPECT_FALSE(check_latency_timer((folder / "nobody").string(), folder / "sys"));
  fs::remove_all(folder);
}

}  // namespace latency_timer_test
}  // namespace tactus::wire
