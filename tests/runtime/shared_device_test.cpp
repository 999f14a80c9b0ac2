// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/shared_device.hpp>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <limits>
#include <memory>
#include <thread>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactus::runtime {
namespace shared_device_test {

/// A value whose words all say the same, as long as it is whole.
struct Words {
  std::uint64_t word[6];
};
Words all(std::uint64_t number) { return {{number, number, number, number, number, number}}; }
bool is_whole(const Words& words) {
  for (const std::uint64_t word : words.word) {
    if (word != words.word[0]) return false;
  }
  return true;
}

/// Memory of two processes.
template <class T>
class Between {
 public:
  Between()
      : memory_(static_cast<T*>(mmap(nullptr, sizeof(T), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))) {}
  Between(const Between&) = delete;
  Between& operator=(const Between&) = delete;
  ~Between() { munmap(memory_, sizeof(T)); }
  T* operator->() const { return memory_; }
  T& operator*() const { return *memory_; }

 private:
  T* memory_;
};

template <std::size_t count>
void hammer() {
  const auto slots = std::make_unique<SharedSlots<Words, count>>();
  std::atomic<bool> enough{false};
  std::thread producer([&] {
    for (std::uint64_t i = 1; i <= 100'000 || !enough.load(std::memory_order_relaxed); ++i) slots->publish(all(i));
  });
  std::uint64_t last = 0;
  for (int seen = 0; seen < 1000;) {
    const auto newest = slots->newest();
    if (!newest) {
      std::this_thread::yield();
      continue;
    }
    ++seen;
    ASSERT_TRUE(is_whole(*newest)) << "torn after " << last;
    ASSERT_GE(newest->word[0], last) << "time went backward";
    last = newest->word[0];
  }
  enough = true;
  producer.join();
  EXPECT_TRUE(is_whole(slots->newest().value()));
}

TEST(SharedSlots, AValueThatIsReadWhileManyAreWrittenIsWhole) {
  hammer<1>();  // the producer always writes where the reader reads
  hammer<8>();
}

TEST(SharedSlots, KeepsAsManyValuesAsItHasSlots) {
  SharedSlots<Words, 4> slots{};
  EXPECT_FALSE(slots.newest());
  EXPECT_FALSE(slots.at(0));
  for (std::uint64_t i = 0; i < 10; ++i) slots.publish(all(i));
  EXPECT_EQ(slots.published(), 10U);
  EXPECT_EQ(slots.newest().value().word[5], 9U);
  for (std::uint64_t i = 6; i < 10; ++i) EXPECT_EQ(slots.at(i).value().word[0], i);
  EXPECT_FALSE(slots.at(5)) << "overwritten";
  EXPECT_FALSE(slots.at(10)) << "not there yet";
}

TEST(SharedSlots, AProducerThatIsKilledAnywhereLeavesWholeValuesAndAnotherGoesOn) {
  const Between<SharedSlots<Words, 2>> slots;
  for (int round = 0; round < 20; ++round) {
    const std::uint64_t before = slots->published();
    const pid_t child = fork();
    if (child == 0) {
      alarm(60);
      for (std::uint64_t i = before + 1;; ++i) slots->publish(all(i));
    }
    while (slots->published() < before + 1000) std::this_thread::yield();
    kill(child, SIGKILL);
    ASSERT_EQ(waitpid(child, nullptr, 0), child);
    const auto left = slots->newest();
    EXPECT_TRUE(!left || is_whole(*left));
    const std::uint64_t number = slots->published() + 1;
    slots->publish(all(number));
    EXPECT_EQ(slots->newest().value().word[3], number);
  }
}

constexpr std::int64_t period_ns = 200'000;
constexpr Seconds silence{0.002};  ///< 10 ticks

station::Tick tick(std::int64_t number) {
  return {.number = number, .deadline_ns = number * period_ns, .began_ns = number * period_ns};
}

/// Both sides in one thread, on a clock of the test's.
struct Sides {
  std::unique_ptr<DeviceSlots> slots = std::make_unique<DeviceSlots>();
  SharedDevice controller{*slots, {.force_N = 2.0}, silence};
  DeviceServer owner{*slots, silence};

  explicit Sides(std::uint64_t session = 1) {
    controller.begin(session);
    owner.begin(session);
  }
};

TEST(SharedDevice, TellsReadingsAndCommandsToTheBit) {
  Sides sides;
  EXPECT_EQ(sides.controller.limits().force_N, 2.0);
  for (std::int64_t n = 1; n < 100; ++n) {
    const double number = 1.0 / static_cast<double>(n);
    sides.owner.publish(tick(n), n, {.position_m = number, .force_N = -number, .grip = 2.0 * number});
    const station::DeviceReading read = sides.controller.read(tick(n));
    EXPECT_EQ(sides.controller.health(), station::DeviceHealth::good);
    EXPECT_EQ(read.position_m, number);
    EXPECT_EQ(read.force_N, -number);
    EXPECT_EQ(read.grip, 2.0 * number);
    sides.controller.write({.force_N = 3.0 * number, .handle_force_N = 4.0 * number});
    const station::DeviceCommand command = sides.owner.command(tick(n + 1));
    EXPECT_EQ(command.force_N, 3.0 * number);
    EXPECT_EQ(command.handle_force_N, 4.0 * number);
  }
  sides.controller.write({});
  EXPECT_EQ(sides.owner.command(tick(100)).force_N, 0.0) << "the last one has the time of the one before";
  EXPECT_FALSE(sides.owner.gave_up());
}

TEST(SharedDevice, AnOwnerThatFallsSilentIsDegradedThenLostForGood) {
  Sides sides;
  sides.owner.publish(tick(100), 0, {.position_m = 0.25});
  (void)sides.controller.read(tick(100));
  EXPECT_EQ(sides.controller.health(), station::DeviceHealth::good);
  for (std::int64_t n = 101; n <= 110; ++n) {
    EXPECT_EQ(sides.controller.read(tick(n)).position_m, 0.25);
    EXPECT_EQ(sides.controller.health(), station::DeviceHealth::degraded) << n;
  }
  EXPECT_EQ(sides.controller.read(tick(111)).position_m, 0.25);
  EXPECT_EQ(sides.controller.health(), station::DeviceHealth::lost);
  sides.owner.publish(tick(112), 1, {.position_m = 0.5});
  (void)sides.controller.read(tick(112));
  EXPECT_EQ(sides.controller.health(), station::DeviceHealth::lost) << "what comes back by itself is not trusted";
  sides.controller.begin(2);
  EXPECT_EQ(sides.controller.read(tick(112)).position_m, 0.5);
  EXPECT_EQ(sides.controller.health(), station::DeviceHealth::good);
}

TEST(SharedDevice, AnOwnerThatNeverToldAnythingOrHasAnotherClockIsLost) {
  Sides mute;
  (void)mute.controller.read(tick(1000));
  EXPECT_EQ(mute.controller.health(), station::DeviceHealth::lost);
  Sides ahead;
  ahead.owner.publish(tick(2000), 0, {});
  (void)ahead.controller.read(tick(1000));
  EXPECT_EQ(ahead.controller.health(), station::DeviceHealth::lost);
}

TEST(SharedDevice, ANumberThatIsNotFiniteIsRefusedOnBothSides) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const station::DeviceReading& bad :
       {station::DeviceReading{.position_m = nan}, station::DeviceReading{.force_N = inf},
        station::DeviceReading{.grip = -inf}}) {
    Sides sides;
    sides.owner.publish(tick(100), 0, {.position_m = 0.25});
    (void)sides.controller.read(tick(100));
    sides.owner.publish(tick(101), 1, bad);
    EXPECT_EQ(sides.controller.read(tick(101)).position_m, 0.25) << "the last good one";
    EXPECT_EQ(sides.controller.health(), station::DeviceHealth::lost);
  }
  for (const station::DeviceCommand& bad :
       {station::DeviceCommand{.force_N = nan}, station::DeviceCommand{.handle_force_N = inf}}) {
    Sides sides;
    sides.owner.publish(tick(100), 0, {});
    (void)sides.controller.read(tick(100));
    sides.controller.write(bad);
    const station::DeviceCommand given = sides.owner.command(tick(101));
    EXPECT_EQ(given.force_N, 0.0);
    EXPECT_EQ(given.handle_force_N, 0.0);
    EXPECT_TRUE(sides.owner.gave_up());
  }
}

TEST(SharedDevice, AMotorWhoseCommandsStayAwayGetsNoForceUntilTheNextSession) {
  Sides sides(7);
  sides.owner.publish(tick(100), 0, {});
  (void)sides.controller.read(tick(100));
  EXPECT_EQ(sides.owner.command(tick(100)).force_N, 0.0) << "none before the first command";
  sides.controller.write({.force_N = 1.5});
  for (std::int64_t n = 101; n <= 110; ++n) EXPECT_EQ(sides.owner.command(tick(n)).force_N, 1.5) << n;
  EXPECT_EQ(sides.owner.command(tick(111)).force_N, 0.0);
  EXPECT_TRUE(sides.owner.gave_up());

  // The controller is told, and cannot go on by itself.
  sides.owner.publish(tick(111), 1, {});
  (void)sides.controller.read(tick(111));
  EXPECT_EQ(sides.controller.health(), station::DeviceHealth::lost);
  EXPECT_TRUE(sides.controller.given_up_by_owner());
  sides.controller.write({.force_N = 1.0});
  EXPECT_EQ(sides.owner.command(tick(112)).force_N, 0.0);

  sides.owner.begin(8);
  EXPECT_EQ(sides.owner.command(tick(113)).force_N, 0.0) << "a command of the session before";
  sides.controller.begin(8);
  sides.owner.publish(tick(113), 0, {});
  (void)sides.controller.read(tick(113));
  EXPECT_EQ(sides.controller.health(), station::DeviceHealth::good);
  sides.controller.write({.force_N = 0.5});
  EXPECT_EQ(sides.owner.command(tick(114)).force_N, 0.5);
}

constexpr Seconds long_silence{10.0};
constexpr double trips = 2000.0;

/// The next tick of the calling thread. A command of a tick that does not grow would be silence after 10 s, which two
/// thousand trips may take on a machine that has other work.
station::Tick now() {
  thread_local std::int64_t number = 0;
  return {.number = ++number, .began_ns = monotonic_ns()};
}

/// The owner of a device that stands where it was told, until the last trip.
void echo(DeviceSlots& slots) {
  DeviceServer owner(slots, long_silence);
  owner.begin(1);
  for (double applied = 0.0; applied < trips; std::this_thread::yield()) {
    applied = owner.command(now()).force_N;
    owner.publish(now(), 0, {.position_m = applied, .force_N = -applied});
  }
}

/// Waits for each command to come back before it gives the next.
void expect_trips(DeviceSlots& slots) {
  SharedDevice controller(slots, {.force_N = 2.0}, long_silence);
  controller.begin(1);
  for (double sent = 1.0; sent <= trips; sent += 1.0) {
    station::DeviceReading back = controller.read(now());
    controller.write({.force_N = sent});
    while (back.position_m < sent) {
      std::this_thread::yield();
      back = controller.read(now());
      ASSERT_NE(controller.health(), station::DeviceHealth::lost);
      ASSERT_EQ(back.force_N, -back.position_m);
    }
    ASSERT_EQ(back.position_m, sent);
  }
}

TEST(SharedDevice, GoesRoundBetweenTwoThreads) {
  const auto slots = std::make_unique<DeviceSlots>();
  DeviceServer(*slots, long_silence).publish(now(), 0, {});
  std::thread owner([&] { echo(*slots); });
  expect_trips(*slots);
  owner.join();
}

TEST(SharedDevice, GoesRoundBetweenTwoProcesses) {
  const Between<DeviceSlots> slots;
  DeviceServer(*slots, long_silence).publish(now(), 0, {});
  const pid_t child = fork();
  if (child == 0) {
    alarm(60);
    echo(*slots);
    _exit(0);
  }
  expect_trips(*slots);
  int status = -1;
  waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
}

}  // namespace shared_device_test
}  // namespace tactus::runtime
