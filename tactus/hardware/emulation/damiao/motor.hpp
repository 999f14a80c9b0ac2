// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

/// Damiao's motors and adapters as they answer, written from the protocol alone: no line of the driver is in here.
namespace tactus::emulation::damiao {

enum class MotorType : std::int64_t {
  dm3507,
  dm4310,
  dm4310_48v,
  dm4340,
  dm6006,
  dm8006,
  dm8009,
  dm10010l,
  dm10010,
  dmh6215,
  dmg6220
};
constexpr auto enumerators(MotorType) {
  return std::array{Enumerator{MotorType::dm3507, "DM3507"},         Enumerator{MotorType::dm4310, "DM4310"},
                    Enumerator{MotorType::dm4310_48v, "DM4310-48V"}, Enumerator{MotorType::dm4340, "DM4340"},
                    Enumerator{MotorType::dm6006, "DM6006"},         Enumerator{MotorType::dm8006, "DM8006"},
                    Enumerator{MotorType::dm8009, "DM8009"},         Enumerator{MotorType::dm10010l, "DM10010L"},
                    Enumerator{MotorType::dm10010, "DM10010"},       Enumerator{MotorType::dmh6215, "DMH6215"},
                    Enumerator{MotorType::dmg6220, "DMG6220"}};
}

/// Whoever's frame it is: 8 bytes with an identifier.
struct Frame {
  std::uint32_t id = 0;
  std::array<std::uint8_t, 8> bytes{};
};

/// What turns behind the gear. Units of its output.
struct JointParams {
  double inertia_kgm2 = 0.02;  ///< of rotor and arm
  double damping_Nms_per_rad = 0.02;
  double friction_Nm = 0.02;  ///< Coulomb's
  double position_rad = 0.0;  ///< at the start
  double velocity_rad_per_s = 0.0;
};

struct MotorSettings {
  std::uint32_t id = 1;
  std::uint32_t feedback_id = 0x11;
  MotorType type = MotorType::dm4310;
  JointParams joint{};
};

/// What several motors turn together, in place of a joint for each: an arm.
class Mechanism {
 public:
  virtual ~Mechanism() = default;
  /// How many motors it has, from the first on.
  [[nodiscard]] virtual std::size_t motors() const noexcept = 0;
  /// At the output of a motor's gear, as all here.
  [[nodiscard]] virtual double position_rad(std::size_t motor) const noexcept = 0;
  [[nodiscard]] virtual double velocity_rad_per_s(std::size_t motor) const noexcept = 0;
  /// 100 µs under these torques of its motors, in N m.
  virtual void step(std::span<const double> torque_Nm) noexcept = 0;
};

/// A motor and what it turns. It lives in steps of 100 µs, whenever somebody asks. Deterministic; does not allocate.
class Motor {
 public:
  explicit Motor(const MotorSettings& settings) noexcept;

  /// Its answer to a frame of the bus; none where the frame is not for it.
  std::optional<Frame> answer(const Frame& heard, std::int64_t now_ns) noexcept;
  /// A register answer nobody asked for.
  [[nodiscard]] Frame stray_answer() const noexcept;
  void live_until(std::int64_t now_ns) noexcept;

  /// Turns with others from now on, which the peer steps: at each step it gives a torque, in N m, and is turned to
  /// where that led. Where it was zeroed meanwhile, that stays its zero.
  void turn_with_others() noexcept { alone_ = false; }
  double give(std::int64_t now_ns) noexcept;
  void turn_to(double position_rad, double velocity_rad_per_s) noexcept {
    position_rad_ = position_rad - zero_rad_;
    velocity_rad_per_s_ = velocity_rad_per_s;
  }

  /// A fault, as a status of the protocol, which an order to clear takes away unless it `stays`.
  void fail(std::uint8_t status, bool stays) noexcept;
  void recover() noexcept { stays_ = false; }
  /// From now on its feedback has this status, whatever it does; none: its own.
  void report(std::optional<std::uint8_t> status) noexcept { reported_ = status; }
  /// Whether it keeps its power when it is commanded to disable.
  void ignore_disable(bool ignores) noexcept { ignores_disable_ = ignores; }
  /// It loses its power, once, for 0.3 s. It wakes disabled, within half a turn of its zero.
  void lose_power(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool is_off(std::int64_t now_ns) const noexcept { return now_ns < off_until_ns_; }
  /// A motor whose velocity register is not that of its type.
  void scale_velocity(double factor) noexcept;

  [[nodiscard]] std::uint8_t status() const noexcept { return status_; }
  [[nodiscard]] bool enabled() const noexcept { return status_ == 1; }
  [[nodiscard]] double position_rad() const noexcept { return position_rad_; }
  [[nodiscard]] double velocity_rad_per_s() const noexcept { return velocity_rad_per_s_; }
  /// That it gives now, and the ends of what it gave so far.
  [[nodiscard]] double torque_Nm() const noexcept { return torque_Nm_; }
  [[nodiscard]] double least_torque_Nm() const noexcept { return least_torque_Nm_; }
  [[nodiscard]] double most_torque_Nm() const noexcept { return most_torque_Nm_; }
  [[nodiscard]] const MotorSettings& settings() const noexcept { return settings_; }

 private:
  /// By its number, in bits.
  [[nodiscard]] std::uint32_t& slot(std::uint8_t which) noexcept { return registers_[which & 0x7fU]; }
  [[nodiscard]] double real(std::uint8_t which) const noexcept;
  [[nodiscard]] Frame feedback() const noexcept;
  [[nodiscard]] std::optional<Frame> answer_to_everybody(const Frame& heard) noexcept;
  void obey(const Frame& heard) noexcept;
  void follow(const Frame& heard) noexcept;
  void step() noexcept;

  MotorSettings settings_;
  std::array<std::uint32_t, 128> registers_{};
  std::uint8_t status_ = 0;
  bool alone_ = true;
  double zero_rad_ = 0.0;  ///< of one that turns with others
  bool stays_ = false;     ///< its fault, whatever it receives
  bool ignores_disable_ = false;
  std::int64_t off_until_ns_ = -1;                ///< negative: it never lost its power
  std::optional<std::uint8_t> reported_;          ///< in place of its status
  std::int64_t now_ns_ = -1, spoken_to_ns_ = -1;  ///< negative: not yet
  double aim_rad_ = 0.0, aim_rad_per_s_ = 0.0, stiffness_ = 0.0, damping_ = 0.0, feedforward_Nm_ = 0.0;
  double position_rad_, velocity_rad_per_s_, torque_Nm_ = 0.0;
  double least_torque_Nm_ = 0.0, most_torque_Nm_ = 0.0;
};

}  // namespace tactus::emulation::damiao
