// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/feetech/feetech_peer.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <string>

namespace tactus::emulation::feetech {

namespace {

constexpr std::uint8_t all = 0xfe;
// Places in the table.
constexpr std::size_t model = 3, own_id = 5, delay = 7, level = 8, protection = 28, homing = 31, mode = 33, power = 40,
                      goal = 44, lock = 55, position = 56, velocity = 58, voltage = 62, heat = 63, condition = 65,
                      amperes = 69, lasting_from = 5;
constexpr std::int64_t hot_bit = 4, current_bit = 8;
constexpr std::int64_t off_ns = 300'000'000;
constexpr double turn_rad = 2.0 * std::numbers::pi;
/// A 25 kg cm servo of 7.4 V takes about 3 A when it stands.
constexpr double torque_of_one_Nm = 0.0065 * 2.45 / 3.0;

/// Eleven bits and a sign: what is taken off the position.
double homing_steps(std::int64_t offset) noexcept {
  const auto size = static_cast<double>(offset & 0x7ff);
  return (offset & 0x800) != 0 ? -size : size;
}

std::int64_t with_sign_bit(std::int64_t value) noexcept { return value >= 0 ? value : 0x8000 - value; }

}  // namespace

Result<FeetechPeer> FeetechPeer::make(const Params& params) {
  if (params.servos.empty() || params.servos.size() > most_servos) {
    return Error{ErrorCode::out_of_bounds, "servos", "1 to 16 servos fit on one line", {}};
  }
  for (const Servo& servo : params.servos) {
    if (servo.id < 0 || servo.id > 253) {
      return Error{ErrorCode::out_of_bounds, "id", std::to_string(servo.id) + " must lie between 0 and 253", {}};
    }
  }
  return FeetechPeer(params);
}

FeetechPeer::FeetechPeer(const Params& params)
    : bits_per_s_(params.bits_per_s), line_(params.line, static_cast<std::uint64_t>(params.seed)) {
  for (const Servo& each : params.servos) {
    State servo;
    servo.takes_current = each.make == Make::hls3625;
    servo.fault = each.fault;
    servo.fault_from_ns = each.fault_from_ns;
    servo.error = each.error;
    const bool tells_hls = servo.takes_current != (each.fault == ServoFault::wrong_model);
    put(servo, model, tells_hls ? 0x0d0a : 777);
    servo.table[own_id] = static_cast<std::uint8_t>(each.id);
    servo.table[delay] = servo.takes_current ? 0 : 250;
    servo.table[level] = 1;
    put(servo, 11, 4095);
    servo.table[13] = 70;
    put(servo, protection, each.fault == ServoFault::low_limit ? 50 : 500);
    std::copy_n(servo.table.begin(), lasting_bytes, servo.lasting.begin());
    boot(servo);
    servos_.push_back(servo);
  }
}

void FeetechPeer::boot(State& servo) noexcept {
  std::fill(servo.table.begin(), servo.table.end(), std::uint8_t{0});
  std::copy(servo.lasting.begin(), servo.lasting.end(), servo.table.begin());
  if (servo.takes_current) put(servo, goal, get(servo, protection));
  servo.table[lock] = 1;
  servo.table[voltage] = 74;
  servo.table[heat] = 31;
}

void FeetechPeer::put(State& servo, std::size_t address, std::int64_t value) noexcept {
  servo.table[address] = static_cast<std::uint8_t>(value % 256);
  servo.table[address + 1] = static_cast<std::uint8_t>(value / 256);
}

std::int64_t FeetechPeer::get(const State& servo, std::size_t address) noexcept {
  return servo.table[address] + 256 * servo.table[address + 1];
}

std::int64_t FeetechPeer::stored(std::size_t servo, std::size_t address, std::size_t bytes) const noexcept {
  return bytes == 1 ? servos_[servo].table[address] : get(servos_[servo], address);
}

std::int64_t FeetechPeer::current(const State& servo) noexcept {
  if (!servo.takes_current || servo.table[power] != 1 || servo.table[mode] != 2) return 0;
  const std::int64_t wanted = get(servo, goal);
  return wanted >= 0x8000 ? 0x8000 - wanted : wanted;
}

void FeetechPeer::live(State& servo, std::int64_t now_ns) noexcept {
  const auto turn_until = [&servo](std::int64_t at_ns) {
    servo.largest = std::max(servo.largest, std::abs(current(servo)));
    servo.joint.advance(at_ns, static_cast<double>(current(servo)) * torque_of_one_Nm);
  };
  if (!servo.broke && servo.fault_from_ns <= now_ns) {
    if (servo.fault == ServoFault::power_cycle) {
      turn_until(servo.fault_from_ns);
      servo.broke = true;
      servo.off_until_ns = servo.fault_from_ns + off_ns;
      boot(servo);
    } else if (servo.fault == ServoFault::hot) {
      turn_until(servo.fault_from_ns);
      servo.broke = true;
      servo.table[condition] |= hot_bit;
      servo.table[heat] = 81;
      servo.table[power] = 0;
    }
  }
  turn_until(now_ns);
  if (std::abs(current(servo)) > get(servo, protection)) {
    servo.table[condition] |= current_bit;
    servo.table[power] = 0;
  }
  const double steps_per_rad = 4096.0 / turn_rad;
  const double steps = std::floor(servo.joint.position_rad * steps_per_rad + 0.5) - homing_steps(get(servo, homing));
  put(servo, position, static_cast<std::int64_t>(steps - 4096.0 * std::floor(steps / 4096.0)));
  const double unit_rad_per_s = servo.takes_current ? 0.732 * turn_rad / 60.0 : 1.0 / steps_per_rad;
  put(servo, velocity, with_sign_bit(std::lround(servo.joint.velocity_rad_per_s / unit_rad_per_s)));
  put(servo, amperes, with_sign_bit(current(servo)));
}

void FeetechPeer::advance(std::int64_t now_ns) noexcept {
  for (State& servo : servos_) live(servo, now_ns);
}

bool FeetechPeer::answers(const State& servo, std::int64_t now_ns) noexcept {
  if (now_ns < servo.off_until_ns) return false;
  return servo.fault != ServoFault::silence || now_ns < servo.fault_from_ns;
}

std::int64_t FeetechPeer::delay_ns(const State& servo) noexcept {
  return servo.takes_current ? 0 : 2000 * servo.table[delay];
}

FeetechPeer::State* FeetechPeer::find(std::uint8_t id) noexcept {
  const auto found = std::ranges::find_if(servos_, [id](const State& servo) { return servo.table[own_id] == id; });
  return found == servos_.end() ? nullptr : &*found;
}

bool FeetechPeer::has_power(std::size_t servo) const noexcept { return servos_[servo].table[power] != 0; }

Check FeetechPeer::inject(const WrittenFault& fault, std::int64_t now_ns) {
  return inject_into(
      servos_, [](const State& servo) { return servo.table[own_id]; }, fault, began_, now_ns);
}

void FeetechPeer::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept {
  if (!began_) {
    began_ = true;
    for (State& servo : servos_) servo.fault_from_ns += now_ns;
  }
  line_.echo(bytes, now_ns);
  for (const std::uint8_t byte : bytes) {
    // Two header bytes, then an id that is none.
    if (came_size_ < 2 && byte != 0xff) {
      came_size_ = 0;
      continue;
    }
    if (came_size_ == 2 && byte == 0xff) continue;
    came_[came_size_++] = byte;
    if (came_size_ < 4) continue;
    const std::size_t size = std::size_t{came_[3]} + 4;
    if (came_[3] < 2) {
      came_size_ = 0;
    } else if (came_size_ == size) {
      came_size_ = 0;
      unsigned sum = 0;
      for (std::size_t i = 2; i < size; ++i) sum += came_[i];
      if (sum % 256 == 255) packet_came(Bytes(came_).first(size), now_ns);
    }
  }
}

void FeetechPeer::packet_came(Bytes packet, std::int64_t now_ns) noexcept {
  advance(now_ns);
  const std::uint8_t instruction = packet[4];
  const Bytes given = packet.subspan(5, packet.size() - 6);
  if (packet[2] != all) {
    State* servo = find(packet[2]);
    if (servo == nullptr || now_ns < servo->off_until_ns) return;
    if (instruction == 0x03 && given.size() >= 2) write(*servo, given, now_ns);
    if (!answers(*servo, now_ns)) return;
    const std::int64_t at_ns = now_ns + delay_ns(*servo);
    if (instruction == 0x01 || (instruction == 0x03 && servo->table[level] != 0)) status(*servo, {}, at_ns);
    if (instruction == 0x02 && given.size() == 2 && given[0] + given[1] <= static_cast<int>(table_bytes)) {
      status(*servo, Bytes(servo->table).subspan(given[0], given[1]), at_ns);
    }
    return;
  }
  if (instruction == 0x01) {
    // One after the other, which is how a whole line is looked at in one go.
    std::int64_t at_ns = now_ns;
    for (const State& servo : servos_) {
      if (!answers(servo, now_ns)) continue;
      at_ns += delay_ns(servo);
      status(servo, {}, at_ns);
      at_ns += std::int64_t{6} * 10 * 1'000'000'000 / bits_per_s_;
    }
  }
  if (instruction == 0x83 && given.size() > 2 && given[1] > 0) {
    const std::size_t stride = std::size_t{given[1]} + 1;
    for (Bytes rest = given.subspan(2); rest.size() >= stride; rest = rest.subspan(stride)) {
      State* servo = find(rest[0]);
      if (servo == nullptr || now_ns < servo->off_until_ns) continue;
      std::array<std::uint8_t, 256> one{given[0]};
      std::copy_n(rest.begin() + 1, stride - 1, one.begin() + 1);
      write(*servo, Bytes(one).first(stride), now_ns);
    }
  }
  if (instruction == 0x82 && given.size() > 2 && given[0] + given[1] <= static_cast<int>(table_bytes)) {
    std::int64_t at_ns = now_ns;
    for (const std::uint8_t id : given.subspan(2)) {
      const State* servo = find(id);
      if (servo != nullptr && answers(*servo, now_ns)) {
        at_ns += delay_ns(*servo);
        status(*servo, Bytes(servo->table).subspan(given[0], given[1]), at_ns);
      }
      at_ns += std::int64_t{6 + given[1]} * 10 * 1'000'000'000 / bits_per_s_;  // empty where it is silent
    }
  }
}

/// What may not be written stays as it is; the answer does not tell.
void FeetechPeer::write(State& servo, Bytes address_and_data, std::int64_t now_ns) noexcept {
  std::size_t address = address_and_data[0];
  for (const std::uint8_t byte : address_and_data.subspan(1)) {
    const bool writable = (address >= lasting_from && address < position) || (address >= 80 && address < table_bytes);
    // Who is hot or takes too much stays off until it was without power.
    const bool stays = address == power && byte == 0 && suffers(servo, ServoFault::ignores_disable, now_ns);
    const bool refused = stays || (address == power && byte != 0 && servo.table[condition] != 0);
    if (writable && !refused) servo.table[address] = byte;
    if (writable && address < lasting_bytes && servo.table[lock] == 0) servo.lasting[address] = byte;
    ++address;
  }
}

void FeetechPeer::status(const State& servo, Bytes data, std::int64_t at_ns) noexcept {
  std::array<std::uint8_t, 6 + table_bytes> packet{0xff, 0xff, servo.table[own_id],
                                                   static_cast<std::uint8_t>(data.size() + 2), servo.table[condition]};
  if (suffers(servo, ServoFault::error, at_ns)) packet[4] = servo.error;
  std::copy(data.begin(), data.end(), packet.begin() + 5);
  unsigned sum = 0;
  for (std::size_t i = 2; i < 5 + data.size(); ++i) sum += packet[i];
  packet[5 + data.size()] = static_cast<std::uint8_t>(255 - sum % 256);
  line_.answer(Bytes(packet).first(6 + data.size()), at_ns, servo.fault);
}

}  // namespace tactus::emulation::feetech
