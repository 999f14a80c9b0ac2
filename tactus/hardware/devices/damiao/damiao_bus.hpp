// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/damiao/framing.hpp>
#include <tactus/hardware/devices/damiao/questions.hpp>
#include <tactus/hardware/devices/motor_bus.hpp>
#include <tactus/hardware/devices/off_watch.hpp>
#include <tactus/hardware/wire/outbox.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace tactus::devices::damiao {

struct DamiaoBusParams {
  Framing framing = Framing::usb2can;
  double watchdog_s = 0.05;
  double reply_timeout_s = 0.002;
  double shortest_cycle_s = 0.0005;
  std::vector<MotorParams> motors;  ///< 1 to 15

  static constexpr auto fields() {
    return List{field("framing", &DamiaoBusParams::framing, "How frames of CAN become bytes."),
                field("watchdog_s", &DamiaoBusParams::watchdog_s, units::second, between(0.002, 1.0),
                      "A motor that receives no command for this time disables itself: its register TIMEOUT, set "
                      "before it gets power. A motor "
                      "without a reply for this time is not responding."),
                field("reply_timeout_s", &DamiaoBusParams::reply_timeout_s, units::second, between(0.0002, 0.05),
                      "The longest wait for the next answer of a cycle."),
                field("shortest_cycle_s", &DamiaoBusParams::shortest_cycle_s, units::second, between(0.0001, 0.1),
                      "A cycle takes at least that, where the wire allows more.")};
  }
};

/// Damiao motors behind one adapter, driven by torque and by the law that each runs by itself.
///
/// At first each motor is switched off and asked: identifier of its feedback, scales, firmware, mode, watchdog. One
/// that differs from the parameters makes the bus `refused`. Then each cycle sends one frame to every motor at once,
/// each of which is answered by feedback, and ends when all have answered or the next one keeps it waiting too long.
///
/// Power: a motor gets it when its command asks for it again; a fault from before is cleared first. A fault or a status
/// that is not known under power, no answer for longer than its own watchdog waits, or power lost without being asked
/// latch its fault: it is switched off and stays so until the command asks again.
///
/// Off: a motor that is to have no power is sent `disable` in every cycle until it has reported three times in a row
/// that it is off; only then is it asked by `refresh`. One that does not within 0.1 s has the fault `stays_on` for good
/// if it answers, and is then sent `disable` only at times that are farther apart than its own watchdog waits, so that
/// this may take its power.
///
/// One that did not respond for so long that it could have turned by half the
/// range of its number has the fault `encoder` for good. A motor that missed three cycles is asked rarely, with the
/// same command, so that it costs the others nothing; a stall of the machine ends as it began.
///
/// Law: position, velocity and gains go with the torque, each cut to the next code of the frame below, which takes up
/// to a step of position times the stiffness from the torque. A motor knows nothing of the turns that its number does
/// not show: one that is to hold a position and comes near to where its number restarts would take the whole range
/// for its way, so it loses its power before, with the fault `encoder` for good.
class DamiaoBus final : public MotorBus {
 public:
  /// Errors: parameters outside their bounds; motors with the same identifier, or with one that commands have.
  static Result<std::unique_ptr<DamiaoBus>> make(const DamiaoBusParams& params);

  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override;
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override;
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override;

  [[nodiscard]] std::size_t motors() const noexcept override { return motors_.size(); }
  [[nodiscard]] BusState state() const noexcept override { return state_; }
  [[nodiscard]] Check problem() const override;
  [[nodiscard]] MotorSheet sheet(std::size_t motor) const override;
  [[nodiscard]] const MotorReading& reading(std::size_t motor) const noexcept override;
  void command(std::size_t motor, const MotorCommand& wanted) noexcept override;
  [[nodiscard]] std::int64_t cycles() const noexcept override { return cycles_; }

  /// What a motor reported of itself; complete unless the bus is still `asking`.
  [[nodiscard]] const MotorFacts& facts(std::size_t motor) const noexcept { return motors_[motor].questions.facts(); }

 private:
  struct Motor {
    MotorParams params;
    Scale scale;
    Questions questions;
    MotorReading reading;
    MotorCommand command;
    OffWatch off;
    MotorFault latched = MotorFault::none;
    bool was_wanted = false;
    bool had_power = false;           ///< since it was wanted
    int tries = 0;                    ///< to clear and to enable, since it was wanted
    int owed = 0;                     ///< answers
    int missed = 0;                   ///< cycles without an answer, one after the other
    std::int64_t asked_again_ns = 0;  ///< when it did not respond
    double turns = 0.0;               ///< of its number, each of twice its scale
    double wrapped_rad = 0.0;
  };

  explicit DamiaoBus(const DamiaoBusParams& params);
  void send(const CanFrame& frame, std::int64_t now_ns) noexcept;
  void ask(std::int64_t now_ns) noexcept;
  void take(const CanFrame& frame, std::int64_t now_ns) noexcept;
  void take_feedback(Motor& motor, const CanFrame& frame, std::int64_t now_ns) noexcept;
  /// So that the others do not wait for it.
  [[nodiscard]] static bool is_absent(const Motor& motor) noexcept;
  [[nodiscard]] bool is_silent(const Motor& motor, std::int64_t now_ns) const noexcept;
  void judge(Motor& motor, std::int64_t now_ns) noexcept;
  void begin_cycle(std::int64_t now_ns) noexcept;
  void end_cycle(std::int64_t now_ns) noexcept;
  [[nodiscard]] bool all_answered() const noexcept;
  [[nodiscard]] bool drives(Motor& motor, std::int64_t now_ns) const noexcept;
  [[nodiscard]] static CanFrame frame_that_drives(Motor& motor) noexcept;
  [[nodiscard]] static CanFrame frame_that_stops(Motor& motor, std::int64_t now_ns) noexcept;

  Framing framing_;
  std::int64_t reply_timeout_ns_, shortest_cycle_ns_, silence_ns_, ask_absent_ns_, rest_ns_;
  FrameReader reader_;
  wire::Outbox outbox_;
  std::vector<Motor> motors_;
  BusState state_ = BusState::asking;
  bool opened_ = false;
  std::size_t asked_ = 0;
  bool in_cycle_ = false;
  std::int64_t cycle_began_ns_ = 0, progress_ns_ = 0;
  std::int64_t cycles_ = 0;
};

}  // namespace tactus::devices::damiao
