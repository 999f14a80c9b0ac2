// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/feetech/feetech_bus.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::devices::feetech {

namespace {

constexpr Register model_number{3, 2};
constexpr Register return_delay{7, 1};  // of STS; in an HLS its second id
constexpr Register answer_level{8, 1};
constexpr Register protection_current{28, 2};
constexpr Register operating_mode{33, 1};
constexpr Register torque_enable{40, 1};
constexpr Register goal_current{44, 2};
constexpr Register memory_lock{55, 1};
constexpr Register present{56, 8};                // position, velocity, load, voltage, temperature
constexpr Register present_with_current{56, 15};  // up to the current at 69
constexpr Register condition{65, 1};

constexpr auto check_it = ServoStep::Kind::check;
constexpr auto keep_it = ServoStep::Kind::keep;
constexpr auto write_it = ServoStep::Kind::write;
// What is kept stands in memory behind a lock. Without answers to writes every write would seem lost.
constexpr std::array hush{ServoStep{write_it, torque_enable, 0}, ServoStep{write_it, memory_lock, 0}};
constexpr std::array asking_sts{ServoStep{check_it, model_number, 0},  ServoStep{keep_it, answer_level, 1},
                                ServoStep{keep_it, return_delay, 0},   ServoStep{write_it, memory_lock, 1},
                                ServoStep{write_it, torque_enable, 0}, ServoStep{check_it, torque_enable, 0}};
constexpr std::array asking_hls{ServoStep{check_it, model_number, 0},       ServoStep{keep_it, answer_level, 1},
                                ServoStep{check_it, protection_current, 0}, ServoStep{keep_it, operating_mode, 2},
                                ServoStep{write_it, memory_lock, 1},        ServoStep{write_it, torque_enable, 0},
                                ServoStep{check_it, torque_enable, 0}};
// When power comes on, the goal is the protection current.
constexpr std::array enabling{ServoStep{write_it, goal_current, 0}, ServoStep{write_it, torque_enable, 1}};
constexpr std::array looks{condition, torque_enable};

constexpr std::int64_t steps_per_turn = 4096;
constexpr ServoTable table{.hush = hush,
                           .enabling = enabling,
                           .looks = looks,
                           .announced = 1,
                           .power = torque_enable,
                           .goal = goal_current,
                           .steps_per_turn = steps_per_turn,
                           .steps_until_wrap = steps_per_turn,
                           .silence_ns = 100'000'000,
                           .rest_ns = 0};

constexpr std::size_t status_bytes = 6;  // of an answer without data
constexpr int sign_bit = 15;
constexpr double step_rad = 2.0 * std::numbers::pi / static_cast<double>(steps_per_turn);
constexpr double hls_velocity_unit = 0.732 * 2.0 * std::numbers::pi / 60.0;  // rad/s

/// Of an HLS the torque of a current is stated by who has it; of an STS nothing is asked.
constexpr std::array<ServoModel, 3> models{{{"STS3215", 777, 0.0065, 0, 1.0, step_rad},
                                            {"STS3250", 2825, 0.0065, 0, 1.0, step_rad},
                                            {"HLS3625", 10 + 256 * 13, 0.0065, 2047, 1.0, hls_velocity_unit}}};

Error of_motor(ErrorCode code, std::size_t motor, const char* key, std::string message) {
  return {code, std::string("motors[") + std::to_string(motor) + "]" + key, std::move(message), {}};
}

}  // namespace

const ServoModel& servo_model(FeetechModel model) noexcept { return models[static_cast<std::size_t>(model)]; }

Result<FeetechBus> FeetechBus::make(const Params& params) {
  if (params.motors.empty() || params.motors.size() > most_servos) {
    return Error{ErrorCode::out_of_bounds,
                 "motors",
                 std::to_string(params.motors.size()) + " motors: a bus has 1 to " + std::to_string(most_servos),
                 {}};
  }
  if (std::ranges::find(bit_rates, params.bits_per_s) == bit_rates.end()) {
    return Error{ErrorCode::out_of_bounds,
                 "bits_per_s",
                 std::to_string(params.bits_per_s) +
                     " bit/s: the servos do 38400, 57600, 76800, 115200, 128000, 250000, 500000 and 1000000",
                 {}};
  }
  for (std::size_t i = 0; i < params.motors.size(); ++i) {
    const Motor& motor = params.motors[i];
    if (motor.id < 0 || motor.id > 253) {
      return of_motor(ErrorCode::out_of_bounds, i, ".id", std::to_string(motor.id) + " must lie between 0 and 253");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (params.motors[k].id == motor.id) {
        return of_motor(
            ErrorCode::inconsistent, i, ".id",
            std::to_string(motor.id) + " is that of motors[" + std::to_string(k) + "] too: give each its own");
      }
    }
    if (models[static_cast<std::size_t>(motor.model)].current_limit == 0) continue;
    if (motor.torque_Nm_per_A == 0.0) {
      return of_motor(ErrorCode::missing, i, ".torque_Nm_per_A",
                      "state how much torque a current of this servo gives: its stall torque over its stall current");
    }
    if (!positive.contain(motor.torque_Nm_per_A)) {
      return of_motor(ErrorCode::out_of_bounds, i, ".torque_Nm_per_A",
                      rounded_number(motor.torque_Nm_per_A) + " must be greater than 0 N m/A");
    }
  }
  return FeetechBus(params);
}

FeetechBus::FeetechBus(const Params& params) : ServoBus(table, params.bits_per_s), present_(present) {
  for (const Motor& motor : params.motors) {
    ServoModel model = models[static_cast<std::size_t>(motor.model)];
    const bool takes_current = model.current_limit > 0;
    if (takes_current) {
      model.torque_Nm_per_A = motor.torque_Nm_per_A;
      present_ = present_with_current;
    }
    add(static_cast<std::uint8_t>(motor.id), model,
        takes_current ? std::span<const ServoStep>(asking_hls) : std::span<const ServoStep>(asking_sts));
  }
}

void FeetechBus::find(std::span<const std::uint8_t> bytes) noexcept {
  finder_.hear(bytes, [this](std::span<const std::uint8_t> packet) { take(packet); });
}

void FeetechBus::give_up() noexcept {
  finder_.give_up([this](std::span<const std::uint8_t> packet) { take(packet); });
}

void FeetechBus::take(std::span<const std::uint8_t> packet) noexcept {
  // An echo of a question reads like an answer. No servo has the model number that the echo of that question would
  // tell; so it shows whether there are echoes, and the others are dropped once each where there are.
  if (std::ranges::equal(packet, question_.bytes())) {
    if (question_is_model_) echoes_ = true;
    if (echoes_ && echo_due_) {
      echo_due_ = false;
      return;
    }
  }
  const std::uint8_t error = packet[4];
  heard({packet[2], error, error != 0, 0, packet.subspan(5, packet.size() - status_bytes)});
}

ServoPacket FeetechBus::read(std::uint8_t id, Register place) noexcept {
  const std::array<std::uint8_t, 2> parameters{static_cast<std::uint8_t>(place.address), place.bytes};
  question_ = encode(id, Instruction::read, parameters);
  question_is_model_ = place.address == model_number.address;
  echo_due_ = true;
  return question_;
}

ServoPacket FeetechBus::write(std::uint8_t id, Register place, std::int64_t value) noexcept {
  ServoPacket parameters;
  parameters.put(static_cast<std::uint8_t>(place.address));
  parameters.put(to_sign_magnitude(value, sign_bit), place.bytes);
  question_ = encode(id, Instruction::write, parameters.bytes());
  question_is_model_ = false;
  echo_due_ = true;
  return question_;
}

/// It refuses nothing: its error byte says what is wrong with the servo.
bool FeetechBus::knows_refusal(std::uint8_t refusal) const noexcept { return refusal == 0; }

ServoPacket FeetechBus::write_all(Register place, std::span<const std::int64_t> values, Whom whom) const noexcept {
  ServoPacket parameters;
  parameters.put(static_cast<std::uint8_t>(place.address));
  parameters.put(place.bytes);
  for (std::size_t i = 0; i < motors(); ++i) {
    if ((whom >> i & 1U) == 0) continue;
    if (place.address == goal_current.address && model(i).current_limit == 0) continue;
    parameters.put(id(i));
    parameters.put(to_sign_magnitude(values[i], sign_bit), place.bytes);
  }
  if (parameters.size() == 2) return {};
  return encode(broadcast, Instruction::sync_write, parameters.bytes());
}

ServoPacket FeetechBus::read_states() noexcept {
  ServoPacket parameters;
  parameters.put(static_cast<std::uint8_t>(present_.address));
  parameters.put(present_.bytes);
  parameters.put(asked());
  return encode(broadcast, Instruction::sync_read, parameters.bytes());
}

std::size_t FeetechBus::answer_bytes(std::size_t data) const noexcept { return status_bytes + data; }

std::size_t FeetechBus::states_bytes() const noexcept { return asked().size() * answer_bytes(present_.bytes); }

bool FeetechBus::read_state(std::size_t motor, std::span<const std::uint8_t> data, State& state) const noexcept {
  if (data.size() != present_.bytes) return false;
  const auto number = [&data](std::size_t at) {
    return from_sign_magnitude(little_endian(data.subspan(at, 2)), sign_bit);
  };
  state = {.current = model(motor).current_limit > 0 ? number(13) : 0,
           .velocity = number(2),
           .position = number(0),
           .temperature_C = static_cast<double>(data[7])};
  return true;
}

ServoBus::Wrong FeetechBus::check(std::size_t motor, Register place, std::int64_t value) noexcept {
  if (place.address == model_number.address) return value == model(motor).number ? Wrong::nothing : Wrong::model;
  if (value < 1 || value > model(motor).current_limit) return Wrong::limit;
  limit(motor, value);
  return Wrong::nothing;
}

void FeetechBus::looked(std::size_t motor, Register place, std::int64_t value) noexcept {
  if (place.address == condition.address) {
    const auto has = [value](std::int64_t bit) { return (value & bit) != 0; };
    set_condition(motor, value);
    ails(motor, has(4)       ? MotorFault::hot
                : has(1)     ? MotorFault::voltage
                : has(2)     ? MotorFault::encoder
                : has(8)     ? MotorFault::current
                : has(32)    ? MotorFault::overload
                : value != 0 ? MotorFault::unknown_status
                             : MotorFault::none);
  } else if (value == 0 && has_power(motor)) {
    lost_power(motor, MotorFault::refused);
  }
}

std::string FeetechBus::model_named(std::int64_t number) const {
  const auto found = std::ranges::find(models, number, &ServoModel::number);
  return found == models.end() ? std::string() : found->name;
}

}  // namespace tactus::devices::feetech
