// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/emulation/servo_joint.hpp>
#include <tactus/hardware/emulation/servo_line.hpp>
#include <tactus/hardware/wire/wire_end.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus::emulation::feetech {

enum class Make : std::int64_t { sts3215, hls3625 };
constexpr auto enumerators(Make) {
  return std::array{Enumerator{Make::sts3215, "sts3215"}, Enumerator{Make::hls3625, "hls3625"}};
}

/// Emulated Feetech servos behind one line: a memory table each, whose lasting part is locked by register 55, numbers
/// with a sign bit, answers to single questions and sync reads. An HLS in mode 2 moves a simulated joint by its
/// current, keeps its last one for ever, and releases where that is beyond its protection current. In other modes, and
/// with an STS, the joint turns freely. It takes no time for its bytes: put `wire::Paced` around it.
///
/// Source: Feetech, memory tables of STS3215 and HLS.
class FeetechPeer final : public wire::WireEnd {
 public:
  static constexpr std::size_t most_servos = 16;

  struct Servo {
    std::int64_t id = 1;
    Make make = Make::hls3625;
    ServoFault fault = ServoFault::none;
    std::int64_t fault_from_ns =
        0;                   ///< after the first byte that the peer receives, where the fault is one that begins
    std::uint8_t error = 0;  ///< that `ServoFault::error` reports
  };
  struct Params {
    std::vector<Servo> servos{{.id = 1}, {.id = 2}};
    std::int64_t bits_per_s = 1'000'000;  ///< for the place that a servo without a reply leaves empty
    LineFaults line;
    std::int64_t seed = 1;
  };
  /// `out_of_bounds` for a number of servos or an id that cannot be.
  static Result<FeetechPeer> make(const Params& params);

  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override;
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override { return line_.say(now_ns); }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return line_.wakes_ns(); }

  // The truth, which no driver sees.
  [[nodiscard]] std::int64_t stored(std::size_t servo, std::size_t address, std::size_t bytes) const noexcept;
  ServoJoint& joint(std::size_t servo) noexcept { return servos_[servo].joint; }
  /// The largest current that it ever gave, in its units.
  [[nodiscard]] std::int64_t largest_current(std::size_t servo) const noexcept { return servos_[servo].largest; }
  /// Whether it gives torque if it is commanded to: register 40.
  [[nodiscard]] bool has_power(std::size_t servo) const noexcept;
  [[nodiscard]] std::size_t servos() const noexcept { return servos_.size(); }
  /// Gives servos a fault from now on, see `inject_into`.
  Check inject(const WrittenFault& fault, std::int64_t now_ns);
  /// Lets time pass where nothing is received.
  void advance(std::int64_t now_ns) noexcept;

 private:
  static constexpr std::size_t table_bytes = 87, lasting_bytes = 40;
  using Bytes = std::span<const std::uint8_t>;

  struct State {
    std::array<std::uint8_t, table_bytes> table{};
    std::array<std::uint8_t, lasting_bytes> lasting{};  ///< what is there again when power comes back
    ServoJoint joint;
    bool takes_current = false;
    ServoFault fault = ServoFault::none;
    std::int64_t fault_from_ns = 0;
    std::uint8_t error = 0;  ///< of that fault
    bool broke = false;
    std::int64_t off_until_ns = 0;
    std::int64_t largest = 0;
  };

  explicit FeetechPeer(const Params& params);
  static void boot(State& servo) noexcept;
  static void put(State& servo, std::size_t address, std::int64_t value) noexcept;
  static std::int64_t get(const State& servo, std::size_t address) noexcept;
  static std::int64_t current(const State& servo) noexcept;
  static void live(State& servo, std::int64_t now_ns) noexcept;
  static bool answers(const State& servo, std::int64_t now_ns) noexcept;
  static void write(State& servo, Bytes address_and_data, std::int64_t now_ns) noexcept;
  static std::int64_t delay_ns(const State& servo) noexcept;
  State* find(std::uint8_t id) noexcept;
  void packet_came(Bytes packet, std::int64_t now_ns) noexcept;
  void status(const State& servo, Bytes data, std::int64_t at_ns) noexcept;

  /// Whether it has this fault then.
  [[nodiscard]] static bool suffers(const State& servo, ServoFault fault, std::int64_t at_ns) noexcept {
    return servo.fault == fault && at_ns >= servo.fault_from_ns;
  }

  std::vector<State> servos_;
  std::int64_t bits_per_s_;
  ServoLine line_;
  std::array<std::uint8_t, 260> came_{};
  std::size_t came_size_ = 0;
  bool began_ = false;  ///< something was received
};

}  // namespace tactus::emulation::feetech
