// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/damiao/motor.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace tactus::emulation::damiao {

namespace {

constexpr std::int64_t step_ns = 100'000;
constexpr double step_s = 1e-4;
constexpr std::int64_t timeout_unit_ns = 50'000;
constexpr std::uint8_t disabled = 0x0, enabled_status = 0x1, too_hot_drive = 0xb, too_hot_winding = 0xc, lost = 0xd;
constexpr std::uint8_t mst_id = 7, esc_id = 8, timeout = 9, ctrl_mode = 10, hw_version = 13, sw_version = 14,
                       pole_pairs = 16, gear = 20, p_max = 21, v_max = 22, t_max = 23, bit_rate = 35;

struct Limits {
  float p, v, t;
};

Limits limits_of(MotorType type) noexcept {
  switch (type) {
    case MotorType::dm3507:
      return {12.5F, 50.0F, 5.0F};
    case MotorType::dm4310:
      return {12.5F, 30.0F, 10.0F};
    case MotorType::dm4310_48v:
      return {12.5F, 50.0F, 10.0F};
    case MotorType::dm4340:
      return {12.5F, 10.0F, 28.0F};
    case MotorType::dm6006:
      return {12.5F, 45.0F, 20.0F};
    case MotorType::dm8006:
      return {12.5F, 45.0F, 40.0F};
    case MotorType::dm8009:
      return {12.5F, 45.0F, 54.0F};
    case MotorType::dm10010l:
      return {12.5F, 25.0F, 200.0F};
    case MotorType::dm10010:
      return {12.5F, 20.0F, 200.0F};
    case MotorType::dmh6215:
    case MotorType::dmg6220:
      return {12.5F, 45.0F, 10.0F};
  }
  return {};
}

/// The nearest code of a number between -end and end.
std::uint32_t code(double x, double end, std::uint32_t highest) noexcept {
  const double part = (std::clamp(x, -end, end) + end) / (2.0 * end);
  return static_cast<std::uint32_t>(std::lround(part * highest));
}

double number(std::uint32_t u, double lowest, double end, std::uint32_t highest) noexcept {
  return lowest + (end - lowest) * u / highest;
}

/// Between -end and end, as a counter shows what goes on beyond.
double wrapped(double x, double end) noexcept { return x - 2.0 * end * std::floor((x + end) / (2.0 * end)); }

}  // namespace

Motor::Motor(const MotorSettings& settings) noexcept
    : settings_(settings),
      position_rad_(settings.joint.position_rad),
      velocity_rad_per_s_(settings.joint.velocity_rad_per_s) {
  const Limits limits = limits_of(settings.type);
  slot(mst_id) = settings.feedback_id;
  slot(esc_id) = settings.id;
  slot(timeout) = 8000;
  slot(ctrl_mode) = 1;
  slot(hw_version) = 1;
  slot(sw_version) = 5013;
  slot(pole_pairs) = 14;
  slot(gear) = std::bit_cast<std::uint32_t>(10.0F);
  slot(p_max) = std::bit_cast<std::uint32_t>(limits.p);
  slot(v_max) = std::bit_cast<std::uint32_t>(limits.v);
  slot(t_max) = std::bit_cast<std::uint32_t>(limits.t);
  slot(bit_rate) = 4;
}

double Motor::real(std::uint8_t which) const noexcept {
  return static_cast<double>(std::bit_cast<float>(registers_[which]));
}

void Motor::scale_velocity(double factor) noexcept {
  slot(v_max) = std::bit_cast<std::uint32_t>(static_cast<float>(real(v_max) * factor));
}

void Motor::lose_power(std::int64_t now_ns) noexcept {
  constexpr std::int64_t off_ns = 300'000'000;
  constexpr double turn_rad = 2.0 * std::numbers::pi;
  if (off_until_ns_ >= 0) return;
  off_until_ns_ = now_ns + off_ns;
  status_ = disabled;
  const double lost_rad = turn_rad * std::round(position_rad_ / turn_rad);
  zero_rad_ += lost_rad;
  position_rad_ -= lost_rad;
}

void Motor::fail(std::uint8_t status, bool stays) noexcept {
  status_ = status;
  stays_ = stays;
}

std::optional<Frame> Motor::answer(const Frame& heard, std::int64_t now_ns) noexcept {
  live_until(now_ns);
  const std::uint32_t own = settings_.id;
  if (heard.id == 0x7ff) {
    if ((heard.bytes[0] | heard.bytes[1] << 8) != static_cast<int>(own)) return std::nullopt;
    spoken_to_ns_ = now_ns;
    return answer_to_everybody(heard);
  }
  // Position, velocity and force modes have the identifiers above; they are answered and not followed.
  const bool of_another_mode = heard.id == own + 0x100 || heard.id == own + 0x200 || heard.id == own + 0x300;
  if (heard.id != own && !of_another_mode) return std::nullopt;
  spoken_to_ns_ = now_ns;
  const bool order =
      std::all_of(heard.bytes.begin(), heard.bytes.begin() + 7, [](auto byte) { return byte == 0xff; }) &&
      heard.bytes[7] >= 0xfb && heard.bytes[7] <= 0xfe;
  if (order) {
    obey(heard);
  } else if (!of_another_mode) {
    follow(heard);
  }
  return feedback();
}

std::optional<Frame> Motor::answer_to_everybody(const Frame& heard) noexcept {
  const std::uint8_t what = heard.bytes[2], which = heard.bytes[3] & 0x7f;
  if (what == 0xcc) return feedback();
  if (what != 0x33 && what != 0x55 && what != 0xaa) return std::nullopt;
  if (what == 0x55) {
    slot(which) = heard.bytes[4] | static_cast<std::uint32_t>(heard.bytes[5]) << 8 |
                  static_cast<std::uint32_t>(heard.bytes[6]) << 16 | static_cast<std::uint32_t>(heard.bytes[7]) << 24;
  }
  Frame told{.id = slot(mst_id), .bytes = heard.bytes};
  if (what != 0xaa) {
    for (std::size_t i = 0; i < 4; ++i) told.bytes[4 + i] = static_cast<std::uint8_t>(slot(which) >> (8 * i));
  }
  return told;
}

Frame Motor::stray_answer() const noexcept {
  Frame told{.id = registers_[mst_id], .bytes = {static_cast<std::uint8_t>(settings_.id), 0, 0x33, p_max}};
  for (std::size_t i = 0; i < 4; ++i) told.bytes[4 + i] = static_cast<std::uint8_t>(registers_[p_max] >> (8 * i));
  return told;
}

void Motor::obey(const Frame& heard) noexcept {
  const bool faulty = status_ != disabled && status_ != enabled_status;
  switch (heard.bytes[7]) {
    case 0xfc:
      if (faulty) return;
      // Until it is told, it holds nothing.
      if (status_ == disabled) stiffness_ = damping_ = feedforward_Nm_ = 0.0;
      status_ = enabled_status;
      break;
    case 0xfd:
      if (!faulty && !ignores_disable_) status_ = disabled;
      break;
    case 0xfe:
      zero_rad_ += position_rad_;
      position_rad_ = 0.0;
      break;
    default:
      if (faulty && !stays_) status_ = disabled;
      break;
  }
}

void Motor::follow(const Frame& heard) noexcept {
  const auto& b = heard.bytes;
  if (status_ != enabled_status || slot(ctrl_mode) != 1) return;
  const auto u = [](int value) { return static_cast<std::uint32_t>(value); };
  aim_rad_ = number(u(b[0] << 8 | b[1]), -real(p_max), real(p_max), 65535);
  aim_rad_per_s_ = number(u(b[2] << 4 | b[3] >> 4), -real(v_max), real(v_max), 4095);
  stiffness_ = number(u((b[3] & 0xf) << 8 | b[4]), 0.0, 500.0, 4095);
  damping_ = number(u(b[5] << 4 | b[6] >> 4), 0.0, 5.0, 4095);
  feedforward_Nm_ = number(u((b[6] & 0xf) << 8 | b[7]), -real(t_max), real(t_max), 4095);
}

Frame Motor::feedback() const noexcept {
  const std::uint32_t p = code(wrapped(position_rad_, real(p_max)), real(p_max), 65535),
                      v = code(velocity_rad_per_s_, real(v_max), 4095), t = code(torque_Nm_, real(t_max), 4095);
  const auto byte = [](std::uint32_t value) { return static_cast<std::uint8_t>(value & 0xff); };
  return {.id = registers_[mst_id],
          .bytes = {byte(static_cast<std::uint32_t>(reported_.value_or(status_) << 4) | (settings_.id & 0xf)),
                    byte(p >> 8), byte(p), byte(v >> 4), byte((v & 0xf) << 4 | t >> 8), byte(t),
                    byte(status_ == too_hot_drive ? 121U : 30U), byte(status_ == too_hot_winding ? 111U : 28U)}};
}

void Motor::live_until(std::int64_t now_ns) noexcept {
  // What a process that was stopped for longer has missed is not made up for.
  constexpr std::int64_t most_ns = 10'000'000'000;
  if (now_ns_ < 0) now_ns_ = spoken_to_ns_ = now_ns;
  if (!alone_) return;
  now_ns_ = std::max(now_ns_, now_ns - most_ns);
  while (now_ns_ + step_ns <= now_ns) {
    now_ns_ += step_ns;
    step();
  }
}

double Motor::give(std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  const std::int64_t timeout_ns = static_cast<std::int64_t>(slot(timeout)) * timeout_unit_ns;
  if (enabled() && timeout_ns > 0 && now_ns_ - spoken_to_ns_ > timeout_ns) status_ = lost;
  torque_Nm_ = 0.0;
  if (enabled()) {
    const double end = real(t_max);
    const double law = stiffness_ * (aim_rad_ - wrapped(position_rad_, real(p_max))) +
                       damping_ * (aim_rad_per_s_ - velocity_rad_per_s_) + feedforward_Nm_;
    torque_Nm_ = std::clamp(law, -end, end);
  }
  least_torque_Nm_ = std::min(least_torque_Nm_, torque_Nm_);
  most_torque_Nm_ = std::max(most_torque_Nm_, torque_Nm_);
  return torque_Nm_;
}

void Motor::step() noexcept {
  give(now_ns_);
  // Implicit in both frictions: stable for every step, and a joint that should stick does.
  const JointParams& joint = settings_.joint;
  const double kick = torque_Nm_ / joint.inertia_kgm2 * step_s, hold = joint.friction_Nm / joint.inertia_kgm2 * step_s;
  const double free = (velocity_rad_per_s_ + kick) / (1.0 + joint.damping_Nms_per_rad / joint.inertia_kgm2 * step_s);
  velocity_rad_per_s_ = std::copysign(std::max(std::fabs(free) - hold, 0.0), free);
  position_rad_ += velocity_rad_per_s_ * step_s;
}

}  // namespace tactus::emulation::damiao
