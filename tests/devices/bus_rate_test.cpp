// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/bus_thread.hpp>
#include <tactus/hardware/devices/damiao/damiao_bus.hpp>
#include <tactus/hardware/devices/dynamixel/dynamixel_bus.hpp>
#include <tactus/hardware/devices/dynamixel/packet.hpp>
#include <tactus/hardware/devices/feetech/feetech_bus.hpp>
#include <tactus/hardware/devices/feetech/packet.hpp>
#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>
#include <tactus/hardware/emulation/dynamixel/dynamixel_peer.hpp>
#include <tactus/hardware/emulation/feetech/feetech_peer.hpp>
#include <tactus/hardware/wire/paced.hpp>
#include <tactus/hardware/wire/talk.hpp>
#include <tactus/runtime/servo/rights.hpp>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <span>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/sanitizers.hpp"
#include <gtest/gtest.h>

/// What the driver costs at the real clock: beside a loop that does nothing but ask and wait, at the same peer.
namespace tactus::devices {
namespace bus_rate_test {

enum class Make { dynamixel, feetech, damiao_usb2can, damiao_slcan };

/// Motors of a make on one bus, and what a program must know to ask them.
struct Motors {
  const char* name;
  Make make;
  std::uint8_t count;
};
constexpr Motors seven_dynamixel{"dynamixel", Make::dynamixel, 7};

bool are_servos(Make make) { return make == Make::dynamixel || make == Make::feetech; }
std::int64_t bits_per_s(Make make) { return are_servos(make) ? 1'000'000 : 921'600; }
damiao::Framing framing(Make make) {
  return make == Make::damiao_slcan ? damiao::Framing::slcan : damiao::Framing::usb2can;
}

std::unique_ptr<wire::WireEnd> emulated(const Motors& motors) {
  if (!are_servos(motors.make)) {
    emulation::damiao::PeerSettings settings;
    if (motors.make == Make::damiao_slcan) settings.adapter = emulation::damiao::AdapterType::slcan;
    for (std::uint32_t id = 1; id <= motors.count; ++id) settings.motors.push_back({.id = id, .feedback_id = id + 16});
    return emulation::damiao::DamiaoPeer::make(settings).value();
  }
  const auto servos = [&motors]<class Peer>(std::type_identity<Peer>) {
    typename Peer::Params params;
    params.servos.clear();
    for (std::int64_t id = 1; id <= motors.count; ++id) params.servos.push_back({.id = id});
    return std::make_unique<Peer>(Peer::make(params).value());
  };
  if (motors.make == Make::dynamixel) return servos(std::type_identity<emulation::dynamixel::DynamixelPeer>{});
  return servos(std::type_identity<emulation::feetech::FeetechPeer>{});
}

/// Emulated motors at a pseudo-terminal, their bytes at the pace of the line.
class Emulation {
 public:
  explicit Emulation(const Motors& motors)
      : motors_(motors),
        peer_(emulated(motors)),
        line_(*peer_, wire::byte_ns(bits_per_s(motors.make)),
              are_servos(motors.make) ? wire::Paced::Line::half_duplex : wire::Paced::Line::full_duplex),
        port_(*wire::Port::pseudo_terminal()),
        thread_([this] { wire::talk(line_, port_, [this] { return stopping_.load(); }); }) {}
  ~Emulation() { fall_silent(); }
  void fall_silent() {
    stopping_ = true;
    if (thread_.joinable()) thread_.join();
  }
  [[nodiscard]] wire::Port open() const { return *wire::Port::serial(port_.path(), bits_per_s(motors_.make)); }
  [[nodiscard]] const Motors& motors() const { return motors_; }

 private:
  Motors motors_;
  std::unique_ptr<wire::WireEnd> peer_;
  wire::Paced line_;
  wire::Port port_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

/// What is said in a cycle, packet by packet, and how many bytes answer it.
struct Cycle {
  std::vector<std::vector<std::uint8_t>> says;
  std::size_t answer_bytes = 0;
};

Cycle cycle_of(const Motors& motors) {
  Cycle cycle;
  const auto say = [&cycle](std::span<const std::uint8_t> bytes) {
    cycle.says.emplace_back(bytes.begin(), bytes.end());
  };
  if (!are_servos(motors.make)) {
    // A frame of feedback has 16 bytes in Damiao's packets, and 22 as text.
    for (std::uint16_t id = 1; id <= motors.count; ++id)
      say(wrap(framing(motors.make), damiao::refresh_frame(id)).view());
    cycle.answer_bytes = motors.count * (motors.make == Make::damiao_slcan ? 22U : 16U);
    return cycle;
  }
  ServoPacket goals, states;
  const bool wide = motors.make == Make::dynamixel;  // numbers of registers have two bytes
  const std::size_t number = wide ? 2 : 1;
  goals.put(wide ? 102 : 44, number);
  goals.put(2, number);
  states.put(wide ? 126 : 56, number);
  states.put(wide ? 10 : 15, number);
  for (std::int64_t id = 1; id <= motors.count; ++id) {
    goals.put(id, 1);
    goals.put(0, 2);
    states.put(id, 1);
  }
  const auto both = [&](auto sync_write, auto sync_read, std::uint8_t all, auto encode) {
    say(encode(all, sync_write, goals.bytes()).bytes());
    say(encode(all, sync_read, states.bytes()).bytes());
  };
  if (wide) {
    both(dynamixel::Instruction::sync_write, dynamixel::Instruction::sync_read, dynamixel::broadcast,
         dynamixel::encode);
  } else {
    both(feetech::Instruction::sync_write, feetech::Instruction::sync_read, feetech::broadcast, feetech::encode);
  }
  cycle.answer_bytes = motors.count * 21U;
  return cycle;
}

/// A cycle again as soon as so many bytes have come. It first waits until what others asked for has come: were that
/// taken for answers of its own, it would be a cycle ahead of them from then on.
class BareLoop final : public wire::WireEnd {
 public:
  explicit BareLoop(Cycle cycle) : cycle_(std::move(cycle)) {}
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override {
    if (now_ns < from_ns_) return;
    heard_ += bytes.size();
    if (heard_ < cycle_.answer_bytes) return;
    heard_ = said_ = 0;
    ends_ns_.push_back(wire::monotonic_ns());
  }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override {
    if (now_ns < from_ns_ || said_ == cycle_.says.size()) return {};
    return cycle_.says[said_++];
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override {
    return said_ == 0 && ends_ns_.empty() ? from_ns_ : wire::never_ns;
  }
  /// When each cycle ended.
  [[nodiscard]] const std::vector<std::int64_t>& ends_ns() const { return ends_ns_; }

 private:
  Cycle cycle_;
  std::int64_t from_ns_ = wire::monotonic_ns() + 50'000'000;
  std::size_t said_ = 0, heard_ = 0;
  std::vector<std::int64_t> ends_ns_;
};

constexpr std::chrono::milliseconds one_look{400};

/// When each cycle of a bare loop ended.
std::vector<std::int64_t> bare_cycles_ns(const Emulation& there, std::chrono::nanoseconds how_long) {
  BareLoop loop(cycle_of(there.motors()));
  wire::Port port = there.open();
  std::thread([&] {
    constexpr int that_of_a_bus_thread = 70, any_core = -1;
    runtime::take_thread_rights(that_of_a_bus_thread, any_core);
    const std::int64_t end_ns = wire::monotonic_ns() + how_long.count();
    wire::talk(loop, port, [end_ns] { return wire::monotonic_ns() > end_ns; });
  }).join();
  return loop.ends_ns();
}

double bare_cycles_per_s(const Emulation& there) {
  const auto ends_ns = bare_cycles_ns(there, one_look);
  if (ends_ns.size() < 2) return 0.0;
  return static_cast<double>(ends_ns.size() - 1) / (1e-9 * static_cast<double>(ends_ns.back() - ends_ns.front()));
}

std::unique_ptr<MotorBus> driver_of(const Motors& motors) {
  if (!are_servos(motors.make)) {
    damiao::DamiaoBusParams params;
    params.framing = framing(motors.make);
    for (std::uint32_t id = 1; id <= motors.count; ++id) params.motors.push_back({.id = id, .feedback_id = id + 16});
    return damiao::DamiaoBus::make(params).value();
  }
  if (motors.make == Make::dynamixel) {
    dynamixel::DynamixelBus::Params params;
    for (std::int64_t id = 1; id <= motors.count; ++id) params.motors.push_back({.id = id});
    params.fast_sync_read = false;  // after a lost answer plain reads would follow for a while, in one of the two
    return std::make_unique<dynamixel::DynamixelBus>(dynamixel::DynamixelBus::make(params).value());
  }
  feetech::FeetechBus::Params params;
  for (std::int64_t id = 1; id <= motors.count; ++id) {
    params.motors.push_back({.id = id, .model = feetech::FeetechModel::hls3625, .torque_Nm_per_A = 1.0});
  }
  return std::make_unique<feetech::FeetechBus>(feetech::FeetechBus::make(params).value());
}

/// A machine that stands still for a moment makes motors silent while they are asked for the first time. That is not
/// what is measured here, so it is tried again.
std::unique_ptr<BusThread> drive(const Emulation& there) {
  constexpr int most_tries = 3;
  for (int tried = 1;; ++tried) {
    auto thread = BusThread::start(driver_of(there.motors()), there.open(), {});
    EXPECT_TRUE(thread.ok());
    const Check silent = (*thread)->wait_until_asked(Seconds{10.0});
    if (silent && tried < most_tries) continue;
    EXPECT_FALSE(silent) << describe(*silent);
    return *std::move(thread);
  }
}

double own_cycles_per_s(const Emulation& there) {
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

class BusRateOf : public testing::TestWithParam<Motors> {};

TEST_P(BusRateOf, ItsCyclesAreAsManyAsThoseOfABareLoopAtTheSamePeer) {
  if (TACTUS_UNDER_ADDRESS_SANITIZER || TACTUS_UNDER_THREAD_SANITIZER) {
    GTEST_SKIP() << "a sanitizer slows the driver, which does more between two cycles, and hardly the bare loop";
  }
  const Emulation there(GetParam());
  static_cast<void>(drive(there));  // return delay 0, the port of slcan open, for both
  double best = 0.0;
  // On a machine that does other things too, the two take turns.
  for (int tries = 0; tries < 4 && best < 0.95; ++tries) {
    std::vector<double> shares;
    for (int turn = 0; turn < 3; ++turn) {
      const double bare = bare_cycles_per_s(there), own = own_cycles_per_s(there);
      EXPECT_GT(bare, 50.0);
      shares.push_back(own / bare);
      std::printf("bare %.0f, driver %.0f cycles/s\n", bare, own);
    }
    best = std::max(best, median(shares));
  }
  EXPECT_GE(best, 0.95);
}
INSTANTIATE_TEST_SUITE_P(EachMake, BusRateOf,
                         testing::Values(seven_dynamixel, Motors{"feetech", Make::feetech, 8},
                                         Motors{"damiao_usb2can", Make::damiao_usb2can, 8},
                                         Motors{"damiao_slcan", Make::damiao_slcan, 7}),
                         [](const auto& made) { return made.param.name; });

/// How far lengths of cycles are from their median, 99 of 100, as a share of it.
double jitter_share(std::vector<double> lengths) {
  const double middle = median(lengths);
  for (double& length : lengths) length = std::fabs(length - middle) / middle;
  std::ranges::sort(lengths);
  return lengths[lengths.size() * 99 / 100];
}

constexpr auto long_look = 5 * one_look;

double own_jitter_share(const BusThread& bus) {
  std::vector<double> lengths;
  const std::int64_t end_ns = wire::monotonic_ns() + std::chrono::nanoseconds(long_look).count();
  auto before = *bus.newest();
  while (wire::monotonic_ns() < end_ns) {
    const auto now = *bus.newest();
    if (now.cycles == before.cycles + 1) lengths.push_back(static_cast<double>(now.time_ns - before.time_ns));
    before = now;
    std::this_thread::sleep_for(std::chrono::microseconds(100));
  }
  return jitter_share(std::move(lengths));
}

double bare_jitter_share(const Emulation& there) {
  const auto ends_ns = bare_cycles_ns(there, long_look);
  std::vector<double> lengths;
  for (std::size_t i = 1; i < ends_ns.size(); ++i) {
    lengths.push_back(static_cast<double>(ends_ns[i] - ends_ns[i - 1]));
  }
  return jitter_share(std::move(lengths));
}

/// Where the machine itself stands still, as a virtual one does, a bare loop is as uneven.
TEST(BusRate, ItsCyclesAreEvenOnAMachineThatDoesNothingElse) {
  if (std::getenv("TACTUS_QUIET_MACHINE") == nullptr) GTEST_SKIP() << "set TACTUS_QUIET_MACHINE=1 where it is one";
  const Emulation there(seven_dynamixel);
  std::vector<double> own, bare;
  for (int turn = 0; turn < 5; ++turn) {
    {
      const auto bus = drive(there);
      std::this_thread::sleep_for(one_look);
      own.push_back(own_jitter_share(*bus));
    }
    bare.push_back(bare_jitter_share(there));
    std::printf("99 of 100 cycles within %.1f %% of their median, of a bare loop %.1f %%\n", 100.0 * own.back(),
                100.0 * bare.back());
  }
  EXPECT_LE(median(own), std::max(0.1, 1.25 * median(bare)));
}

/// The median of what a tick takes, read and write, in ns.
double tick_ns(MotorBusDevice& device) {
  std::vector<double> all;
  constexpr int ticks = 2000;
  const Joints<station::DeviceCommand> command(seven_dynamixel.count, {.force_N = 0.0, .enabled = false});
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
  Emulation there(seven_dynamixel);
  const auto bus = drive(there);
  MotorJoint joint;
  joint.lower_rad = -100.0;
  joint.upper_rad = 100.0;
  joint.velocity_limit_rad_per_s = 100.0;
  joint.torque_limit_Nm = 0.1;
  auto device = MotorBusDevice::make(*bus, {.joints = Joints<MotorJoint>(seven_dynamixel.count, joint)});
  ASSERT_TRUE(device);
  const double on_ns = tick_ns(**device);
  there.fall_silent();
  const double dead_ns = tick_ns(**device);
  std::printf("tick: %.0f ns with the bus on, %.0f ns with it dead\n", on_ns, dead_ns);
  EXPECT_EQ((*device)->health(), station::DeviceHealth::not_responding);
  EXPECT_LT(dead_ns, 2.0 * on_ns + 1000.0);
}

}  // namespace bus_rate_test
}  // namespace tactus::devices
