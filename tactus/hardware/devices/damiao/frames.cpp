// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/damiao/frames.hpp>

#include <algorithm>

namespace tactus::devices::damiao {

namespace {

constexpr std::uint16_t everybody = 0x7ff;
constexpr std::uint8_t ask_feedback = 0xcc, read_code = 0x33, write_code = 0x55;

constexpr double steps(int bits) { return static_cast<double>((1 << bits) - 1); }

std::uint32_t code_of(double value, double lower, double upper, int bits) noexcept {
  return static_cast<std::uint32_t>((std::clamp(value, lower, upper) - lower) / (upper - lower) * steps(bits));
}

double value_of(std::uint32_t code, double scale, int bits) noexcept {
  return static_cast<double>(code) / steps(bits) * (2.0 * scale) - scale;
}

constexpr std::uint8_t byte_of(std::uint32_t value, int shift) { return static_cast<std::uint8_t>(value >> shift); }

CanFrame to_everybody(std::uint16_t motor, std::uint8_t code, std::uint8_t which, std::uint32_t value) noexcept {
  return {.id = everybody,
          .size = 8,
          .data = {byte_of(motor, 0), byte_of(motor, 8), code, which, byte_of(value, 0), byte_of(value, 8),
                   byte_of(value, 16), byte_of(value, 24)}};
}

/// Those that a motor has at all.
constexpr bool is_register(std::uint8_t which) {
  return which <= 36 || (which >= 50 && which <= 55) || which == 80 || which == 81;
}

}  // namespace

CanFrame mit_frame(std::uint16_t motor, const Scale& scale, const MitTarget& target) noexcept {
  const std::uint32_t p = code_of(target.position_rad, -scale.position_rad, scale.position_rad, 16);
  const std::uint32_t v = code_of(target.velocity_rad_per_s, -scale.velocity_rad_per_s, scale.velocity_rad_per_s, 12);
  const std::uint32_t kp = code_of(target.stiffness_Nm_per_rad, 0.0, largest_stiffness_Nm_per_rad, 12);
  const std::uint32_t kd = code_of(target.damping_Nms_per_rad, 0.0, largest_damping_Nms_per_rad, 12);
  const std::uint32_t t = code_of(target.torque_Nm, -scale.torque_Nm, scale.torque_Nm, 12);
  return {.id = motor,
          .size = 8,
          .data = {byte_of(p, 8), byte_of(p, 0), byte_of(v, 4), byte_of(v << 4 | kp >> 8, 0), byte_of(kp, 0),
                   byte_of(kd, 4), byte_of(kd << 4 | t >> 8, 0), byte_of(t, 0)}};
}

CanFrame order_frame(std::uint16_t motor, Order order) noexcept {
  CanFrame frame{.id = motor, .size = 8, .data = {}};
  frame.data.fill(0xff);
  frame.data[7] = static_cast<std::uint8_t>(order);
  return frame;
}

CanFrame refresh_frame(std::uint16_t motor) noexcept { return to_everybody(motor, ask_feedback, 0, 0); }

CanFrame read_frame(std::uint16_t motor, Register which) noexcept {
  return to_everybody(motor, read_code, static_cast<std::uint8_t>(which), 0);
}

CanFrame write_frame(std::uint16_t motor, Register which, std::uint32_t value) noexcept {
  return to_everybody(motor, write_code, static_cast<std::uint8_t>(which), value);
}

std::optional<Feedback> feedback_of(const CanFrame& frame, const Scale& scale) noexcept {
  if (frame.size != 8) return std::nullopt;
  const auto& d = frame.data;
  const std::uint32_t p = std::uint32_t{d[1]} << 8 | d[2], v = std::uint32_t{d[3]} << 4 | d[4] >> 4,
                      t = (d[4] & 0x0fU) << 8 | d[5];
  return Feedback{.status = byte_of(d[0], 4),
                  .motor = static_cast<std::uint8_t>(d[0] & 0x0f),
                  .position_rad = value_of(p, scale.position_rad, 16),
                  .velocity_rad_per_s = value_of(v, scale.velocity_rad_per_s, 12),
                  .torque_Nm = value_of(t, scale.torque_Nm, 12),
                  .drive_C = static_cast<double>(d[6]),
                  .winding_C = static_cast<double>(d[7])};
}

MotorFault fault_of(std::uint8_t status) noexcept {
  switch (status) {
    case status_disabled:
    case status_enabled:
      return MotorFault::none;
    case 0x8:
    case 0x9:
      return MotorFault::voltage;
    case 0xa:
      return MotorFault::current;
    case 0xb:
    case 0xc:
      return MotorFault::hot;
    case 0xd:
      return MotorFault::lost_master;
    case 0xe:
      return MotorFault::overload;
    default:
      return MotorFault::unknown_status;
  }
}

bool means_off(std::uint8_t status) noexcept {
  return status != status_enabled && fault_of(status) != MotorFault::unknown_status;
}

std::string status_text(std::int64_t status) {
  constexpr std::array<const char*, 16> names{"disabled",      "enabled",
                                              "unknown",       "unknown",
                                              "unknown",       "unknown",
                                              "unknown",       "unknown",
                                              "over-voltage",  "under-voltage",
                                              "over-current",  "drive too hot",
                                              "rotor too hot", "communication lost",
                                              "overload",      "unknown"};
  if (status < 0) return "no status";
  const auto number = static_cast<std::size_t>(status) % names.size();
  return std::string("status 0x") + "0123456789abcdef"[number] + " (" + names[number] + ")";
}

std::optional<RegisterAnswer> register_answer_of(const CanFrame& frame) noexcept {
  const auto& d = frame.data;
  if (frame.size != 8 || (d[2] != read_code && d[2] != write_code) || !is_register(d[3])) return std::nullopt;
  return RegisterAnswer{
      .motor = static_cast<std::uint16_t>(d[0] | d[1] << 8),
      .written = d[2] == write_code,
      .which = d[3],
      .value = d[4] | std::uint32_t{d[5]} << 8 | std::uint32_t{d[6]} << 16 | std::uint32_t{d[7]} << 24};
}

}  // namespace tactus::devices::damiao
