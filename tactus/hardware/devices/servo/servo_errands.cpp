// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/servo/servo_bus.hpp>

#include <algorithm>

/// Questions to one servo at a time: before the bus is ready, and between its cycles.
namespace tactus::devices {

std::span<const std::uint8_t> ServoBus::send_errand(const Errand& errand, std::int64_t value) noexcept {
  errand_ = errand;
  const std::uint8_t id = servos_[errand.motor].id;
  packet_ = errand.reads ? read(id, errand.place) : write(id, errand.place, value);
  heard_bytes_ = 0;
  wait(Waiting::errand, answer_bytes(errand.reads ? errand.place.bytes : 0U));
  // Each time longer, for nothing is driven yet: this program or the adapter may stand still for a moment.
  if (errand.purpose == Purpose::asking) {
    deadline_ns_ += static_cast<std::int64_t>(servos_[errand.motor].tries) * reply_timeout_ns;
  }
  return sent();
}

std::span<const std::uint8_t> ServoBus::ask() noexcept {
  if (hushed_ < table_.hush.size()) {
    const ServoStep& step = table_.hush[hushed_++];
    std::array<std::int64_t, most_servos> values{};
    values.fill(step.value);
    packet_ = write_all(step.place, values, everybody);
    said_bytes_ += static_cast<std::int64_t>(packet_.size());
    return sent();
  }
  if (asked_ < count_) {
    const ServoStep& step = servos_[asked_].asking[asked_step_];
    const bool reads = step.kind != ServoStep::Kind::write && !keeping_;
    if (servos_[asked_].tries == 0) heard_noise_ = false;
    return send_errand({Purpose::asking, asked_, step.place, reads, asked_step_}, step.value);
  }
  const bool right = std::all_of(servos_.begin(), servos_.begin() + static_cast<std::ptrdiff_t>(count_),
                                 [](const Servo& servo) { return servo.wrong == Wrong::nothing; });
  state_ = right ? BusState::ready : BusState::refused;
  for (Servo& servo : servos_) servo.looks = 0xff;
  return {};
}

void ServoBus::ask_next(bool same_servo) noexcept {
  keeping_ = false;
  servos_[asked_].tries = 0;
  if (same_servo && ++asked_step_ < servos_[asked_].asking.size()) return;
  asked_step_ = 0;
  ++asked_;
}

void ServoBus::looked_at_power(Servo& servo, std::int64_t value) noexcept {
  servo.status.power = static_cast<std::uint8_t>(value);
  servo.reading.status = servo.status.number();
  reported_power(servo, value == 0);
}

/// Of one that is to have no power and was told so. Who said nothing in the cycle would say nothing now.
std::span<const std::uint8_t> ServoBus::next_look_at_power() noexcept {
  const std::size_t turn = turn_;
  for (std::size_t k = 0; k < count_; ++k) {
    const std::size_t i = (turn + k) % count_;
    const Servo& servo = servos_[i];
    if (!servo.spoke || may_have_power(servo) || servo.off.confirmed()) continue;
    // One that stays on leaves the others their turn.
    if (servo.reading.fault == MotorFault::stays_on && cycles_ % cycles_per_late_look != 0) continue;
    turn_ = i + 1;
    ++looks_at_power_;
    return send_errand({Purpose::power_off, i, table_.power, true, 0}, 0);
  }
  return {};
}

std::span<const std::uint8_t> ServoBus::next_errand() noexcept {
  // Whose power must go comes before all others.
  if (const auto look = next_look_at_power(); !look.empty()) return look;
  const std::size_t turn = turn_;
  for (std::size_t k = 0; k < count_; ++k) {
    const std::size_t i = (turn + k) % count_;
    Servo& servo = servos_[i];
    if (!servo.answered) continue;
    turn_ = i + 1;
    for (std::size_t look = 0; look < table_.looks.size(); ++look) {
      if ((servo.looks >> look & 1U) != 0) return send_errand({Purpose::look, i, table_.looks[look], true, look}, 0);
    }
    servo.looks = 0;  // also those that this make does not have
    if (!may_have_power(servo) || servo.reading.enabled != 0) continue;
    const ServoStep& step = table_.enabling[servo.step];
    // From now on it may have power, whether or not it says so.
    if (servo.step + 1 == table_.enabling.size()) {
      servo.off.start_over();
      servo.reading.off = 0;
    }
    return send_errand({Purpose::enabling, i, step.place, false, servo.step}, step.value);
  }
  return {};
}

void ServoBus::errand_answered(std::span<const std::uint8_t> data) noexcept {
  waiting_ = Waiting::nothing;
  Servo& servo = servos_[errand_.motor];
  answered(servo);
  const std::int64_t value = little_endian(data);
  switch (errand_.purpose) {
    case Purpose::asking: {
      const ServoStep& step = servo.asking[errand_.which];
      Wrong wrong = Wrong::nothing;
      if (errand_.place.address == table_.power.address) {
        if (!errand_.reads) servo.off.told(now_ns_);
        if (errand_.reads) looked_at_power(servo, value);
        if (errand_.reads && value != 0) wrong = Wrong::stays_on;
      } else if (errand_.reads && step.kind == ServoStep::Kind::check) {
        wrong = check(errand_.motor, errand_.place, value);
      }
      if (wrong != Wrong::nothing) return found_wrong(wrong, value);
      if (errand_.reads && step.kind == ServoStep::Kind::keep && value != step.value) {
        keeping_ = true;
        return;
      }
      asked_once_ = servo.tries == 0;
      ask_next(true);
      if (errand_.which == 0) {
        // Another servo with this id answers too; later its answer would be taken for that to another question.
        waiting_ = Waiting::second_answer;
        deadline_ns_ = now_ns_ + reply_timeout_ns;
      }
      return;
    }
    case Purpose::enabling:
      servo.tries = 0;
      if (++servo.step < table_.enabling.size()) return;
      servo.step = 0;
      servo.reading.enabled = 1;
      return;
    case Purpose::power_off:
      looked_at_power(servo, value);
      // Where nobody is driven, the next one need not wait for a cycle.
      if (looks_at_power_ < 2 * count_ && !anybody_may_have_power()) part_ = Part::errand;
      return;
    case Purpose::look:
      servo.looks = static_cast<std::uint8_t>(servo.looks & ~(1U << errand_.which));
      if (errand_.place.address == table_.power.address) looked_at_power(servo, value);
      return looked(errand_.motor, errand_.place, value);
  }
}

void ServoBus::errand_failed(Wrong how, std::uint8_t code) noexcept {
  waiting_ = Waiting::nothing;
  Servo& servo = servos_[errand_.motor];
  switch (errand_.purpose) {
    case Purpose::asking:
      if (how == Wrong::silent && ++servo.tries < most_tries) return;
      return found_wrong(how == Wrong::silent && heard_noise_ ? Wrong::garbled : how, code);
    case Purpose::enabling:
      if (how == Wrong::silent && ++servo.tries < most_tries) return;
      return fail(servo, MotorFault::refused);
    case Purpose::power_off:
      // It spoke, and did not say that it is off.
      if (how == Wrong::refused) reported_power(servo, false);
      return;
    case Purpose::look:
      if (how == Wrong::refused) servo.looks = static_cast<std::uint8_t>(servo.looks & ~(1U << errand_.which));
      return;
  }
}

void ServoBus::found_wrong(Wrong wrong, std::int64_t value) noexcept {
  waiting_ = Waiting::nothing;
  Servo& servo = servos_[asked_];
  servo.wrong = wrong;
  servo.found = value;
  servo.found_at = errand_.place;
  if (wrong == Wrong::silent || wrong == Wrong::garbled) fail(servo, MotorFault::not_responding);
  if (wrong == Wrong::refused) fail(servo, MotorFault::refused);
  if (wrong == Wrong::stays_on) fail(servo, MotorFault::stays_on);
  ask_next(false);
}

}  // namespace tactus::devices
