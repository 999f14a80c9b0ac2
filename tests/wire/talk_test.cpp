// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/talk.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <functional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <poll.h>
#include <tests/allocation_counter.hpp>
#include <tests/wire/scripted_end.hpp>
#include <unistd.h>

namespace tactus::wire {
namespace {

using testing::Bytes;

/// Sends back what it hears.
class Echo final : public WireEnd {
 public:
  void hear(std::span<const std::uint8_t> bytes, std::int64_t) noexcept override {
    for (const std::uint8_t byte : bytes) {
      if (size_ < waiting_.size()) waiting_[size_++] = byte;
    }
  }
  std::span<const std::uint8_t> say(std::int64_t) noexcept override {
    return {waiting_.data(), std::exchange(size_, 0)};
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return never_ns; }

 private:
  std::array<std::uint8_t, 4096> waiting_{};
  std::size_t size_ = 0;
};

/// Says a byte every so often, and wants to be called exactly then.
class Metronome final : public WireEnd {
 public:
  Metronome(std::int64_t start_ns, std::int64_t period_ns) : due_ns_(start_ns + period_ns), period_ns_(period_ns) {}
  void hear(std::span<const std::uint8_t>, std::int64_t) noexcept override {}
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override {
    if (now_ns < due_ns_) return {};
    early_or_late_ns.push_back(now_ns - due_ns_);
    due_ns_ += period_ns_;
    return byte_;
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return due_ns_; }

  std::vector<std::int64_t> early_or_late_ns;

 private:
  std::int64_t due_ns_, period_ns_;
  std::array<std::uint8_t, 1> byte_{42};
};

/// Talks in a thread of its own.
struct Talking {
  Talking(WireEnd& end, Port& port)
      : thread([this, &end, &port] { result = talk(end, port, [this] { return stop.load(); }); }) {}
  ~Talking() { finish(); }
  Check finish() {
    stop = true;
    if (thread.joinable()) thread.join();
    return result;
  }
  std::atomic<bool> stop{false};
  Check result;
  std::thread thread;
};

TEST(Talk, AnEndAtAPortHearsAndSaysUntilItIsToStop) {
  auto device = Port::pseudo_terminal();
  ASSERT_TRUE(device);
  const auto driver = Port::serial(device->path(), 921'600);
  ASSERT_TRUE(driver);
  Echo echo;
  Talking talking(echo, *device);
  for (std::uint8_t round = 0; round < 20; ++round) {
    ASSERT_EQ(driver->write(Bytes{round}), 1U);
    pollfd there{.fd = driver->descriptor(), .events = POLLIN, .revents = 0};
    ASSERT_EQ(poll(&there, 1, 5000), 1);
    std::uint8_t byte = 0xff;
    ASSERT_EQ(read(driver->descriptor(), &byte, 1), 1);
    EXPECT_EQ(byte, round);
  }
  EXPECT_FALSE(talking.finish());
}

TEST(Talk, APortThatIsClosedEndsItWithItsName) {
  auto device = Port::pseudo_terminal();
  ASSERT_TRUE(device);
  auto driver = Port::serial(device->path(), 921'600);
  ASSERT_TRUE(driver);
  const std::string path = device->path();
  Echo echo;
  Talking talking(echo, *driver);
  { const Port unplugged = *std::move(device); }
  talking.thread.join();
  ASSERT_TRUE(talking.result);
  EXPECT_EQ(describe(*talking.result).find(path + ": the port was closed"), 0U) << describe(*talking.result);
}

TEST(Talk, AnEndIsCalledWhenItWantedToBeAndWithoutAnAllocation) {
  auto device = Port::pseudo_terminal();
  ASSERT_TRUE(device);
  constexpr std::int64_t period_ns = 2'000'000;
  const std::int64_t start_ns = monotonic_ns();
  Metronome metronome(start_ns, period_ns);
  metronome.early_or_late_ns.reserve(1000);
  const std::function<bool()> stop = [&metronome] { return metronome.early_or_late_ns.size() >= 50; };
  const std::uint64_t before = laws::own_allocation_count();
  const Check failed = talk(metronome, *device, stop);
  EXPECT_EQ(laws::own_allocation_count(), before);
  EXPECT_FALSE(failed);
  EXPECT_GE(monotonic_ns() - start_ns, 50 * period_ns);
  auto& late_ns = metronome.early_or_late_ns;
  std::nth_element(late_ns.begin(), late_ns.begin() + 5, late_ns.end());
  // On a busy machine the most are late; that one in ten is not shows that it does not wait in whole ms.
  EXPECT_LT(late_ns[5], 500'000);
}

TEST(Talk, APacketForWhichThereIsNoRoomIsLostAndNoneIsCutInTwo) {
  auto ends = Port::pair();
  ASSERT_TRUE(ends);
  testing::ScriptedEnd end;
  for (int packet = 0; packet < 5000; ++packet) end.script.emplace_back(0, Bytes(100, 3));
  const Check failed = talk(end, ends->first, [&end] { return end.script.empty(); });
  EXPECT_FALSE(failed);
  std::array<std::uint8_t, 200> some{};
  std::size_t packets = 0;
  while (read(ends->second.descriptor(), some.data(), some.size()) == 100) ++packets;
  EXPECT_GT(packets, 0U);
  EXPECT_LT(packets, 5000U);
}

}  // namespace
}  // namespace tactus::wire
