// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/dynamixel/packet.hpp>
#include <tactus/hardware/devices/servo/servo_bus.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tactus::devices::dynamixel {

/// Servos of the X series that take a current.
enum class DynamixelModel : std::int64_t { xl330_m077, xl330_m288, xc330_m288, xc330_t288, xm430_w210, xm430_w350 };
constexpr auto enumerators(DynamixelModel) {
  return std::array{
      Enumerator{DynamixelModel::xl330_m077, "xl330-m077"}, Enumerator{DynamixelModel::xl330_m288, "xl330-m288"},
      Enumerator{DynamixelModel::xc330_m288, "xc330-m288"}, Enumerator{DynamixelModel::xc330_t288, "xc330-t288"},
      Enumerator{DynamixelModel::xm430_w210, "xm430-w210"}, Enumerator{DynamixelModel::xm430_w350, "xm430-w350"}};
}
/// That a servo can be set to.
inline constexpr std::array<std::int64_t, 7> bit_rates{9600,      57'600,    115'200,  1'000'000,
                                                       2'000'000, 3'000'000, 4'000'000};
/// Model numbers, units and limits are the e-Manual's. The torque of a current is that of stall, but for XC330-T288 and
/// XM430-W210, where it is what GELLO and FACTR use. A gear of 77 to 350 : 1 rubs: what reaches the hand is less.
const ServoModel& servo_model(DynamixelModel model) noexcept;

/// Dynamixel servos in current mode behind one serial line, Protocol 2.0.
///
/// Each is read for model number and current limit, loses its torque, and gets return delay 0 and current mode where it
/// has another (both are in memory that wears out). One that is given power gets bus watchdog 5 first: 100 ms without
/// any packet, and it releases its force by itself, whatever became of this program. A cycle is a sync write of goal
/// currents and a fast sync read of current, velocity and position. In a fast read those behind a servo without a reply
/// do not reply either; so after one that was not whole, plain sync reads follow, until all answered a thousand times
/// in a row.
///
/// A servo drops a goal beyond its limit without a word. So the limit is read from it and kept to here. Not tried on
/// hardware.
class DynamixelBus final : public ServoBus {
 public:
  struct Motor {
    std::int64_t id = 1;
    DynamixelModel model = DynamixelModel::xl330_m288;
  };
  struct Params {
    std::vector<Motor> motors;
    std::int64_t bits_per_s = 1'000'000;  ///< as register 8 of each servo reports
    bool fast_sync_read = true;           ///< firmware from 45 (X430) respectively 46 (X330) on knows it
  };
  /// `out_of_bounds` for a number of motors, an id or a bit rate that cannot be; `inconsistent` for an id twice.
  static Result<DynamixelBus> make(const Params& params);

 private:
  DynamixelBus(const Params& params);

  void find(std::span<const std::uint8_t> bytes) noexcept override;
  void give_up() noexcept override;
  ServoPacket read(std::uint8_t id, Register place) noexcept override;
  ServoPacket write(std::uint8_t id, Register place, std::int64_t value) noexcept override;
  ServoPacket write_all(Register place, std::span<const std::int64_t> values, Whom whom) const noexcept override;
  [[nodiscard]] bool knows_refusal(std::uint8_t refusal) const noexcept override;
  ServoPacket read_states() noexcept override;
  void read_ended(bool all_answered) noexcept override;
  [[nodiscard]] std::size_t answer_bytes(std::size_t data) const noexcept override;
  [[nodiscard]] std::size_t states_bytes() const noexcept override;
  bool read_state(std::size_t motor, std::span<const std::uint8_t> data, State& state) const noexcept override;
  Wrong check(std::size_t motor, Register place, std::int64_t value) noexcept override;
  void looked(std::size_t motor, Register place, std::int64_t value) noexcept override;
  [[nodiscard]] std::string model_named(std::int64_t number) const override;
  void take(std::span<const std::uint8_t> packet) noexcept;

  PacketFinder<PacketFormat> finder_;
  bool fast_;
  std::int64_t plain_left_ = 0;  ///< cycles with plain reads before a fast one is tried again
};

}  // namespace tactus::devices::dynamixel
