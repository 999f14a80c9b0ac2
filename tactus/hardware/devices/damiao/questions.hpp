// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/damiao/frames.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace tactus::devices::damiao {

/// A motor as somebody states it.
struct MotorParams {
  std::int64_t id = 1;              ///< 1 to 15: the register ESC_ID
  std::int64_t feedback_id = 0x11;  ///< the register MST_ID; by convention `id` + 16
  Model model = Model::dm4310;
};

/// What a motor reported of itself. NaN and negative numbers: not reported.
struct MotorFacts {
  std::int64_t feedback_id = -1;
  double position_scale_rad = std::numeric_limits<double>::quiet_NaN();
  double velocity_scale_rad_per_s = std::numeric_limits<double>::quiet_NaN();
  double torque_scale_Nm = std::numeric_limits<double>::quiet_NaN();
  std::int64_t software_version = -1;
  std::int64_t control_mode = -1;  ///< 1: MIT
  std::int64_t timeout = -1;       ///< 50 µs each
};

/// Asks one motor, one thing after the other, and compares: first it is switched off, which it has to report, then its
/// registers are read, then mode and watchdog are set, until it loses its power. What is not answered is asked again,
/// five times in all. Real-time safe but for `problem`. Drives nothing by itself.
class Questions {
 public:
  Questions(const MotorParams& stated, std::uint32_t timeout) noexcept : stated_(stated), wanted_timeout_(timeout) {}

  [[nodiscard]] bool done() const noexcept { return at_ == steps.size(); }
  /// What to send now; none while an answer may still come, and where all is done.
  std::optional<CanFrame> next(std::int64_t now_ns) noexcept;
  /// When `next` has something where no answer comes before.
  [[nodiscard]] std::int64_t wakes_ns() const noexcept { return deadline_ns_; }
  /// Whether the frame was of this motor.
  bool take(const CanFrame& frame) noexcept;

  [[nodiscard]] const MotorFacts& facts() const noexcept { return facts_; }
  /// The models with the scales that it reported, where the stated one is not one of them; empty where it is, and where
  /// no model has them. Not real-time safe.
  [[nodiscard]] std::string model_told() const;
  /// The first thing that is wrong, with the remedy. Not real-time safe.
  [[nodiscard]] Check problem() const;
  [[nodiscard]] bool is_well() const noexcept { return wrong_ == Wrong::nothing; }

 private:
  enum class What { disable, read, write };
  struct Step {
    What what;
    Register which;
  };
  static constexpr std::array steps{
      Step{What::disable, Register::motor_id},    Step{What::read, Register::feedback_id},
      Step{What::read, Register::position_scale}, Step{What::read, Register::velocity_scale},
      Step{What::read, Register::torque_scale},   Step{What::read, Register::software_version},
      Step{What::write, Register::control_mode},  Step{What::write, Register::timeout}};
  enum class Wrong { nothing, silent, stays_on, twice, feedback_id, scale, written };

  [[nodiscard]] double scale_stated(Register which) const noexcept;
  [[nodiscard]] std::uint32_t wanted(Register which) const noexcept;
  void note(Register which, std::uint32_t value) noexcept;
  void blame(Wrong wrong, Register which, double found, double expected) noexcept;
  void go_on() noexcept;

  MotorParams stated_;
  std::uint32_t wanted_timeout_;
  std::size_t at_ = 0;
  int tries_ = 0;
  bool asked_once_ = false;  ///< the step before this one
  int on_status_ = -1;       ///< that it reported when it was commanded to switch off; negative: none that is not off
  std::int64_t deadline_ns_ = 0;
  MotorFacts facts_;
  Wrong wrong_ = Wrong::nothing;
  Register which_ = Register::motor_id;  ///< that is wrong
  double found_ = 0.0, expected_ = 0.0;
};

}  // namespace tactus::devices::damiao
