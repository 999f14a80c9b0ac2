// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/dynamixel/dynamixel_bus.hpp>

#include <algorithm>
#include <limits>
#include <numbers>

namespace tactus::devices::dynamixel {

namespace {

constexpr Register model_number{0, 2};
constexpr Register firmware{6, 1};
constexpr Register return_delay{9, 1};
constexpr Register operating_mode{11, 1};
constexpr Register current_limit{38, 2};
constexpr Register torque_enable{64, 1};
constexpr Register status_return_level{68, 1};
constexpr Register hardware_error{70, 1};
constexpr Register bus_watchdog{98, 1};
constexpr Register goal_current{102, 2};
constexpr Register present{126, 10};          // current, velocity, position
constexpr Register voltage_and_heat{144, 3};  // voltage of two bytes, temperature of one

using enum ServoStep::Kind;
// A servo that answers to pings alone would seem silent: all are told to answer to everything.
constexpr std::array hush{ServoStep{write, torque_enable, 0}, ServoStep{write, status_return_level, 2}};
constexpr std::array asking{ServoStep{check, model_number, 0},  ServoStep{check, firmware, 0},
                            ServoStep{check, current_limit, 0}, ServoStep{write, torque_enable, 0},
                            ServoStep{check, torque_enable, 0}, ServoStep{keep, return_delay, 0},
                            ServoStep{keep, operating_mode, 0}};
// The watchdog's 0 undoes its latch, behind which a goal is refused. Goal current is the limit when power comes on.
constexpr std::array enabling{ServoStep{write, bus_watchdog, 0}, ServoStep{write, goal_current, 0},
                              ServoStep{write, bus_watchdog, 5}, ServoStep{write, torque_enable, 1}};
constexpr std::array looks{hardware_error, bus_watchdog, torque_enable, voltage_and_heat};

constexpr ServoTable table{.hush = hush,
                           .enabling = enabling,
                           .looks = looks,
                           .announced = 2,
                           .power = torque_enable,
                           .goal = goal_current,
                           .steps_per_turn = 4096,
                           .steps_until_wrap = std::int64_t{1} << 32,
                           .silence_ns = 100'000'000,  // that of the watchdog
                           .rest_ns = 150'000'000};

constexpr std::int64_t plain_cycles = 1000;
constexpr std::int64_t latched_watchdog = 0xff;  // -1
constexpr std::size_t status_bytes = 11;         // of an answer without data
constexpr std::size_t fast_head_bytes = 8, fast_block_bytes = 4;

constexpr double velocity_unit = 0.229 * 2.0 * std::numbers::pi / 60.0;  // rad/s
constexpr std::array<ServoModel, 6> models{{{"XL330-M077", 1190, 0.001, 1750, 0.215 / 1.47, velocity_unit},
                                            {"XL330-M288", 1200, 0.001, 1750, 0.52 / 1.47, velocity_unit},
                                            {"XC330-M288", 1240, 0.001, 2352, 0.93 / 1.80, velocity_unit},
                                            {"XC330-T288", 1220, 0.001, 910, 1.0 / 1.15873, velocity_unit},
                                            {"XM430-W210", 1030, 0.00269, 1193, 1.0 / (371.7 * 0.00269), velocity_unit},
                                            {"XM430-W350", 1020, 0.00269, 1193, 4.1 / 2.3, velocity_unit}}};

std::int64_t signed_number(std::span<const std::uint8_t> bytes) noexcept {
  const std::int64_t value = little_endian(bytes);
  const std::int64_t range = std::int64_t{1} << (8 * bytes.size());
  return value < range / 2 ? value : value - range;
}

Error of_motor(ErrorCode code, std::size_t motor, const char* key, std::string message) {
  return {code, std::string("motors[") + std::to_string(motor) + "]" + key, std::move(message), {}};
}

}  // namespace

const ServoModel& servo_model(DynamixelModel model) noexcept { return models[static_cast<std::size_t>(model)]; }

Result<DynamixelBus> DynamixelBus::make(const Params& params) {
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
                     " bit/s: the servos do 9600, 57600, 115200, 1000000, 2000000, 3000000 and 4000000",
                 {}};
  }
  for (std::size_t i = 0; i < params.motors.size(); ++i) {
    const std::int64_t id = params.motors[i].id;
    if (id < 0 || id > 252) {
      return of_motor(ErrorCode::out_of_bounds, i, ".id", std::to_string(id) + " must lie between 0 and 252");
    }
    for (std::size_t k = 0; k < i; ++k) {
      if (params.motors[k].id == id) {
        return of_motor(ErrorCode::inconsistent, i, ".id",
                        std::to_string(id) + " is that of motors[" + std::to_string(k) + "] too: give each its own");
      }
    }
  }
  return DynamixelBus(params);
}

DynamixelBus::DynamixelBus(const Params& params) : ServoBus(table, params.bits_per_s), fast_(params.fast_sync_read) {
  for (const Motor& motor : params.motors) add(static_cast<std::uint8_t>(motor.id), servo_model(motor.model), asking);
}

void DynamixelBus::find(std::span<const std::uint8_t> bytes) noexcept {
  finder_.hear(bytes, [this](std::span<const std::uint8_t> packet) { take(packet); });
}

void DynamixelBus::give_up() noexcept {
  finder_.give_up([this](std::span<const std::uint8_t> packet) { take(packet); });
}

void DynamixelBus::take(std::span<const std::uint8_t> packet) noexcept {
  constexpr std::uint8_t alert = 0x80;
  Heard packet_heard;
  decode(packet, packet_heard);
  const auto content = packet_heard.parameters();
  if (packet_heard.instruction != Instruction::status || content.empty()) return;  // an echo
  const auto answered = [&](std::uint8_t id, std::uint8_t error, std::span<const std::uint8_t> data) {
    heard({id, error, (error & alert) != 0, static_cast<std::uint8_t>(error & ~alert), data});
  };
  if (packet_heard.id != broadcast) return answered(packet_heard.id, content[0], content.subspan(1));
  // A block for each servo; the CRC of the last one is the packet's.
  constexpr std::size_t stride = present.bytes + fast_block_bytes;
  if (content.size() + 2 != asked().size() * stride) return;
  for (std::size_t i = 0; i < asked().size(); ++i) {
    const auto block = content.subspan(i * stride, stride - 2);
    answered(block[1], block[0], block.subspan(2));
  }
}

ServoPacket DynamixelBus::read(std::uint8_t id, Register place) noexcept {
  ServoPacket parameters;
  parameters.put(place.address, 2);
  parameters.put(place.bytes, 2);
  return encode(id, Instruction::read, parameters.bytes());
}

ServoPacket DynamixelBus::write(std::uint8_t id, Register place, std::int64_t value) noexcept {
  ServoPacket parameters;
  parameters.put(place.address, 2);
  parameters.put(value, place.bytes);
  return encode(id, Instruction::write, parameters.bytes());
}

ServoPacket DynamixelBus::write_all(Register place, std::span<const std::int64_t> values, Whom whom) const noexcept {
  ServoPacket parameters;
  parameters.put(place.address, 2);
  parameters.put(place.bytes, 2);
  for (std::size_t i = 0; i < motors(); ++i) {
    if ((whom >> i & 1U) == 0) continue;
    parameters.put(id(i));
    parameters.put(values[i], place.bytes);
  }
  return encode(broadcast, Instruction::sync_write, parameters.bytes());
}

bool DynamixelBus::knows_refusal(std::uint8_t refusal) const noexcept {
  constexpr std::uint8_t last = 7;  // access error
  return refusal <= last;
}

ServoPacket DynamixelBus::read_states() noexcept {
  ServoPacket parameters;
  parameters.put(present.address, 2);
  parameters.put(present.bytes, 2);
  parameters.put(asked());
  const bool fast = fast_ && plain_left_ == 0;
  return encode(broadcast, fast ? Instruction::fast_sync_read : Instruction::sync_read, parameters.bytes());
}

void DynamixelBus::read_ended(bool all_answered) noexcept {
  if (!all_answered) {
    plain_left_ = plain_cycles;
  } else if (plain_left_ > 0) {
    --plain_left_;
  }
}

std::size_t DynamixelBus::answer_bytes(std::size_t data) const noexcept { return status_bytes + data; }

std::size_t DynamixelBus::states_bytes() const noexcept {
  const bool fast = fast_ && plain_left_ == 0;
  return fast ? fast_head_bytes + asked().size() * (present.bytes + fast_block_bytes)
              : asked().size() * answer_bytes(present.bytes);
}

bool DynamixelBus::read_state(std::size_t, std::span<const std::uint8_t> data, State& state) const noexcept {
  if (data.size() != present.bytes) return false;
  state = {.current = signed_number(data.first(2)),
           .velocity = signed_number(data.subspan(2, 4)),
           .position = signed_number(data.subspan(6, 4)),
           .temperature_C = std::numeric_limits<double>::quiet_NaN()};
  return true;
}

ServoBus::Wrong DynamixelBus::check(std::size_t motor, Register place, std::int64_t value) noexcept {
  if (place.address == model_number.address) return value == model(motor).number ? Wrong::nothing : Wrong::model;
  if (place.address == firmware.address) {
    set_firmware(motor, value);
    return Wrong::nothing;
  }
  // More than its model can be set to is that of another model; 0 gives no force.
  if (value < 1 || value > model(motor).current_limit) return Wrong::limit;
  limit(motor, value);
  return Wrong::nothing;
}

void DynamixelBus::looked(std::size_t motor, Register place, std::int64_t value) noexcept {
  if (place.address == hardware_error.address) {
    const auto has = [value](std::int64_t bits) { return (value & bits) != 0; };
    set_condition(motor, value);
    ails(motor, has(4)         ? MotorFault::hot
                : has(1)       ? MotorFault::voltage
                : has(8)       ? MotorFault::encoder
                : has(16 | 32) ? MotorFault::overload
                : value != 0   ? MotorFault::unknown_status
                               : MotorFault::none);
  } else if (place.address == torque_enable.address) {
    if (value == 0 && has_power(motor)) lost_power(motor, MotorFault::refused);
  } else if (place.address == bus_watchdog.address) {
    if (value == latched_watchdog && has_power(motor)) lost_power(motor, MotorFault::lost_master);
  } else {
    set_temperature(motor, static_cast<double>(value >> 16));
  }
}

std::string DynamixelBus::model_named(std::int64_t number) const {
  const auto found = std::ranges::find(models, number, &ServoModel::number);
  if (found != models.end()) return found->name;
  switch (number) {
    case 1060:
      return "XL430-W250";
    case 1120:
      return "XM540-W270";
    case 1210:
      return "XC330-T181";
    default:
      return {};
  }
}

}  // namespace tactus::devices::dynamixel
