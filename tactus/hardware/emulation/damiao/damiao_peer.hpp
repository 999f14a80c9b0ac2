// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/emulation/damiao/adapter.hpp>
#include <tactus/hardware/emulation/damiao/faults.hpp>
#include <tactus/hardware/emulation/damiao/motor.hpp>
#include <tactus/hardware/wire/outbox.hpp>
#include <tactus/hardware/wire/wire_end.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace tactus::emulation::damiao {

struct PeerSettings {
  AdapterType adapter = AdapterType::usb2can;
  std::vector<MotorSettings> motors;  ///< 1 to 15
  std::vector<Fault> faults;
  std::uint64_t seed = 1;
};

/// How long a frame of 8 bytes takes on a bus of 1 Mbit/s: every bit that the standard has, those that are stuffed
/// included, 111 to 135. With CAN FD and 5 Mbit/s for the data 66 µs, whatever its bits are.
std::int64_t frame_ns(const Frame& frame, bool flexible) noexcept;

/// Motors, their bus and an adapter, as a wire shows them to a driver: one frame on the bus at a time, the lowest
/// identifier first; a motor answers after 60 to 250 µs. Put `wire::Paced` around it where the adapter is serial.
///
/// It lives at the exact times, however late it is called. The same seed and the same bytes at the same times give the
/// same answers.
class DamiaoPeer final : public wire::WireEnd {
 public:
  /// With a mechanism, its motors are the first ones and turn together; the others each turn a joint of their own.
  /// Errors: `out_of_bounds` for the number of motors; `inconsistent` for fewer than the mechanism has.
  static Result<std::unique_ptr<DamiaoPeer>> make(const PeerSettings& settings,
                                                  std::unique_ptr<Mechanism> mechanism = nullptr);

  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override;
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override;
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override;

  /// Injects another fault. Its times count from now. Errors: `inconsistent` for a kind that motors or adapter have
  /// from the start or never: wrong-scale, wrap, heartbeat. Not real-time safe.
  Check inject(Fault fault, std::int64_t now_ns);
  /// Lets time pass where nothing is received, for who looks at the truth.
  void advance(std::int64_t now_ns) noexcept { live_until(now_ns); }
  /// As it was when the peer was last called.
  [[nodiscard]] const Motor& motor(std::size_t index) const noexcept { return motors_[index]; }

 private:
  /// A frame that waits for the bus.
  struct Waiting {
    Frame frame;
    int sender;  ///< -1: the adapter, else the motor
    std::int64_t ready_ns;
  };

  DamiaoPeer(const PeerSettings& settings, std::unique_ptr<Mechanism> mechanism);
  [[nodiscard]] bool suffers(FaultKind kind, std::uint32_t motor, std::int64_t at_ns) const noexcept;
  void live_until(std::int64_t now_ns) noexcept;
  void turn_together_until(std::int64_t now_ns) noexcept;
  [[nodiscard]] std::int64_t next_ns() const noexcept;
  [[nodiscard]] std::int64_t earliest_start_ns() const noexcept;
  void inject(std::int64_t at_ns) noexcept;
  void start_frame(std::int64_t at_ns) noexcept;
  void finish_frame() noexcept;
  void wait(const Frame& frame, int sender, std::int64_t ready_ns) noexcept;
  void tell(const Frame& frame, std::int64_t at_ns) noexcept;
  void tell_garbage(std::int64_t at_ns) noexcept;

  PeerSettings settings_;
  Adapter adapter_;
  signal::Random random_;
  std::vector<Motor> motors_;
  std::unique_ptr<Mechanism> mechanism_;
  std::vector<double> given_Nm_;       ///< by its motors
  std::int64_t turned_until_ns_ = -1;  ///< negative: not yet
  std::vector<Waiting> waiting_;       ///< in the order in which they were handed over
  wire::Outbox outbox_;
  bool bus_taken_ = false;
  Waiting on_bus_{};
  std::int64_t bus_free_ns_ = 0;
  std::int64_t start_ns_ = -1;
  std::int64_t heartbeat_ns_ = wire::never_ns;
};

}  // namespace tactus::emulation::damiao
