// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_bus.hpp>
#include <tactus/hardware/devices/off_watch.hpp>
#include <tactus/hardware/devices/servo/servo_packet.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

namespace tactus::devices {

/// A servo as its maker built it.
struct ServoModel {
  const char* name;
  std::int64_t number;         ///< that it reports of itself; 0 where no page reports it, and then it is not compared
  double current_unit_A;       ///< of its goal and its present current
  std::int64_t current_limit;  ///< the largest goal that it can be set to take, in units; 0: it takes no current
  double torque_Nm_per_A;      ///< at the output; friction of the gear is not in it
  double velocity_unit_rad_per_s;
};

/// Some bytes of a servo's control table.
struct Register {
  std::uint16_t address;
  std::uint8_t bytes;
};

/// What is done with a register of a servo before it has power.
struct ServoStep {
  enum class Kind : std::uint8_t {
    check,  ///< read, and judged by the driver of the make
    keep,   ///< read, and written only where it differs: its memory wears out
    write
  } kind;
  Register place;
  std::int64_t value;
};

/// How servos of one make are spoken to.
struct ServoTable {
  std::span<const ServoStep> hush;      ///< written to all at once before anything is asked; nobody answers
  std::span<const ServoStep> enabling;  ///< for each servo, when it is given power; only writes
  std::span<const Register>
      looks;              ///< read of a servo after its alert, the first, which reports its error, or a silence, all
  std::size_t announced;  ///< of these: the others are also read now and then, of one servo at a time
  Register power, goal;
  std::int64_t steps_per_turn;
  std::int64_t steps_until_wrap;  ///< of the position on the wire
  std::int64_t silence_ns;        ///< after that long without an answer a servo does not respond
  std::int64_t rest_ns;           ///< longer than the servo's own watchdog waits for any packet; 0: no watchdog
};

/// The status of a servo in one number (`MotorReading::status`): the error byte of its last answer, its error register
/// and its register of power as they were read last.
struct ServoStatus {
  std::uint8_t error = 0, condition = 0, power = 0;
  [[nodiscard]] std::int64_t number() const noexcept { return error | condition << 8 | power << 16; }
  static ServoStatus of(std::int64_t number) noexcept {
    return {static_cast<std::uint8_t>(number & 0xff), static_cast<std::uint8_t>(number >> 8 & 0xff),
            static_cast<std::uint8_t>(number >> 16 & 0xff)};
  }
};
/// `error byte 0x24, error register 0x20, torque enable 1`, for a user; `no status` where that is negative. Not
/// real-time safe.
std::string servo_status_text(std::int64_t status);

/// The bus of servos on one half-duplex line: what is the same whatever their make. A cycle is one packet with the
/// goals of all, one that asks all for their state, and their answers; now and then one question to one servo is
/// between two cycles. A make gives its packets and its table.
///
/// A fault takes the power of its servo until a command asks for none and the cause is gone; it does not come back by
/// itself. An error byte or an error register that no page explains is a fault (`unknown_status`).
///
/// A servo that is to have no power is commanded so in every cycle, in one packet for all of them, whether it answers
/// or not, until its register of power reads 0. One that does not within 0.1 s has the fault `stays_on` for good; where
/// no servo is to have power and servos have a watchdog, the bus then sends nothing for longer than that waits, again
/// and again.
///
/// Real-time safe but for `problem` and `sheet`.
class ServoBus : public MotorBus {
 public:
  static constexpr std::size_t most_servos = 16;

  [[nodiscard]] std::size_t motors() const noexcept final { return count_; }
  [[nodiscard]] BusState state() const noexcept final { return state_; }
  [[nodiscard]] Check problem() const final;
  [[nodiscard]] MotorSheet sheet(std::size_t motor) const final;
  [[nodiscard]] const MotorReading& reading(std::size_t motor) const noexcept final { return servos_[motor].reading; }
  void command(std::size_t motor, const MotorCommand& wanted) noexcept final;
  [[nodiscard]] std::int64_t cycles() const noexcept final { return cycles_; }
  /// Commands that were beyond a servo's limit, and were sent as the limit.
  [[nodiscard]] std::int64_t limited() const noexcept { return limited_; }

  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept final;
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept final;
  [[nodiscard]] std::int64_t wakes_ns() const noexcept final;

 protected:
  /// What came from a servo.
  struct Answer {
    std::uint8_t id;
    std::uint8_t error;    ///< as on the wire
    bool alert;            ///< something is wrong with the servo
    std::uint8_t refusal;  ///< what was wrong with the question; 0: nothing
    std::span<const std::uint8_t> data;
  };
  /// A servo's state, in the units of the wire.
  struct State {
    std::int64_t current, velocity, position;
    double temperature_C;  ///< NaN: not reported
  };
  /// What was found while asking.
  enum class Wrong : std::uint8_t { nothing, silent, garbled, twice, model, limit, refused, stays_on };

  ServoBus(const ServoTable& table, std::int64_t bits_per_s) : table_(table), bits_per_s_(bits_per_s) {}
  /// Before anything is sent, with what it is asked before the bus is ready. At most `most_servos`.
  void add(std::uint8_t id, const ServoModel& model, std::span<const ServoStep> asking);

  [[nodiscard]] const ServoModel& model(std::size_t motor) const noexcept { return servos_[motor].model; }
  [[nodiscard]] std::uint8_t id(std::size_t motor) const noexcept { return servos_[motor].id; }
  /// Whose state is asked for in this cycle: of all but those that did not respond a moment ago.
  [[nodiscard]] std::span<const std::uint8_t> asked() const noexcept { return {asked_ids_.data(), asked_count_}; }
  /// Only where the servo's own limit is narrower than its model's.
  void limit(std::size_t motor, std::int64_t current) noexcept { servos_[motor].limit = current; }
  /// What ails a servo, by its registers; `none` where nothing does any more.
  void ails(std::size_t motor, MotorFault fault) noexcept;
  /// It has power no more, or gives no force for its power, though nothing ails it.
  void lost_power(std::size_t motor, MotorFault fault) noexcept;
  void set_temperature(std::size_t motor, double celsius) noexcept { servos_[motor].reading.temperature_C = celsius; }
  void set_condition(std::size_t motor, std::int64_t value) noexcept {
    servos_[motor].status.condition = static_cast<std::uint8_t>(value);
  }
  void set_firmware(std::size_t motor, std::int64_t version) noexcept { servos_[motor].firmware = version; }
  /// Whether it reported that it has.
  [[nodiscard]] bool has_power(std::size_t motor) const noexcept { return servos_[motor].reading.enabled != 0; }
  void heard(const Answer& answer) noexcept;

  // Of the make.
  /// Each answer that is whole in the bytes goes to `heard`.
  virtual void find(std::span<const std::uint8_t> bytes) noexcept = 0;
  /// The answer that began does not end.
  virtual void give_up() noexcept = 0;
  virtual ServoPacket read(std::uint8_t id, Register place) noexcept = 0;
  virtual ServoPacket write(std::uint8_t id, Register place, std::int64_t value) noexcept = 0;
  /// Servo 0 is bit 0.
  using Whom = std::uint32_t;
  static constexpr Whom everybody = ~Whom{0};
  /// The value of each of these servos, but for those that take no goal; empty where none does.
  virtual ServoPacket write_all(Register place, std::span<const std::int64_t> values, Whom whom) const noexcept = 0;
  /// Whether a refusal is one that a page explains.
  [[nodiscard]] virtual bool knows_refusal(std::uint8_t refusal) const noexcept = 0;
  /// Asks those that are `asked` for their state.
  virtual ServoPacket read_states() noexcept = 0;
  /// The cycle that `read_states` began is over.
  virtual void read_ended(bool all_answered) noexcept = 0;
  /// Of the answer to a read of so many bytes, and of the answers to `read_states`.
  [[nodiscard]] virtual std::size_t answer_bytes(std::size_t data) const noexcept = 0;
  [[nodiscard]] virtual std::size_t states_bytes() const noexcept = 0;
  /// False where the data are no state.
  virtual bool read_state(std::size_t motor, std::span<const std::uint8_t> data, State& state) const noexcept = 0;
  /// What a step `check` read.
  virtual Wrong check(std::size_t motor, Register place, std::int64_t value) noexcept = 0;
  /// What a look showed.
  virtual void looked(std::size_t motor, Register place, std::int64_t value) noexcept = 0;
  /// The name of the model that reports this number, empty where no page reports it.
  [[nodiscard]] virtual std::string model_named(std::int64_t number) const = 0;

 private:
  struct Servo {
    MotorReading reading;
    MotorCommand wanted;
    ServoModel model{};
    std::span<const ServoStep> asking;
    std::uint8_t id = 0;
    std::int64_t limit = 0;
    std::int64_t place = 0, last = 0;  ///< unwrapped, and as on the wire
    bool placed = false;
    OffWatch off{2};  ///< by its register of power; one report may be the late answer to another question
    ServoStatus status;
    bool alert = false;                                   ///< of its last answer
    int empty_looks = 0;                                  ///< that gave no reason for its alert, in a row
    bool asked = false, heard = false, answered = false;  ///< in this cycle
    bool spoke = false;                                   ///< in this cycle, whatever it reported
    std::size_t owed = 0;                                 ///< answers to cycles before, which may still come
    std::size_t missed = 0;                               ///< cycles in a row
    MotorFault ails = MotorFault::none;
    std::int64_t firmware = -1;  ///< negative: not reported
    std::size_t step = 0;        ///< of its enabling
    std::size_t tries = 0;       ///< of that step
    std::uint8_t looks = 0;      ///< that are due, a bit each
    Wrong wrong = Wrong::nothing;
    std::int64_t found = 0;  ///< the value that is wrong, or the code of the refusal
    Register found_at{};
  };
  enum class Waiting : std::uint8_t { nothing, states, errand, second_answer, rest };
  /// What a cycle reports, one after the other.
  enum class Part : std::uint8_t { power_off, errand, goals, states };
  enum class Purpose : std::uint8_t { asking, enabling, power_off, look };
  struct Errand {
    Purpose purpose;
    std::size_t motor;
    Register place;
    bool reads;
    std::size_t which;  ///< step or look
  };

  std::span<const std::uint8_t> ask() noexcept;
  std::span<const std::uint8_t> cycle() noexcept;
  std::span<const std::uint8_t> send_errand(const Errand& errand, std::int64_t value) noexcept;
  std::span<const std::uint8_t> next_errand() noexcept;
  std::span<const std::uint8_t> next_look_at_power() noexcept;
  std::span<const std::uint8_t> say_power_off() noexcept;
  [[nodiscard]] std::span<const std::uint8_t> refuse() noexcept;
  void ask_next(bool same_servo) noexcept;
  void wait(Waiting for_what, std::size_t answer_bytes) noexcept;
  void ask_for_states() noexcept;
  void rest_if_useful() noexcept;
  void cycle_ended() noexcept;
  void errand_answered(std::span<const std::uint8_t> data) noexcept;
  void errand_failed(Wrong how, std::uint8_t code) noexcept;
  void take(Servo& servo, const State& state) noexcept;
  void answered(Servo& servo) noexcept;
  void fail(Servo& servo, MotorFault fault) noexcept;
  void judge_power(Servo& servo) noexcept;
  void reported_power(Servo& servo, bool off) noexcept;
  void looked_at_power(Servo& servo, std::int64_t value) noexcept;
  [[nodiscard]] static bool wants_power(const Servo& servo) noexcept;
  /// Whether it is to have power: it wants it, and nothing is wrong with it.
  [[nodiscard]] static bool may_have_power(const Servo& servo) noexcept {
    return wants_power(servo) && servo.reading.fault == MotorFault::none;
  }
  [[nodiscard]] bool anybody_may_have_power() const noexcept;
  [[nodiscard]] static std::int64_t goal(const Servo& servo) noexcept;
  void found_wrong(Wrong wrong, std::int64_t value) noexcept;
  [[nodiscard]] Check problem(std::size_t motor) const;
  [[nodiscard]] std::span<const std::uint8_t> sent() const noexcept { return packet_.bytes(); }

  /// Beyond the time of the bytes: a USB adapter collects for a millisecond and hands over in the next frame.
  static constexpr std::int64_t reply_timeout_ns = 2'000'000;
  /// How often a servo is asked in a row before it counts as one that does not answer.
  static constexpr std::size_t most_tries = 10;
  /// One look at the power of a servo that stays on in so many cycles.
  static constexpr std::int64_t cycles_per_late_look = 16;

  ServoTable table_;
  std::int64_t bits_per_s_;
  std::array<Servo, most_servos> servos_{};
  std::array<std::uint8_t, most_servos> ids_{}, asked_ids_{};
  std::size_t count_ = 0, asked_count_ = 0, missing_ = 0;
  std::int64_t asked_again_ns_ = 0;
  BusState state_ = BusState::asking;
  ServoPacket packet_;
  Errand errand_{};
  Waiting waiting_ = Waiting::nothing;
  Part part_ = Part::goals;
  std::size_t looks_at_power_ = 0;  ///< since the last cycle
  int refused_said_ = 0;            ///< how often all were commanded to switch off
  bool keeping_ = false;            ///< the register that was read is to be written
  std::size_t hushed_ = 0, asked_ = 0, asked_step_ = 0;
  std::size_t turn_ = 0, look_turn_ = 0;
  std::size_t heard_bytes_ = 0;  ///< since the latest errand
  bool asked_once_ = false;      ///< the question that was answered last
  bool heard_noise_ = false;     ///< bytes that are no answer came for the servo that is asked
  std::int64_t now_ns_ = 0, deadline_ns_ = 0, said_bytes_ = 0;
  std::int64_t cycles_ = 0, limited_ = 0;
};

}  // namespace tactus::devices
