// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/servo/servo_bus.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::devices {

namespace servo {
namespace {

/// How often a silent servo is asked again: each time the others wait for it.
constexpr std::int64_t again_ns = 50'000'000;
/// How often all are told to switch off where the bus is refused.
constexpr int most_refusals = 5;
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
  if (servo.reading.enabled == 0 || !may_have_power(servo)) return 0;
  const double units = servo.wanted.torque_Nm / (servo.model.torque_Nm_per_A * servo.model.current_unit_A);
  const auto limit = static_cast<double>(servo.limit);
  return std::llround(std::clamp(units, -limit, limit));
}

bool ServoBus::anybody_may_have_power() const noexcept {
  return std::any_of(servos_.begin(), servos_.begin() + static_cast<std::ptrdiff_t>(count_), may_have_power);
}

void ServoBus::fail(Servo& servo, MotorFault fault) noexcept {
  if (servo.reading.fault == MotorFault::none) servo.reading.fault = fault;
}

void ServoBus::ails(std::size_t motor, MotorFault fault) noexcept {
  Servo& servo = servos_[motor];
  // An alert for which the servo gives no reason; once is not enough, the reason may have passed meanwhile.
  if (fault == MotorFault::none && servo.alert && ++servo.empty_looks > 1) fault = MotorFault::unknown_status;
  if (servo.ails == MotorFault::none && fault != MotorFault::none) servo.looks = 0xff;
  servo.ails = fault;
  // What ails it says more than that it lost power or did not answer for it.
  if (fault != MotorFault::none && servo.reading.fault != MotorFault::stays_on) servo.reading.fault = fault;
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
  if (motor == count_ || waiting_ == Waiting::nothing || waiting_ == Waiting::rest) return;
  if (waiting_ == Waiting::second_answer) {
    // Where it was asked again, both answers may be of one servo.
    if (motor == errand_.motor && asked_once_) found_wrong(Wrong::twice, 0);
    return;
  }
  Servo& servo = servos_[motor];
  servo.status.error = answer.error;
  servo.reading.status = servo.status.number();
  servo.spoke = true;
  servo.alert = answer.alert;
  if (!answer.alert) servo.empty_looks = 0;
  if (answer.refusal != 0 && !knows_refusal(answer.refusal)) fail(servo, MotorFault::unknown_status);
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

/// Whether one that is to have no power has kept it for too long.
void ServoBus::judge_power(Servo& servo) noexcept {
  if (!may_have_power(servo) && servo.off.stays_on(now_ns_)) servo.reading.fault = MotorFault::stays_on;
}

void ServoBus::reported_power(Servo& servo, bool off) noexcept {
  servo.off.reported(off);
  servo.reading.off = servo.off.confirmed() ? 1 : 0;
  if (servo.off.confirmed()) servo.reading.enabled = 0;
  judge_power(servo);
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
  if (now_ns_ - servo.reading.received_ns > table_.silence_ns / 2) servo.looks = 0xff;
  servo.reading.received_ns = now_ns_;
  ++servo.reading.answers;
}

void ServoBus::wait(Waiting for_what, std::size_t answer_bytes) noexcept {
  const auto bits = 10 * (said_bytes_ + static_cast<std::int64_t>(packet_.size() + answer_bytes));
  said_bytes_ = 0;
  waiting_ = for_what;
  deadline_ns_ = now_ns_ + bits * 1'000'000'000 / bits_per_s_ + reply_timeout_ns;
}

std::int64_t ServoBus::wakes_ns() const noexcept {
  if (waiting_ != Waiting::nothing) return deadline_ns_;
  return state_ == BusState::refused && refused_said_ == servo::most_refusals ? wire::never_ns : now_ns_;
}

std::span<const std::uint8_t> ServoBus::say(std::int64_t now_ns) noexcept {
  now_ns_ = now_ns;
  if (waiting_ != Waiting::nothing) {
    if (now_ns < deadline_ns_) return {};
    give_up();
    if (waiting_ == Waiting::second_answer || waiting_ == Waiting::rest) waiting_ = Waiting::nothing;
    if (waiting_ == Waiting::states) cycle_ended();
    if (waiting_ == Waiting::errand) errand_failed(Wrong::silent, 0);
    if (waiting_ == Waiting::rest) return {};
  }
  if (state_ == BusState::asking) {
    const auto question = ask();
    if (!question.empty()) return question;
  }
  if (state_ == BusState::ready) return cycle();
  return refuse();
}

/// Nobody answers to it, so it is said several times.
std::span<const std::uint8_t> ServoBus::refuse() noexcept {
  if (refused_said_ == servo::most_refusals) return {};
  ++refused_said_;
  packet_ = write_all(table_.power, std::array<std::int64_t, most_servos>{}, everybody);
  wait(Waiting::rest, 0);
  return sent();
}

std::span<const std::uint8_t> ServoBus::cycle() noexcept {
  if (part_ == Part::power_off) {
    part_ = Part::errand;
    const auto power_off = say_power_off();
    if (!power_off.empty()) return power_off;
  }
  if (part_ == Part::errand) {
    part_ = Part::goals;
    const auto errand = next_errand();
    if (!errand.empty()) return errand;
  }
  if (part_ == Part::goals) {
    part_ = Part::states;
    std::array<std::int64_t, most_servos> goals{};
    for (std::size_t i = 0; i < count_; ++i) {
      goals[i] = goal(servos_[i]);
    }
    packet_ = write_all(table_.goal, goals, everybody);
    said_bytes_ += static_cast<std::int64_t>(packet_.size());
    if (packet_.size() > 0) return sent();
  }
  ask_for_states();
  packet_ = read_states();
  wait(Waiting::states, states_bytes());
  return sent();
}

/// To all that are to have no power and have not reported that they have none.
std::span<const std::uint8_t> ServoBus::say_power_off() noexcept {
  Whom whom = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    Servo& servo = servos_[i];
    if (may_have_power(servo)) continue;
    servo.step = servo.tries = 0;
    if (servo.off.confirmed()) continue;
    servo.off.told(now_ns_);
    whom |= Whom{1} << i;
  }
  if (whom == 0) return {};
  packet_ = write_all(table_.power, std::array<std::int64_t, most_servos>{}, whom);
  said_bytes_ += static_cast<std::int64_t>(packet_.size());
  return sent();
}

/// A servo that does not switch off when it is told to may have a watchdog that does, if nobody says anything. The look
/// at its power comes first after that.
void ServoBus::rest_if_useful() noexcept {
  if (table_.rest_ns == 0 || anybody_may_have_power()) return;
  const auto stays_on = [](const Servo& servo) {
    return servo.reading.fault == MotorFault::stays_on && !servo.off.confirmed();
  };
  if (!std::any_of(servos_.begin(), servos_.begin() + static_cast<std::ptrdiff_t>(count_), stays_on)) return;
  waiting_ = Waiting::rest;
  deadline_ns_ = now_ns_ + table_.rest_ns;
}

void ServoBus::ask_for_states() noexcept {
  const bool again = now_ns_ - asked_again_ns_ >= servo::again_ns;
  if (again) asked_again_ns_ = now_ns_;
  missing_ = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    servos_[i].heard = servos_[i].answered = servos_[i].spoke = false;
    servos_[i].asked = again || servos_[i].missed < most_tries;
    if (servos_[i].asked) asked_ids_[missing_++] = servos_[i].id;
  }
  for (std::size_t i = 0; missing_ == 0 && i < count_; ++i) servos_[i].asked = true;  // all are silent
  if (missing_ == 0) std::copy_n(ids_.begin(), missing_ = count_, asked_ids_.begin());
  asked_count_ = missing_;
}

void ServoBus::cycle_ended() noexcept {
  waiting_ = Waiting::nothing;
  part_ = Part::power_off;
  looks_at_power_ = 0;
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
      servo.owed = servo.answered ? 0 : std::min(servo.owed + 1, most_tries);
    }
    // Once is not enough: where this program stood still, it was not the servo that was silent.
    if (servo.missed > 1 && now_ns_ - servo.reading.received_ns > table_.silence_ns) {
      fail(servo, servo.spoke ? MotorFault::refused : MotorFault::not_responding);
    }
    judge_power(servo);
    const bool gone = servo.answered && servo.ails == MotorFault::none && servo.looks == 0;
    const bool for_good = servo.reading.fault == MotorFault::stays_on;
    if (gone && servo.off.confirmed() && !wants_power(servo) && !for_good) servo.reading.fault = MotorFault::none;
  }
  read_ended(missing_ == 0);
  rest_if_useful();
  if (cycles_ % servo::cycles_per_look != 0) return;
  const std::size_t looks = table_.looks.size() - table_.announced;
  servos_[look_turn_ / looks % count_].looks |=
      static_cast<std::uint8_t>(1U << (table_.announced + look_turn_ % looks));
  ++look_turn_;
}

}  // namespace tactus::devices
