// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/emulation/servo_joint.hpp>
#include <tactus/hardware/emulation/servo_line.hpp>
#include <tactus/hardware/wire/wire_end.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactus::emulation::dynamixel {

/// Emulated Dynamixel servos of the X series behind one line, Protocol 2.0: a control table each, memory that is locked
/// while torque is on, answers after the return delay, the bus watchdog, errors of range, length and access, the alert
/// bit. Current mode moves a simulated joint; in other modes the joint turns freely. In a sync read the place of a
/// servo without a reply stays empty; in a fast one nobody answers behind it. Every run of the same bytes, times and
/// seed is the same. It takes no time for its bytes: put `wire::Paced` around it.
///
/// Source: ROBOTIS e-Manual, "DYNAMIXEL Protocol 2.0" and control tables of XL330, XC330 and XM430.
class DynamixelPeer final : public wire::WireEnd {
 public:
  static constexpr std::size_t most_servos = 16;

  struct Servo {
    std::int64_t id = 1;
    std::int64_t model_number = 1200;  ///< as its maker numbers it
    ServoFault fault = ServoFault::none;
    std::int64_t fault_from_ns =
        0;                   ///< after the first byte that the peer receives, where the fault is one that begins
    std::uint8_t error = 0;  ///< that `ServoFault::error` reports
  };
  struct Params {
    std::vector<Servo> servos{{.id = 1}, {.id = 2}};
    std::int64_t bits_per_s = 1'000'000;  ///< for the place that a servo without a reply leaves empty
    bool knows_fast_sync_read = true;     ///< as new firmware does
    LineFaults line;
    std::int64_t seed = 1;
  };
  /// `out_of_bounds` for a number of servos or an id that cannot be, `unknown_key` for a model number that it does not
  /// know.
  static Result<DynamixelPeer> make(const Params& params);

  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override;
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override { return line_.say(now_ns); }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return line_.wakes_ns(); }

  // The truth, which no driver sees.
  /// A register of so many bytes, as a number without sign.
  [[nodiscard]] std::int64_t stored(std::size_t servo, std::size_t address, std::size_t bytes) const noexcept;
  [[nodiscard]] const ServoJoint& joint(std::size_t servo) const noexcept { return servos_[servo].joint; }
  ServoJoint& joint(std::size_t servo) noexcept { return servos_[servo].joint; }
  /// The largest current that it ever gave, in its units; and how often it refused a goal without being able to report
  /// it.
  [[nodiscard]] std::int64_t largest_current(std::size_t servo) const noexcept { return servos_[servo].largest; }
  [[nodiscard]] std::int64_t lost_goals() const noexcept { return lost_goals_; }
  /// Whether it gives torque if it is commanded to: register 64, unless its watchdog has acted.
  [[nodiscard]] bool has_power(std::size_t servo) const noexcept;
  [[nodiscard]] std::size_t servos() const noexcept { return servos_.size(); }
  /// Gives servos a fault from now on, see `inject_into`.
  Check inject(const WrittenFault& fault, std::int64_t now_ns);
  /// Lets time pass where nothing is received, for who looks at the truth.
  void advance(std::int64_t now_ns) noexcept;

 private:
  static constexpr std::size_t table_bytes = 147;
  static constexpr std::size_t packet_bytes = 512;
  using Bytes = std::span<const std::uint8_t>;

  struct State {
    std::array<std::uint8_t, table_bytes> table{};
    ServoJoint joint;
    std::uint8_t id = 1;
    double current_torque_Nm = 0.0;  ///< of one unit of current
    ServoFault fault = ServoFault::none;
    std::int64_t fault_from_ns = 0;
    std::uint8_t error = 0;  ///< of that fault
    bool broke = false;      ///< the fault that happens once has happened
    std::int64_t off_until_ns = 0;
    std::int64_t largest = 0;
    std::int64_t lost_turns = 0;  ///< which it no longer counts, since it was without power
  };
  /// An answer that is being written.
  struct Packet {
    std::array<std::uint8_t, packet_bytes> bytes{};
    std::size_t size = 0;
    void put(std::uint8_t byte) noexcept { bytes[size++] = byte; }
    void put(Bytes more) noexcept {
      for (const std::uint8_t byte : more) put(byte);
    }
    void put_crc() noexcept;
  };

  explicit DynamixelPeer(const Params& params);
  void boot(State& servo) const noexcept;
  void put(State& servo, std::size_t address, std::size_t bytes, std::int64_t value) const noexcept;
  static std::int64_t get(const State& servo, std::size_t address, std::size_t bytes) noexcept;
  void live(State& servo, std::int64_t now_ns) noexcept;
  static std::int64_t current(const State& servo) noexcept;
  [[nodiscard]] bool answers(const State& servo, std::int64_t now_ns) const noexcept;

  void packet_came(std::int64_t now_ns) noexcept;
  void obey(State& servo, std::uint8_t instruction, Bytes parameters, bool whole, std::int64_t now_ns) noexcept;
  void sync_read(Bytes parameters, bool fast, std::int64_t now_ns) noexcept;
  void sync_write(Bytes parameters, std::int64_t now_ns) noexcept;
  [[nodiscard]] static std::uint8_t check_read(std::size_t address, std::size_t bytes) noexcept;
  std::uint8_t write(State& servo, std::size_t address, Bytes data, std::int64_t now_ns) const noexcept;
  void status(const State& servo, std::uint8_t error, Bytes data, std::int64_t at_ns) noexcept;
  [[nodiscard]] static std::int64_t delay_ns(const State& servo) noexcept;
  State* find(std::uint8_t id) noexcept;

  /// Whether it has this fault then.
  [[nodiscard]] static bool suffers(const State& servo, ServoFault fault, std::int64_t at_ns) noexcept {
    return servo.fault == fault && at_ns >= servo.fault_from_ns;
  }

  std::vector<State> servos_;
  std::int64_t bits_per_s_;
  bool knows_fast_sync_read_;
  ServoLine line_;
  std::array<std::uint8_t, packet_bytes> came_{};
  std::size_t came_size_ = 0;
  bool began_ = false;  ///< something was received
  bool in_packet_ = false;
  std::uint32_t last_four_ = 0;
  std::int64_t instruction_ns_ = 0;  ///< when the last one was received
  std::int64_t lost_goals_ = 0;
};

}  // namespace tactus::emulation::dynamixel
