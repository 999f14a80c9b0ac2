#include <tactus/devices/servo/servo_bus.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::devices {

namespace servo {
namespace {

/// Beyond the time of the bytes: a USB adapter collects for a millisecond and hands over in the next frame.
constexpr std::int64_t patience_ns = 2'000'000;
/// How often a silent servo is asked again: each time the others wait for it.
constexpr std::int64_t again_ns = 50'000'000;
/// How often a servo is asked in a row before it counts as one that does not answer.
constexpr std::size_t most_tries = 10;
/// One look at one servo in so many cycles: a cycle with a look is a sixth longer, and few may be.
constexpr std::int64_t cycles_per_look = 256;

}  // namespace
}  // namespace servo

void ServoBus::add(std::uint8_t id, const ServoModel& model, std::span<const ServoStep> asking) {
  Servo& servo = servos_[count_];
  servo.id = ids_[count_] = id;
  servo.model = model;
  servo.asking = asking;
  servo.limit = model.current_limit;
  ++count_;
}

bool ServoBus::wants_power(const Servo& servo) noexcept {
  return servo.model.current_limit > 0 && servo.wanted.enabled != 0 && std::isfinite(servo.wanted.torque_Nm);
}

void ServoBus::command(std::size_t motor, const MotorCommand& wanted) noexcept {
  Servo& servo = servos_[motor];
  servo.wanted = wanted;
  if (wanted.law.acts()) servo.wanted.enabled = 0;
  const double amperes = std::fabs(wanted.torque_Nm) / servo.model.torque_Nm_per_A;
  if (amperes > (static_cast<double>(servo.limit) + 0.5) * servo.model.current_unit_A) ++limited_;
}

std::int64_t ServoBus::goal(const Servo& servo) noexcept {
  if (servo.reading.enabled == 0 || servo.reading.fault != MotorFault::none || !wants_power(servo)) return 0;
  const double units = servo.wanted.torque_Nm / (servo.model.torque_Nm_per_A * servo.model.current_unit_A);
  const auto limit = static_cast<double>(servo.limit);
  return std::llround(std::clamp(units, -limit, limit));
}

void ServoBus::fail(Servo& servo, MotorFault fault) noexcept {
  if (servo.reading.fault == MotorFault::none) servo.reading.fault = fault;
}

void ServoBus::ails(std::size_t motor, MotorFault fault) noexcept {
  Servo& servo = servos_[motor];
  if (servo.ails == MotorFault::none && fault != MotorFault::none) servo.looks = 0xff;
  servo.ails = fault;
  // What ails it says more than that it lost power or did not answer for it.
  if (fault != MotorFault::none) servo.reading.fault = fault;
}

void ServoBus::lost_power(std::size_t motor, MotorFault fault) noexcept { fail(servos_[motor], fault); }

void ServoBus::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  for (const std::uint8_t byte : bytes) {
    // What an adapter sends back of the question is no noise. What turns out to be an answer ends this errand.
    const bool echo = heard_bytes_ < packet_.size() && packet_.bytes()[heard_bytes_] == byte;
    if (!echo) heard_noise_ = true;
    ++heard_bytes_;
  }
  find(bytes);
}

void ServoBus::heard(const Answer& answer) noexcept {
  const auto found = std::find(ids_.begin(), ids_.begin() + static_cast<std::ptrdiff_t>(count_), answer.id);
  const auto motor = static_cast<std::size_t>(found - ids_.begin());
  if (motor == count_ || waiting_ == Waiting::nothing) return;
  if (waiting_ == Waiting::second_answer) {
    // Where it was asked again, both answers may be of one servo.
    if (motor == errand_.motor && asked_once_) found_wrong(Wrong::twice, 0);
    return;
  }
  Servo& servo = servos_[motor];
  if (answer.alert != (servo.ails != MotorFault::none)) servo.looks |= 1;  // else it is known
  if (waiting_ == Waiting::errand) {
    if (motor != errand_.motor) return;
    if (answer.refusal != 0) return errand_failed(Wrong::refused, answer.refusal);
    if (answer.data.size() != (errand_.reads ? errand_.place.bytes : 0U)) return;  // late, of another question
    return errand_answered(answer.data);
  }
  State state{};
  if (!servo.asked || servo.answered || answer.refusal != 0 || !read_state(motor, answer.data, state)) return;
  take(servo, state);
  servo.heard = true;
  // What is late must not be taken for the answer to this cycle: each answer would be a cycle old from then on.
  if (servo.owed > 0) {
    --servo.owed;
    return;
  }
  servo.answered = true;
  if (--missing_ == 0) cycle_ended();
}

void ServoBus::take(Servo& servo, const State& state) noexcept {
  constexpr double turn_rad = 2.0 * std::numbers::pi;
  const std::int64_t wrap = table_.steps_until_wrap;
  if (servo.placed) {
    std::int64_t moved = (state.position - servo.last) % wrap;
    if (moved >= wrap / 2) moved -= wrap;
    if (moved < -wrap / 2) moved += wrap;
    servo.place += moved;
  } else {
    servo.place = state.position;
    servo.placed = true;
  }
  servo.last = state.position;
  answered(servo);
  MotorReading& reading = servo.reading;
  reading.position_rad = static_cast<double>(servo.place) * (turn_rad / static_cast<double>(table_.steps_per_turn));
  reading.velocity_rad_per_s = static_cast<double>(state.velocity) * servo.model.velocity_unit_rad_per_s;
  reading.torque_Nm = static_cast<double>(state.current) * servo.model.current_unit_A * servo.model.torque_Nm_per_A;
  if (!std::isnan(state.temperature_C)) reading.temperature_C = state.temperature_C;
}

void ServoBus::answered(Servo& servo) noexcept {
  // It may have been without power meanwhile, or its watchdog may have let go.
  if (now_ns_ - servo.reading.heard_ns > table_.silence_ns / 2) servo.looks = 0xff;
  servo.reading.heard_ns = now_ns_;
  ++servo.reading.answers;
}

void ServoBus::wait(Waiting for_what, std::size_t answer_bytes) noexcept {
  const auto bits = 10 * (said_bytes_ + static_cast<std::int64_t>(packet_.size() + answer_bytes));
  said_bytes_ = 0;
  waiting_ = for_what;
  deadline_ns_ = now_ns_ + bits * 1'000'000'000 / bits_per_s_ + servo::patience_ns;
}

std::int64_t ServoBus::wakes_ns() const noexcept {
  if (waiting_ != Waiting::nothing) return deadline_ns_;
  return state_ == BusState::refused && refused_said_ ? wire::never_ns : now_ns_;
}

std::span<const std::uint8_t> ServoBus::say(std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (waiting_ != Waiting::nothing) {
    if (now_ns < deadline_ns_) return {};
    give_up();
    if (waiting_ == Waiting::second_answer) waiting_ = Waiting::nothing;
    if (waiting_ == Waiting::states) cycle_ended();
    if (waiting_ == Waiting::errand) errand_failed(Wrong::silent, 0);
  }
  if (state_ == BusState::asking) {
    const auto question = ask();
    if (!question.empty()) return question;
  }
  if (state_ == BusState::ready) return cycle();
  if (refused_said_) return {};
  refused_said_ = true;
  packet_ = write_all(table_.power, std::array<std::int64_t, most_servos>{});
  return sent();
}

std::span<const std::uint8_t> ServoBus::send_errand(const Errand& errand, std::int64_t value) noexcept {
  errand_ = errand;
  const std::uint8_t id = servos_[errand.motor].id;
  packet_ = errand.reads ? read(id, errand.place) : write(id, errand.place, value);
  heard_bytes_ = 0;
  wait(Waiting::errand, answer_bytes(errand.reads ? errand.place.bytes : 0U));
  // Each time longer, for nothing is driven yet: this program or the adapter may stand still for a moment.
  if (errand.purpose == Purpose::asking) {
    deadline_ns_ += static_cast<std::int64_t>(servos_[errand.motor].tries) * servo::patience_ns;
  }
  return sent();
}

std::span<const std::uint8_t> ServoBus::ask() noexcept {
  if (hushed_ < table_.hush.size()) {
    const ServoStep& step = table_.hush[hushed_++];
    std::array<std::int64_t, most_servos> values{};
    values.fill(step.value);
    packet_ = write_all(step.place, values);
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

std::span<const std::uint8_t> ServoBus::cycle() noexcept {
  if (errand_turn_) {
    errand_turn_ = false;
    const auto errand = next_errand();
    if (!errand.empty()) return errand;
  }
  if (!read_due_) {
    std::array<std::int64_t, most_servos> goals{};
    for (std::size_t i = 0; i < count_; ++i) {
      goals[i] = goal(servos_[i]);
    }
    packet_ = write_all(table_.goal, goals);
    read_due_ = true;
    said_bytes_ += static_cast<std::int64_t>(packet_.size());
    if (packet_.size() > 0) return sent();
  }
  read_due_ = false;
  ask_for_states();
  packet_ = read_states();
  wait(Waiting::states, states_bytes());
  return sent();
}

void ServoBus::ask_for_states() noexcept {
  const bool again = now_ns_ - asked_again_ns_ >= servo::again_ns;
  if (again) asked_again_ns_ = now_ns_;
  missing_ = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    servos_[i].heard = servos_[i].answered = false;
    servos_[i].asked = again || servos_[i].missed < servo::most_tries;
    if (servos_[i].asked) asked_ids_[missing_++] = servos_[i].id;
  }
  for (std::size_t i = 0; missing_ == 0 && i < count_; ++i) servos_[i].asked = true;  // all are silent
  if (missing_ == 0) std::copy_n(ids_.begin(), missing_ = count_, asked_ids_.begin());
  asked_count_ = missing_;
}

void ServoBus::cycle_ended() noexcept {
  waiting_ = Waiting::nothing;
  errand_turn_ = true;
  ++cycles_;
  for (std::size_t i = 0; i < count_; ++i) {
    Servo& servo = servos_[i];
    // What is lost is waited for once.
    if (servo.heard && !servo.answered) {
      servo.answered = true;
      servo.owed = 0;
      --missing_;
    }
    if (servo.asked) {
      servo.missed = servo.answered ? 0 : servo.missed + 1;
      servo.owed = servo.answered ? 0 : std::min(servo.owed + 1, servo::most_tries);
    }
    // Once is not enough: where this program stood still, it was not the servo that was silent.
    if (servo.missed > 1 && now_ns_ - servo.reading.heard_ns > table_.silence_ns) fail(servo, MotorFault::silent);
    const bool gone = servo.answered && servo.ails == MotorFault::none && servo.looks == 0;
    if (gone && !servo.power && !wants_power(servo)) servo.reading.fault = MotorFault::none;
  }
  read_ended(missing_ == 0);
  if (cycles_ % servo::cycles_per_look != 0) return;
  const std::size_t looks = table_.looks.size() - table_.announced;
  servos_[look_turn_ / looks % count_].looks |=
      static_cast<std::uint8_t>(1U << (table_.announced + look_turn_ % looks));
  ++look_turn_;
}

std::span<const std::uint8_t> ServoBus::next_errand() noexcept {
  // Whose power must go comes before all others; who did not answer the cycle would not answer now.
  const std::size_t turn = turn_;
  for (std::size_t k = 0; k < count_; ++k) {
    const std::size_t i = (turn + k) % count_;
    const Servo& servo = servos_[i];
    if (!servo.answered || !servo.power || (wants_power(servo) && servo.reading.fault == MotorFault::none)) continue;
    turn_ = i + 1;
    return send_errand({Purpose::power_off, i, table_.power, false, 0}, 0);
  }
  for (std::size_t k = 0; k < count_; ++k) {
    const std::size_t i = (turn + k) % count_;
    Servo& servo = servos_[i];
    if (!servo.answered) continue;
    turn_ = i + 1;
    for (std::size_t look = 0; look < table_.looks.size(); ++look) {
      if ((servo.looks >> look & 1U) != 0) return send_errand({Purpose::look, i, table_.looks[look], true, look}, 0);
    }
    servo.looks = 0;  // also those that this make does not have
    const bool may = wants_power(servo) && servo.reading.fault == MotorFault::none;
    if (!may) servo.step = servo.tries = 0;
    if (!may || servo.reading.enabled != 0) continue;
    const ServoStep& step = table_.enabling[servo.step];
    // From now on it may have power, whether or not it says so.
    if (servo.step + 1 == table_.enabling.size()) servo.power = true;
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
      if (errand_.reads && step.kind == ServoStep::Kind::check) wrong = check(errand_.motor, errand_.place, value);
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
        deadline_ns_ = now_ns_ + servo::patience_ns;
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
      servo.power = false;
      servo.reading.enabled = 0;
      return;
    case Purpose::look:
      servo.looks = static_cast<std::uint8_t>(servo.looks & ~(1U << errand_.which));
      return looked(errand_.motor, errand_.place, value);
  }
}

void ServoBus::errand_failed(Wrong how, std::uint8_t code) noexcept {
  waiting_ = Waiting::nothing;
  Servo& servo = servos_[errand_.motor];
  switch (errand_.purpose) {
    case Purpose::asking:
      if (how == Wrong::silent && ++servo.tries < servo::most_tries) return;
      return found_wrong(how == Wrong::silent && heard_noise_ ? Wrong::garbled : how, code);
    case Purpose::enabling:
      if (how == Wrong::silent && ++servo.tries < servo::most_tries) return;
      return fail(servo, MotorFault::refused);
    case Purpose::power_off:
      return;  // until it is off
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
  if (wrong == Wrong::silent || wrong == Wrong::garbled) fail(servo, MotorFault::silent);
  if (wrong == Wrong::refused) fail(servo, MotorFault::refused);
  ask_next(false);
}

}  // namespace tactus::devices
