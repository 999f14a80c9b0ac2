// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/feetech/packet.hpp>
#include <tactus/hardware/devices/servo/servo_bus.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace tactus::devices::feetech {

enum class FeetechModel : std::int64_t { sts3215, sts3250, hls3625 };
constexpr auto enumerators(FeetechModel) {
  return std::array{Enumerator{FeetechModel::sts3215, "sts3215"}, Enumerator{FeetechModel::sts3250, "sts3250"},
                    Enumerator{FeetechModel::hls3625, "hls3625"}};
}

/// That a servo can be set to.
inline constexpr std::array<std::int64_t, 8> bit_rates{38'400,  57'600,  76'800,  115'200,
                                                       128'000, 250'000, 500'000, 1'000'000};
/// Of an HLS the torque of a current is stated by who has it.
const ServoModel& servo_model(FeetechModel model) noexcept;

/// Feetech servos behind one serial line: STS as the leader of an arm, HLS with a constant current.
///
/// **STS3215 and STS3250 give no force.** They take positions, not currents, so a torque that is commanded of one is
/// not sent and a command for power is not obeyed: it turns freely, reports where it is, and `enabled` stays 0. Its
/// `torque_Nm` is 0, for what it calls load is the duty of its bridge.
///
/// HLS runs in mode 2, constant current. Its limit is read from its protection current and kept to here. **It has no
/// watchdog**: where this program dies without a word, the last current stays. Whoever gives it power needs somebody
/// else who takes it away.
///
/// A cycle is a sync write of currents to those that take one, and a sync read of all. An adapter that sends back what
/// it was sent is noticed when the model numbers are asked for. Not tried on hardware; the numbers of HLS are from a
/// copy of its maker's table.
class FeetechBus final : public ServoBus {
 public:
  struct Motor {
    std::int64_t id = 1;
    FeetechModel model = FeetechModel::sts3215;
    double torque_Nm_per_A = 0.0;  ///< of an HLS: no page states it. Measure it, or stall torque over stall current
  };
  struct Params {
    std::vector<Motor> motors;
    std::int64_t bits_per_s = 1'000'000;  ///< as register 6 of each servo reports
  };
  /// `out_of_bounds` for a number of motors, an id, a bit rate or a torque that cannot be; `missing` for the torque of
  /// an HLS; `inconsistent` for an id twice.
  static Result<FeetechBus> make(const Params& params);

 private:
  FeetechBus(const Params& params);

  void find(std::span<const std::uint8_t> bytes) noexcept override;
  void give_up() noexcept override;
  ServoPacket read(std::uint8_t id, Register place) noexcept override;
  ServoPacket write(std::uint8_t id, Register place, std::int64_t value) noexcept override;
  ServoPacket write_all(Register place, std::span<const std::int64_t> values, Whom whom) const noexcept override;
  [[nodiscard]] bool knows_refusal(std::uint8_t refusal) const noexcept override;
  ServoPacket read_states() noexcept override;
  void read_ended(bool) noexcept override {}
  [[nodiscard]] std::size_t answer_bytes(std::size_t data) const noexcept override;
  [[nodiscard]] std::size_t states_bytes() const noexcept override;
  bool read_state(std::size_t motor, std::span<const std::uint8_t> data, State& state) const noexcept override;
  Wrong check(std::size_t motor, Register place, std::int64_t value) noexcept override;
  void looked(std::size_t motor, Register place, std::int64_t value) noexcept override;
  [[nodiscard]] std::string model_named(std::int64_t number) const override;
  void take(std::span<const std::uint8_t> packet) noexcept;

  PacketFinder<PacketFormat> finder_;
  Register present_;      ///< with the current, where one takes a current
  ServoPacket question_;  ///< to one servo, as it was sent
  bool question_is_model_ = false;
  bool echo_due_ = false;  ///< of that question
  bool echoes_ = false;    ///< the adapter sends back what it was sent
};

}  // namespace tactus::devices::feetech
