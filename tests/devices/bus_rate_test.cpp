#include <tactus/devices/bus_thread.hpp>
#include <tactus/devices/dynamixel/dynamixel_bus.hpp>
#include <tactus/devices/dynamixel/packet.hpp>
#include <tactus/devices/motor_bus_device.hpp>
#include <tactus/emulation/dynamixel/dynamixel_peer.hpp>
#include <tactus/wire/paced.hpp>
#include <tactus/wire/talk.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include "tests/sanitizers.hpp"
#include <gtest/gtest.h>

/// What the driver costs at the real clock: beside a loop that does nothing but ask and wait, at the same peer.
namespace tactus::devices {
namespace bus_rate_test {

using emulation::dynamixel::DynamixelPeer;

constexpr std::int64_t servos = 7, bits_per_s = 1'000'000;

/// Emulated servos at a pseudo-terminal, their bytes at the pace of the line.
class Servos {
 public:
  Servos()
      : peer_(make()),
        line_(peer_, wire::byte_ns(bits_per_s), wire::Paced::Line::half_duplex),
        port_(*wire::Port::pseudo_terminal()),
        thread_([this] { wire::talk(line_, port_, [this] { return stopping_.load(); }); }) {}
  ~Servos() { fall_silent(); }
  void fall_silent() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] wire::Port open() const { return *wire::Port::serial(port_.path(), bits_per_s); }

 private:
  static DynamixelPeer make() {
    DynamixelPeer::Params params;
    params.servos.clear();
    for (std::int64_t id = 1; id <= servos; ++id) params.servos.push_back({.id = id});
    return DynamixelPeer::make(params).value();
  }

  DynamixelPeer peer_;
  wire::Paced line_;
  wire::Port port_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

/// The goals and the question of a cycle, again as soon as so many bytes have come.
class BareLoop final : public wire::WireEnd {
 public:
  BareLoop() {
    using namespace dynamixel;
    ServoPacket goals, states;
    goals.put(102, 2);
    goals.put(2, 2);
    states.put(126, 2);
    states.put(10, 2);
    for (std::int64_t id = 1; id <= servos; ++id) {
      goals.put(id, 1);
      goals.put(0, 2);
      states.put(id, 1);
    }
    goals_ = encode(broadcast, Instruction::sync_write, goals.bytes());
    states_ = encode(broadcast, Instruction::sync_read, states.bytes());
  }
  void hear(std::span<const std::uint8_t> bytes, std::int64_t) noexcept override {
    constexpr std::size_t answer_bytes = servos * 21;
    heard_ += bytes.size();
    if (heard_ < answer_bytes) return;
    heard_ = 0;
    said_ = 0;
    ++cycles_;
  }
  std::span<const std::uint8_t> say(std::int64_t) noexcept override {
    constexpr int both = 2;
    if (said_ == both) return {};
    return ++said_ == 1 ? goals_.bytes() : states_.bytes();
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return wire::never_ns; }
  [[nodiscard]] std::int64_t cycles() const { return cycles_; }

 private:
  ServoPacket goals_, states_;
  int said_ = 0;
  std::size_t heard_ = 0;
  std::int64_t cycles_ = 0;
};

constexpr std::chrono::milliseconds one_look{400};

double bare_cycles_per_s(const Servos& there) {
  BareLoop loop;
  wire::Port port = there.open();
  const std::int64_t begin_ns = wire::monotonic_ns();
  const std::int64_t end_ns = begin_ns + std::chrono::nanoseconds(one_look).count();
  wire::talk(loop, port, [end_ns] { return wire::monotonic_ns() > end_ns; });
  return static_cast<double>(loop.cycles()) / (1e-9 * static_cast<double>(wire::monotonic_ns() - begin_ns));
}

std::unique_ptr<BusThread> drive(const Servos& there) {
  dynamixel::DynamixelBus::Params params;
  for (std::int64_t id = 1; id <= servos; ++id) params.motors.push_back({.id = id});
  params.fast_sync_read = false;  // after a lost answer plain reads would follow for a while, in one of the two
  auto bus = std::make_unique<dynamixel::DynamixelBus>(dynamixel::DynamixelBus::make(params).value());
  auto thread = BusThread::start(std::move(bus), there.open(), {});
  EXPECT_TRUE(thread.ok());
  EXPECT_FALSE((*thread)->wait_until_asked(Seconds{10.0}));
  return *std::move(thread);
}

double own_cycles_per_s(const Servos& there) {
  const auto bus = drive(there);
  // At the beginning each servo is looked at once more between two cycles.
  std::this_thread::sleep_for(one_look);
  const auto before = bus->newest();
  std::this_thread::sleep_for(one_look);
  const auto after = bus->newest();
  return static_cast<double>(after->cycles - before->cycles) /
         (1e-9 * static_cast<double>(after->time_ns - before->time_ns));
}

double median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2));
  return values[values.size() / 2];
}

TEST(BusRate, ItsCyclesAreAsManyAsThoseOfABareLoopAtTheSamePeer) {
  if (TACTUS_UNDER_ADDRESS_SANITIZER || TACTUS_UNDER_THREAD_SANITIZER) {
    GTEST_SKIP() << "a sanitizer slows the driver, which does more between two cycles, and hardly the bare loop";
  }
  const Servos there;
  static_cast<void>(drive(there));  // return delay 0, for both
  double best = 0.0;
  // On a machine that does other things too, the two take turns.
  for (int tries = 0; tries < 4 && best < 0.95; ++tries) {
    std::vector<double> shares;
    for (int turn = 0; turn < 3; ++turn) {
      const double bare = bare_cycles_per_s(there), own = own_cycles_per_s(there);
      shares.push_back(own / bare);
      std::printf("bare %.0f, driver %.0f cycles/s\n", bare, own);
    }
    best = std::max(best, median(shares));
  }
  EXPECT_GE(best, 0.95);
}

/// How far cycles are from the median of their lengths, 99 of 100, as a share of it.
double jitter_share(const BusThread& bus) {
  std::vector<double> lengths;
  const std::int64_t end_ns = wire::monotonic_ns() + 5 * std::chrono::nanoseconds(one_look).count();
  auto before = *bus.newest();
  while (wire::monotonic_ns() < end_ns) {
    const auto now = *bus.newest();
    if (now.cycles == before.cycles + 1) lengths.push_back(static_cast<double>(now.time_ns - before.time_ns));
    before = now;
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  const double middle = median(lengths);
  for (double& length : lengths) length = std::fabs(length - middle) / middle;
  std::ranges::sort(lengths);
  std::printf("%zu cycles of %.3f ms, 99 of 100 within %.1f %%\n", lengths.size(), 1e-6 * middle,
              100.0 * lengths[lengths.size() * 99 / 100]);
  return lengths[lengths.size() * 99 / 100];
}

TEST(BusRate, ItsCyclesAreEvenOnAMachineThatDoesNothingElse) {
  const Servos there;
  const auto bus = drive(there);
  std::this_thread::sleep_for(one_look);
  const double share = jitter_share(*bus);
  if (std::getenv("TACTUS_QUIET_MACHINE") == nullptr) GTEST_SKIP() << "set TACTUS_QUIET_MACHINE=1 where it is one";
  EXPECT_LE(share, 0.1);
}

/// The median of what a tick takes, read and write, in ns.
double tick_ns(MotorBusDevice& device) {
  std::vector<double> all;
  constexpr int ticks = 2000;
  const Joints<station::DeviceCommand> command(servos, {.force_N = 0.0, .enabled = false});
  for (int tick = 0; tick < ticks; ++tick) {
    const std::int64_t begin_ns = wire::monotonic_ns();
    device.read({.number = tick, .deadline_ns = begin_ns, .began_ns = begin_ns});
    device.write(command);
    all.push_back(static_cast<double>(wire::monotonic_ns() - begin_ns));
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return median(std::move(all));
}

TEST(BusRate, ATickTakesNoLongerWithABusThatIsDead) {
  Servos there;
  const auto bus = drive(there);
  MotorJoint joint;
  joint.lower_rad = -100.0;
  joint.upper_rad = 100.0;
  joint.velocity_limit_rad_per_s = 100.0;
  joint.torque_limit_Nm = 0.1;
  auto device = MotorBusDevice::make(*bus, {.joints = Joints<MotorJoint>(servos, joint)});
  ASSERT_TRUE(device);
  const double on_ns = tick_ns(**device);
  there.fall_silent();
  const double dead_ns = tick_ns(**device);
  std::printf("tick: %.0f ns with the bus on, %.0f ns with it dead\n", on_ns, dead_ns);
  EXPECT_EQ((*device)->health(), station::DeviceHealth::silent);
  EXPECT_LT(dead_ns, 2.0 * on_ns + 1000.0);
}

}  // namespace bus_rate_test
}  // namespace tactus::devices
