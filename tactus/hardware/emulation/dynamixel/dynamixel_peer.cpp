// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/dynamixel/dynamixel_peer.hpp>
#include <tactus/hardware/emulation/dynamixel/internal/control_table.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

namespace tactus::emulation::dynamixel {

namespace {

constexpr std::uint8_t all = 0xfe, alert = 0x80;
// What a status packet says of the question.
constexpr std::uint8_t fine = 0, fails = 1, unknown = 2, crc_wrong = 3, out_of_range = 4, wrong_length = 5,
                       no_access = 7;
// Bits of the hardware error.
constexpr std::int64_t overheated = 4;
constexpr std::int64_t byte_bits = 10, second_ns = 1'000'000'000;
constexpr std::int64_t off_ns = 300'000'000;
constexpr std::size_t status_bytes = 11, state_head_bytes = 8, block_bytes = 4;

/// Bit by bit, as the page defines it.
std::uint16_t crc_of(std::span<const std::uint8_t> bytes) noexcept {
  unsigned crc = 0;
  for (const std::uint8_t byte : bytes) {
    for (unsigned mask = 0x80; mask != 0; mask >>= 1) {
      const bool carry = ((crc & 0x8000U) != 0) != ((byte & mask) != 0);
      crc = (crc << 1) & 0xffffU;
      if (carry) crc ^= 0x8005U;
    }
  }
  return static_cast<std::uint16_t>(crc);
}

std::size_t word(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  return bytes[at] + std::size_t{256} * bytes[at + 1];
}

}  // namespace

Result<DynamixelPeer> DynamixelPeer::make(const Params& params) {
  if (params.servos.empty() || params.servos.size() > most_servos) {
    return Error{ErrorCode::out_of_bounds, "servos", "1 to 16 servos fit on one line", {}};
  }
  for (const Servo& servo : params.servos) {
    if (servo.id < 0 || servo.id > 252) {
      return Error{ErrorCode::out_of_bounds, "id", std::to_string(servo.id) + " must lie between 0 and 252", {}};
    }
    if (make_of(servo.model_number) == makes.size()) {
      return Error{ErrorCode::unknown_key,
                   "model_number",
                   std::to_string(servo.model_number) + " is not one of 1020, 1030, 1190, 1200, 1220 and 1240",
                   {}};
    }
  }
  return DynamixelPeer(params);
}

DynamixelPeer::DynamixelPeer(const Params& params)
    : bits_per_s_(params.bits_per_s),
      knows_fast_sync_read_(params.knows_fast_sync_read),
      line_(params.line, static_cast<std::uint64_t>(params.seed)) {
  for (const Servo& each : params.servos) {
    State servo;
    servo.id = static_cast<std::uint8_t>(each.id);
    servo.fault = each.fault;
    servo.fault_from_ns = each.fault_from_ns;
    servo.error = each.error;
    const std::size_t stated = make_of(each.model_number);
    const Make& make = makes[each.fault == ServoFault::wrong_model ? (stated + 1) % makes.size() : stated];
    servo.current_torque_Nm = make.unit_A * make.stall_torque_Nm / make.stall_current_A;
    put(servo, 0, 2, make.number);
    put(servo, 6, 1, 46);  // firmware
    put(servo, 7, 1, each.id);
    put(servo, 8, 1, 3);
    put(servo, 9, 1, 250);
    put(servo, 11, 1, 3);
    put(servo, 31, 1, 70);
    put(servo, 36, 2, 885);
    put(servo, 38, 2, each.fault == ServoFault::low_limit ? make.highest_current / 10 : make.highest_current);
    put(servo, 48, 4, 4095);
    put(servo, 63, 1, 52);
    boot(servo);
    servos_.push_back(servo);
  }
}

void DynamixelPeer::boot(State& servo) const noexcept {
  std::fill(servo.table.begin() + 64, servo.table.end(), std::uint8_t{0});
  put(servo, 68, 1, 2);
  put(servo, 100, 2, get(servo, 36, 2));
  put(servo, 102, 2, get(servo, 38, 2));  // as real ones: the goal is the limit until somebody writes another
  put(servo, 144, 2, 50);
  put(servo, temperature.address, 1, 35);
}

void DynamixelPeer::put(State& servo, std::size_t address, std::size_t bytes, std::int64_t value) const noexcept {
  for (std::size_t i = 0; i < bytes; ++i) {
    servo.table[address + i] = static_cast<std::uint8_t>(value & 0xff);
    value >>= 8;
  }
}

std::int64_t DynamixelPeer::get(const State& servo, std::size_t address, std::size_t bytes) noexcept {
  std::int64_t value = 0;
  for (std::size_t i = bytes; i > 0; --i) value = value * 256 + servo.table[address + i - 1];
  return value;
}

std::int64_t DynamixelPeer::stored(std::size_t servo, std::size_t address, std::size_t bytes) const noexcept {
  return get(servos_[servo], address, bytes);
}

std::int64_t DynamixelPeer::current(const State& servo) noexcept {
  const bool drives = servo.table[64] != 0 && servo.table[11] == 0 && servo.table[98] != 0xff;
  return drives ? static_cast<std::int16_t>(get(servo, 102, 2)) : 0;
}

/// Up to now: first with the current that there was, then what came to an end meanwhile.
void DynamixelPeer::live(State& servo, std::int64_t now_ns) noexcept {
  constexpr double turn_rad = 2.0 * std::numbers::pi, velocity_unit = 0.229 * turn_rad / 60.0;
  const auto turn_until = [&](std::int64_t at_ns) {
    const std::int64_t units = current(servo);
    servo.largest = std::max(servo.largest, std::abs(units));
    servo.joint.advance(at_ns, static_cast<double>(units) * servo.current_torque_Nm);
  };
  const std::int64_t watchdog = servo.table[98];
  const std::int64_t bites_ns = instruction_ns_ + watchdog * 20'000'000;
  if (servo.table[64] != 0 && watchdog >= 1 && watchdog <= 127 && bites_ns < now_ns) {
    turn_until(bites_ns);
    servo.table[98] = 0xff;
  }
  if (!servo.broke && servo.fault != ServoFault::none && servo.fault_from_ns <= now_ns) {
    if (servo.fault == ServoFault::power_cycle) {
      turn_until(servo.fault_from_ns);
      servo.broke = true;
      servo.off_until_ns = servo.fault_from_ns + off_ns;
      boot(servo);
      // The place within a turn is all that it knows when it wakes.
      servo.lost_turns = static_cast<std::int64_t>(std::floor(servo.joint.position_rad / turn_rad));
    } else if (servo.fault == ServoFault::hot) {
      turn_until(servo.fault_from_ns);
      servo.broke = true;
      put(servo, 70, 1, overheated);
      put(servo, temperature.address, 1, 81);
      put(servo, 64, 1, 0);
    }
  }
  turn_until(now_ns);
  put(servo, 120, 2, now_ns / 1'000'000 % 32768);
  put(servo, 126, 2, current(servo));
  put(servo, 128, 4, static_cast<std::int64_t>(std::floor(servo.joint.velocity_rad_per_s / velocity_unit + 0.5)));
  put(servo, 132, 4,
      static_cast<std::int64_t>(std::floor(servo.joint.position_rad / turn_rad * 4096.0 + 0.5)) -
          4096 * servo.lost_turns);
}

void DynamixelPeer::advance(std::int64_t now_ns) noexcept {
  for (State& servo : servos_) live(servo, now_ns);
}

bool DynamixelPeer::answers(const State& servo, std::int64_t now_ns) const noexcept {
  if (now_ns < servo.off_until_ns) return false;
  return servo.fault != ServoFault::silence || now_ns < servo.fault_from_ns;
}

bool DynamixelPeer::has_power(std::size_t servo) const noexcept {
  return servos_[servo].table[64] != 0 && servos_[servo].table[98] != 0xff;
}

Check DynamixelPeer::inject(const WrittenFault& fault, std::int64_t now_ns) {
  return inject_into(
      servos_, [](const State& servo) { return servo.id; }, fault, began_, now_ns);
}

void DynamixelPeer::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept {
  if (!began_) {
    began_ = true;
    for (State& servo : servos_) servo.fault_from_ns += now_ns;
  }
  line_.echo(bytes, now_ns);
  for (const std::uint8_t byte : bytes) {
    last_four_ = (last_four_ << 8) | byte;
    if (in_packet_) came_[came_size_++] = byte;
    // A header begins a packet wherever it stands: within one, stuffing keeps it away.
    if (last_four_ == 0xfffffd00) {
      in_packet_ = true;
      came_ = {0xff, 0xff, 0xfd, 0x00};
      came_size_ = 4;
    }
    if (!in_packet_ || came_size_ < 7) continue;
    const std::size_t size = 7 + word(came_, 5);
    if (size > came_.size() || size < 10) {
      in_packet_ = false;
    } else if (came_size_ == size) {
      in_packet_ = false;
      packet_came(now_ns);
    }
  }
}

void DynamixelPeer::packet_came(std::int64_t now_ns) noexcept {
  advance(now_ns);
  const Bytes packet(came_.data(), came_size_);
  const bool whole = crc_of(packet.first(packet.size() - 2)) == word(packet, packet.size() - 2);
  if (whole) instruction_ns_ = now_ns;
  std::array<std::uint8_t, packet_bytes> parameters{};
  std::size_t size = 0;
  for (std::size_t i = 8; i + 2 < packet.size(); ++i) {
    const bool stuffed =
        size >= 3 && packet[i] == 0xfd && packet[i - 1] == 0xfd && packet[i - 2] == 0xff && packet[i - 3] == 0xff;
    if (!stuffed) parameters[size++] = packet[i];
  }
  const Bytes given(parameters.data(), size);
  if (packet[4] != all) {
    State* servo = find(packet[4]);
    if (servo != nullptr && answers(*servo, now_ns)) obey(*servo, packet[7], given, whole, now_ns);
    return;
  }
  if (!whole) return;
  switch (packet[7]) {
    case 0x82:
      return sync_read(given, false, now_ns);
    case 0x8a:
      return knows_fast_sync_read_ ? sync_read(given, true, now_ns) : void();
    case 0x83:
      return sync_write(given, now_ns);
    case 0x01: {
      std::int64_t at_ns = now_ns;
      for (State& servo : servos_) {
        if (answers(servo, now_ns)) obey(servo, packet[7], given, whole, at_ns);
        at_ns += static_cast<std::int64_t>(status_bytes + 3) * byte_bits * second_ns / bits_per_s_;
      }
      return;
    }
    default:
      return;
  }
}

DynamixelPeer::State* DynamixelPeer::find(std::uint8_t id) noexcept {
  const auto found = std::ranges::find(servos_, id, &State::id);
  return found == servos_.end() ? nullptr : &*found;
}

std::int64_t DynamixelPeer::delay_ns(const State& servo) noexcept { return std::int64_t{2000} * servo.table[9]; }

/// One servo answers for itself.
void DynamixelPeer::obey(State& servo, std::uint8_t instruction, Bytes parameters, bool whole,
                         std::int64_t now_ns) noexcept {
  const std::int64_t level = servo.table[68];
  const std::int64_t at_ns = now_ns + delay_ns(servo);
  const auto refuse = [&](std::uint8_t error) { status(servo, error, {}, at_ns); };
  if (!whole) return refuse(crc_wrong);
  switch (instruction) {
    case 0x01:
      return status(servo, fine, std::array{servo.table[0], servo.table[1], servo.table[6]}, at_ns);
    case 0x02: {
      if (level < 1) return;
      if (parameters.size() != 4) return refuse(wrong_length);
      const std::size_t address = word(parameters, 0), bytes = word(parameters, 2);
      const std::uint8_t error = check_read(address, bytes);
      if (error != fine) return refuse(error);
      return status(servo, fine, Bytes(servo.table).subspan(address, bytes), at_ns);
    }
    case 0x03: {
      const std::uint8_t error =
          parameters.size() < 3 ? wrong_length : write(servo, word(parameters, 0), parameters.subspan(2), now_ns);
      return level < 2 ? void() : refuse(error);
    }
    case 0x08:
      boot(servo);
      return level < 2 ? void() : refuse(fine);
    default:
      return refuse(unknown);
  }
}

std::uint8_t DynamixelPeer::check_read(std::size_t address, std::size_t bytes) noexcept {
  if (bytes == 0 || address + bytes > table_bytes) return out_of_range;
  for (const std::size_t end = address + bytes; address < end;) {
    const Field* field = field_at(address);
    if (field == nullptr) return no_access;
    address += field->bytes;
  }
  return fine;
}

/// All of it, or nothing.
std::uint8_t DynamixelPeer::write(State& servo, std::size_t address, Bytes data, std::int64_t now_ns) const noexcept {
  for (std::size_t at = 0; at < data.size();) {
    const Field* field = field_at(address + at);
    if (field == nullptr || !field->writable) return no_access;
    if (field->address < 64 && servo.table[64] != 0) return no_access;  // locked
    if (at + field->bytes > data.size()) return wrong_length;
    std::int64_t value = 0;
    for (std::size_t i = field->bytes; i > 0; --i) value = value * 256 + data[at + i - 1];
    if (field->lowest < 0 && (value >> (8 * field->bytes - 1)) != 0) value -= std::int64_t{1} << (8 * field->bytes);
    std::int64_t lowest = field->lowest, highest = field->highest;
    if (field->address == 102) lowest = -(highest = get(servo, 38, 2));
    if (field->address == 38) highest = makes[make_of(get(servo, 0, 2))].highest_current;
    if (value < lowest || value > highest) return out_of_range;
    const bool is_goal = field->address >= 100 && field->address < 120;
    if (is_goal && servo.table[98] == 0xff) return out_of_range;  // until the watchdog is told 0
    if (field->address == 64 && value != 0 && servo.table[70] != 0) return fails;
    at += field->bytes;
  }
  const bool switches_off = address == 64 && data[0] == 0;
  if (switches_off && suffers(servo, ServoFault::ignores_disable, now_ns)) return fine;
  std::copy(data.begin(), data.end(), servo.table.begin() + static_cast<std::ptrdiff_t>(address));
  if (address == 11) put(servo, 102, 2, get(servo, 38, 2));
  return fine;
}

void DynamixelPeer::status(const State& servo, std::uint8_t error, Bytes data, std::int64_t at_ns) noexcept {
  const auto own = static_cast<std::uint8_t>(error | (servo.table[70] != 0 ? alert : 0));
  const std::uint8_t mark = suffers(servo, ServoFault::error, at_ns) ? servo.error : own;
  Packet packet;
  const auto put_stuffed = [&packet](std::uint8_t byte) {
    packet.put(byte);
    const auto* end = packet.bytes.data() + packet.size;
    if (packet.size >= 11 && end[-1] == 0xfd && end[-2] == 0xff && end[-3] == 0xff) packet.put(0xfd);
  };
  packet.put(std::array<std::uint8_t, 8>{0xff, 0xff, 0xfd, 0x00, servo.id, 0, 0, 0x55});
  put_stuffed(mark);
  for (const std::uint8_t byte : data) put_stuffed(byte);
  packet.bytes[5] = static_cast<std::uint8_t>(packet.size - 5);
  packet.put_crc();
  line_.answer({packet.bytes.data(), packet.size}, at_ns, servo.fault);
}

void DynamixelPeer::Packet::put_crc() noexcept {
  const std::uint16_t crc = crc_of({bytes.data(), size});
  put(static_cast<std::uint8_t>(crc & 0xff));
  put(static_cast<std::uint8_t>(crc / 256));
}

void DynamixelPeer::sync_read(Bytes parameters, bool fast, std::int64_t now_ns) noexcept {
  if (parameters.size() < 5 || parameters.size() > 4 + most_servos) return;
  const std::size_t address = word(parameters, 0), bytes = word(parameters, 2);
  if (check_read(address, bytes) != fine) return;
  const Bytes ids = parameters.subspan(4);
  if (!fast) {
    const std::int64_t place_ns = static_cast<std::int64_t>(status_bytes + bytes) * byte_bits * second_ns / bits_per_s_;
    std::int64_t at_ns = now_ns;
    for (const std::uint8_t id : ids) {
      const State* servo = find(id);
      if (servo != nullptr && answers(*servo, now_ns) && servo->table[68] >= 1) {
        at_ns += delay_ns(*servo);
        status(*servo, fine, Bytes(servo->table).subspan(address, bytes), at_ns);
      }
      at_ns += place_ns;  // empty where it is silent
    }
    return;
  }
  Packet packet;
  const std::size_t length = 1 + ids.size() * (bytes + block_bytes);
  if (7 + length > packet.bytes.size()) return;
  packet.put(std::array<std::uint8_t, state_head_bytes>{0xff, 0xff, 0xfd, 0x00, all,
                                                        static_cast<std::uint8_t>(length % 256),
                                                        static_cast<std::uint8_t>(length / 256), 0x55});
  std::int64_t delayed_ns = 0;
  for (const std::uint8_t id : ids) {
    const State* servo = find(id);
    if (servo == nullptr || !answers(*servo, now_ns) || servo->table[68] < 1) break;  // who is behind waits for it
    const std::uint8_t own = servo->table[70] != 0 ? alert : fine;
    packet.put(suffers(*servo, ServoFault::error, now_ns) ? servo->error : own);
    packet.put(id);
    packet.put(Bytes(servo->table).subspan(address, bytes));
    packet.put_crc();
    delayed_ns = std::max(delayed_ns, delay_ns(*servo));
  }
  if (packet.size > state_head_bytes) line_.answer({packet.bytes.data(), packet.size}, now_ns + delayed_ns);
}

void DynamixelPeer::sync_write(Bytes parameters, std::int64_t now_ns) noexcept {
  if (parameters.size() < 4) return;
  const std::size_t address = word(parameters, 0), bytes = word(parameters, 2);
  if (bytes == 0 || (parameters.size() - 4) % (bytes + 1) != 0) return;
  for (Bytes rest = parameters.subspan(4); !rest.empty(); rest = rest.subspan(bytes + 1)) {
    State* servo = find(rest[0]);
    if (servo == nullptr || now_ns < servo->off_until_ns) continue;
    if (write(*servo, address, rest.subspan(1, bytes), now_ns) != fine && address == 102) ++lost_goals_;
  }
}

}  // namespace tactus::emulation::dynamixel
