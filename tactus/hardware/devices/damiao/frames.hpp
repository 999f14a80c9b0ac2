// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/damiao/models.hpp>
#include <tactus/hardware/devices/motor_bus.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>

/// Commands to Damiao's motors and their replies, in frames of CAN. Source: the maker's protocol, as openarm_can,
/// i2rt, lerobot and python-damiao-driver speak it. Real-time safe.
namespace tactus::devices::damiao {

/// A frame of CAN 2.0A: an identifier of 11 bits and up to 8 bytes.
struct CanFrame {
  std::uint16_t id = 0;
  std::uint8_t size = 8;
  std::array<std::uint8_t, 8> data{};
  bool operator==(const CanFrame&) const = default;
};

/// What a motor takes by itself at the rate of its current loop:
/// stiffness·(position − its own) + damping·(velocity − its own) + torque.
struct MitTarget {
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double stiffness_Nm_per_rad = 0.0;  ///< 0 to 500
  double damping_Nms_per_rad = 0.0;   ///< 0 to 5
  double torque_Nm = 0.0;
};

/// Numbers beyond the scale are brought to its ends; all are cut to the next code below, as the maker does. Zero has no
/// code: it is sent as half a step below.
CanFrame mit_frame(std::uint16_t motor, const Scale& scale, const MitTarget& target) noexcept;

enum class Order : std::uint8_t { clear_fault = 0xfb, enable = 0xfc, disable = 0xfd, set_zero = 0xfe };
CanFrame order_frame(std::uint16_t motor, Order order) noexcept;
/// Asks for feedback and commands nothing.
CanFrame refresh_frame(std::uint16_t motor) noexcept;

/// The registers that this driver looks at.
enum class Register : std::uint8_t {
  feedback_id = 7,
  motor_id = 8,
  timeout = 9,  ///< 50 µs each; 0: never
  control_mode = 10,
  software_version = 14,
  position_scale = 21,
  velocity_scale = 22,
  torque_scale = 23
};
constexpr bool is_number(Register which) { return which >= Register::position_scale; }
inline constexpr std::uint32_t mit_mode = 1;

CanFrame read_frame(std::uint16_t motor, Register which) noexcept;
/// Until the motor loses its power; `value` as the bits of it.
CanFrame write_frame(std::uint16_t motor, Register which, std::uint32_t value) noexcept;

/// What a motor reports after every frame to it.
struct Feedback {
  std::uint8_t status = 0;
  std::uint8_t motor = 0;  ///< the low four bits of its identifier
  double position_rad = 0.0;
  double velocity_rad_per_s = 0.0;
  double torque_Nm = 0.0;  ///< from its current
  double drive_C = 0.0;
  double winding_C = 0.0;
};
/// None where a frame has not 8 bytes.
std::optional<Feedback> feedback_of(const CanFrame& frame, const Scale& scale) noexcept;

inline constexpr std::uint8_t status_disabled = 0, status_enabled = 1;
/// What a status means; one that the protocol does not have is an `unknown_status`.
MotorFault fault_of(std::uint8_t status) noexcept;
/// Whether a motor with this status has no power: disabled, or a fault of the protocol, which disables it. A status
/// that the protocol does not have counts as power.
bool means_off(std::uint8_t status) noexcept;
/// `status 0x7 (unknown)`, for a user; `no status` where that is negative. Not real-time safe.
std::string status_text(std::int64_t status);

struct RegisterAnswer {
  std::uint16_t motor = 0;
  bool written = false;  ///< the answer to a write
  std::uint8_t which = 0;
  std::uint32_t value = 0;  ///< the bits of it
};
/// None where it cannot be one. It has the identifier of feedback, and feedback of a motor without power can look like
/// it, where position and velocity are near the end of their scale; a register that no motor has excludes most of
/// those.
std::optional<RegisterAnswer> register_answer_of(const CanFrame& frame) noexcept;

}  // namespace tactus::devices::damiao
