// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/damiao/damiao_bus.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace tactus::devices::damiao {

namespace {

constexpr std::int64_t most_motors = 15;
/// Frames to clear a fault or to enable, before a motor counts as one that refuses.
constexpr int most_tries = 50;
/// Cycles in a row without an answer, after which the others no longer wait for it.
constexpr int missed_is_absent = 3;
constexpr std::int64_t absent_asked_every_ns = 10'000'000;
constexpr double timeout_unit_s = 50e-6;
/// So far from where its number begins anew, a motor may still hold a position: it can't come there in a cycle or two.
constexpr double near_the_end_rad = 0.5;

std::int64_t ns_of(double seconds) { return std::llround(seconds * 1e9); }

std::string key_of(std::size_t motor, const char* key) {
  return std::string("motors[") + std::to_string(motor) + "]." + key;
}

Error bad_motor(std::size_t motor, const char* key, std::string message) {
  return {.code = ErrorCode::inconsistent, .parameter = key_of(motor, key), .message = std::move(message), .place = {}};
}

Check check(const DamiaoBusParams& params) {
  if (Check error = validate(params)) return error;
  const auto count = static_cast<std::int64_t>(params.motors.size());
  if (count < 1 || count > most_motors) {
    return out_of_bounds("motors", static_cast<double>(count), between(1, most_motors), units::none);
  }
  for (std::size_t i = 0; i < params.motors.size(); ++i) {
    const MotorParams& motor = params.motors[i];
    constexpr Bounds ids = between(1, most_motors), feedback_ids = between(0, 0x7fe);
    if (!ids.contain(static_cast<double>(motor.id))) {
      return out_of_bounds(key_of(i, "id"), static_cast<double>(motor.id), ids, units::none);
    }
    if (!feedback_ids.contain(static_cast<double>(motor.feedback_id))) {
      return out_of_bounds(key_of(i, "feedback_id"), static_cast<double>(motor.feedback_id), feedback_ids, units::none);
    }
    const auto same_id = [&motor](const MotorParams& other) { return other.id == motor.id; };
    if (std::any_of(params.motors.begin(), params.motors.begin() + static_cast<std::ptrdiff_t>(i), same_id)) {
      return bad_motor(i, "id", "two motors have this identifier: give each one of its own");
    }
    const auto commanded = [&motor](const MotorParams& other) { return other.id == motor.feedback_id; };
    if (std::any_of(params.motors.begin(), params.motors.end(), commanded)) {
      return bad_motor(i, "feedback_id", "a motor takes commands with this identifier: by convention it is id + 16");
    }
  }
  return std::nullopt;
}

}  // namespace

Result<std::unique_ptr<DamiaoBus>> DamiaoBus::make(const DamiaoBusParams& params) {
  if (Check error = check(params)) return *std::move(error);
  return std::unique_ptr<DamiaoBus>(new DamiaoBus(params));
}

DamiaoBus::DamiaoBus(const DamiaoBusParams& params)
    : framing_(params.framing),
      reply_timeout_ns_(ns_of(params.reply_timeout_s)),
      shortest_cycle_ns_(ns_of(params.shortest_cycle_s)),
      silence_ns_(ns_of(params.watchdog_s)),
      ask_absent_ns_(std::min(absent_asked_every_ns, silence_ns_ / 4)),
      rest_ns_(silence_ns_ + silence_ns_ / 2),
      reader_(params.framing),
      outbox_(params.motors.size() * 128) {
  const auto timeout = static_cast<std::uint32_t>(std::lround(params.watchdog_s / timeout_unit_s));
  for (const MotorParams& motor : params.motors) {
    motors_.push_back({.params = motor,
                       .scale = scale_of(motor.model),
                       .questions = Questions(motor, timeout),
                       .reading = {.fault = MotorFault::not_responding},
                       .command = {},
                       .off = {}});
  }
}

Check DamiaoBus::problem() const {
  for (const Motor& motor : motors_) {
    if (Check found = motor.questions.problem()) return found;
  }
  return std::nullopt;
}

MotorSheet DamiaoBus::sheet(std::size_t motor) const {
  const Motor& asked = motors_[motor];
  const MotorFacts& facts = asked.questions.facts();
  MotorSheet sheet{.model = asked.questions.model_told(),
                   .scales = {},
                   .firmware = {},
                   .torque_limit_Nm = asked.scale.torque_Nm,
                   .problem = asked.questions.problem()};
  if (facts.software_version >= 0) {
    sheet.firmware = std::to_string(facts.software_version);
    sheet.scales = rounded_number(facts.position_scale_rad) + " rad, " +
                   rounded_number(facts.velocity_scale_rad_per_s) + " rad/s, " + rounded_number(facts.torque_scale_Nm) +
                   " Nm";
  }
  return sheet;
}

const MotorReading& DamiaoBus::reading(std::size_t motor) const noexcept { return motors_[motor].reading; }

void DamiaoBus::command(std::size_t motor, const MotorCommand& wanted) noexcept {
  MotorCommand& command = motors_[motor].command;
  const double most_Nm = motors_[motor].scale.torque_Nm;
  command = {};
  const MotorLaw& law = wanted.law;
  const bool numbers = std::isfinite(wanted.torque_Nm) && std::isfinite(law.position_rad) &&
                       std::isfinite(law.velocity_rad_per_s) && std::isfinite(law.stiffness_Nm_per_rad) &&
                       std::isfinite(law.damping_Nms_per_rad);
  // A negative gain would drive away what it is to hold.
  if (!numbers || law.stiffness_Nm_per_rad < 0.0 || law.damping_Nms_per_rad < 0.0) return;
  command.enabled = wanted.enabled;
  command.torque_Nm = std::clamp(wanted.torque_Nm, -most_Nm, most_Nm);
  if (!law.acts()) return;
  // Torque and law may stand against each other, so what is cut of one is cut of the other.
  double share = 1.0;
  const auto keep_within = [&share](double value, double most) {
    if (std::fabs(value) > most) share = std::min(share, most / std::fabs(value));
  };
  keep_within(wanted.torque_Nm, most_Nm);
  keep_within(law.stiffness_Nm_per_rad, largest_stiffness_Nm_per_rad);
  keep_within(law.damping_Nms_per_rad, largest_damping_Nms_per_rad);
  command.torque_Nm = share * wanted.torque_Nm;
  command.law = law;
  command.law.stiffness_Nm_per_rad *= share;
  command.law.damping_Nms_per_rad *= share;
}

void DamiaoBus::send(const CanFrame& frame, std::int64_t now_ns) noexcept {
  outbox_.put(wrap(framing_, frame).view(), now_ns);
  progress_ns_ = now_ns;
}

void DamiaoBus::hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept {
  reader_.take(bytes, [this, now_ns](const CanFrame& frame) { take(frame, now_ns); });
}

std::span<const std::uint8_t> DamiaoBus::say(std::int64_t now_ns) noexcept {
  if (outbox_.due_ns() != wire::never_ns) return outbox_.take(now_ns);
  if (state_ == BusState::asking) {
    ask(now_ns);
  } else if (state_ == BusState::ready) {
    if (in_cycle_ && (all_answered() || now_ns >= progress_ns_ + reply_timeout_ns_)) end_cycle(now_ns);
    if (!in_cycle_ && now_ns >= cycle_began_ns_ + shortest_cycle_ns_) begin_cycle(now_ns);
  }
  return outbox_.take(now_ns);
}

std::int64_t DamiaoBus::wakes_ns() const noexcept {
  if (outbox_.due_ns() != wire::never_ns) return outbox_.due_ns();
  switch (state_) {
    case BusState::asking:
      return opened_ ? motors_[asked_].questions.wakes_ns() : 0;
    case BusState::ready:
      return in_cycle_ && !all_answered() ? progress_ns_ + reply_timeout_ns_ : cycle_began_ns_ + shortest_cycle_ns_;
    case BusState::refused:
      break;
  }
  return wire::never_ns;
}

void DamiaoBus::ask(std::int64_t now_ns) noexcept {
  if (!opened_) {
    opened_ = true;
    if (const Wrapped lines = opening(framing_); lines.size > 0) {
      outbox_.put(lines.view(), now_ns);
      return;
    }
  }
  while (asked_ < motors_.size()) {
    if (const auto frame = motors_[asked_].questions.next(now_ns)) return send(*frame, now_ns);
    if (!motors_[asked_].questions.done()) return;
    ++asked_;
  }
  const bool well =
      std::all_of(motors_.begin(), motors_.end(), [](const Motor& motor) { return motor.questions.is_well(); });
  state_ = well ? BusState::ready : BusState::refused;
}

void DamiaoBus::take(const CanFrame& frame, std::int64_t now_ns) noexcept {
  if (state_ == BusState::asking) {
    if (asked_ < motors_.size()) motors_[asked_].questions.take(frame);
    return;
  }
  if (frame.size != 8) return;
  for (Motor& motor : motors_) {
    if (frame.id != motor.params.feedback_id || (frame.data[0] & 0x0f) != motor.params.id) continue;
    // Nobody asked for one, but an answer may have been late, or another program may ask.
    const auto answer = register_answer_of(frame);
    if (!answer || answer->motor != motor.params.id) take_feedback(motor, frame, now_ns);
    return;
  }
}

void DamiaoBus::take_feedback(Motor& motor, const CanFrame& frame, std::int64_t now_ns) noexcept {
  const auto told = feedback_of(frame, motor.scale);
  if (!told) return;
  MotorReading& reading = motor.reading;
  const double turn_rad = 2.0 * motor.scale.position_rad;
  if (reading.answers > 0) {
    const double silent_s = static_cast<double>(now_ns - reading.received_ns) * 1e-9;
    // It could have turned by half its range meanwhile, and its number says nothing of that.
    if (silent_s * motor.scale.velocity_rad_per_s > motor.scale.position_rad) motor.latched = MotorFault::encoder;
    motor.turns -= std::round((told->position_rad - motor.wrapped_rad) / turn_rad);
  }
  motor.wrapped_rad = told->position_rad;
  motor.off.reported(means_off(told->status));
  if (motor.owed > 0) {
    --motor.owed;
    progress_ns_ = now_ns;
  }
  motor.missed = 0;
  reading.position_rad = told->position_rad + motor.turns * turn_rad;
  reading.velocity_rad_per_s = told->velocity_rad_per_s;
  reading.torque_Nm = told->torque_Nm;
  reading.temperature_C = std::max(told->drive_C, told->winding_C);
  reading.status = told->status;
  reading.enabled = means_off(told->status) ? 0 : 1;
  reading.received_ns = now_ns;
  ++reading.answers;
  judge(motor, now_ns);
}

bool DamiaoBus::is_absent(const Motor& motor) noexcept { return motor.missed >= missed_is_absent; }

bool DamiaoBus::is_silent(const Motor& motor, std::int64_t now_ns) const noexcept {
  // Once is not enough: where this program stood still, it was not the motor that was silent.
  return motor.missed > 1 && (motor.reading.received_ns < 0 || now_ns - motor.reading.received_ns > silence_ns_);
}

/// Which fault it has, and whether that stays.
void DamiaoBus::judge(Motor& motor, std::int64_t now_ns) noexcept {
  MotorReading& reading = motor.reading;
  const bool silent = is_silent(motor, now_ns);
  const bool told = reading.status != no_status;
  const MotorFault of_status = told ? fault_of(static_cast<std::uint8_t>(reading.status)) : MotorFault::none;
  const MotorFault now = silent ? MotorFault::not_responding : of_status;
  if (motor.was_wanted && motor.latched == MotorFault::none) {
    if (reading.status == status_enabled) motor.had_power = true;
    const bool lost_power = motor.had_power && reading.status == status_disabled;
    const bool refuses = motor.tries >= most_tries;
    if (now != MotorFault::none && (motor.had_power || refuses || silent)) motor.latched = now;
    if (now == MotorFault::none && (lost_power || refuses)) motor.latched = MotorFault::refused;
  }
  if (motor.off.stays_on(now_ns)) motor.latched = MotorFault::stays_on;
  reading.off = motor.off.confirmed() ? 1 : 0;
  reading.fault = motor.latched != MotorFault::none ? motor.latched : now;
}

bool DamiaoBus::all_answered() const noexcept {
  bool any = false;
  for (const Motor& motor : motors_) {
    if (is_absent(motor)) continue;
    if (motor.owed > 0) return false;
    any = true;
  }
  return any;
}

void DamiaoBus::begin_cycle(std::int64_t now_ns) noexcept {
  in_cycle_ = true;
  cycle_began_ns_ = progress_ns_ = now_ns;
  // Absent ones first: when the others have answered, nothing is left on its way.
  for (const bool absent : {true, false}) {
    for (Motor& motor : motors_) {
      if (is_absent(motor) != absent) continue;
      if (absent && now_ns < motor.asked_again_ns) continue;
      const bool driven = drives(motor, now_ns);
      if (!driven && !motor.off.due(now_ns, rest_ns_)) continue;
      motor.asked_again_ns = now_ns + ask_absent_ns_;
      ++motor.owed;
      send(driven ? frame_that_drives(motor) : frame_that_stops(motor, now_ns), now_ns);
    }
  }
}

void DamiaoBus::end_cycle(std::int64_t now_ns) noexcept {
  in_cycle_ = false;
  ++cycles_;
  for (Motor& motor : motors_) {
    const bool asked = motor.owed > 0;
    // What is late comes in a later cycle and must not be taken for the answer to that one: each would begin too soon
    // from then on. What is lost is waited for once more.
    const bool heard = motor.reading.received_ns >= cycle_began_ns_;
    if (asked && !heard) ++motor.missed;
    if (heard || is_absent(motor)) motor.owed = 0;
    judge(motor, now_ns);
  }
}

/// Whether it is to have power now.
bool DamiaoBus::drives(Motor& motor, std::int64_t now_ns) const noexcept {
  const bool wanted = motor.command.enabled != 0;
  if (wanted && !motor.was_wanted) {
    const bool for_good = motor.latched == MotorFault::encoder || motor.latched == MotorFault::stays_on;
    if (!for_good) motor.latched = MotorFault::none;
    motor.had_power = false;
    motor.tries = 0;
  }
  motor.was_wanted = wanted;
  const bool holds = wanted && motor.command.law.stiffness_Nm_per_rad > 0.0;
  if (holds && std::fabs(motor.wrapped_rad) > motor.scale.position_rad - near_the_end_rad) {
    motor.latched = motor.reading.fault = MotorFault::encoder;
  }
  return wanted && motor.latched == MotorFault::none && !is_silent(motor, now_ns);
}

CanFrame DamiaoBus::frame_that_stops(Motor& motor, std::int64_t now_ns) noexcept {
  const auto id = static_cast<std::uint16_t>(motor.params.id);
  if (motor.off.confirmed()) return refresh_frame(id);
  motor.off.told(now_ns);
  return order_frame(id, Order::disable);
}

CanFrame DamiaoBus::frame_that_drives(Motor& motor) noexcept {
  const auto id = static_cast<std::uint16_t>(motor.params.id);
  motor.off.start_over();
  motor.reading.off = 0;
  if (motor.reading.status == status_enabled) {
    const MotorLaw& law = motor.command.law;
    const double unseen_rad = law.acts() ? motor.turns * 2.0 * motor.scale.position_rad : 0.0;
    return mit_frame(id, motor.scale,
                     {.position_rad = law.position_rad - unseen_rad,
                      .velocity_rad_per_s = law.velocity_rad_per_s,
                      .stiffness_Nm_per_rad = law.stiffness_Nm_per_rad,
                      .damping_Nms_per_rad = law.damping_Nms_per_rad,
                      .torque_Nm = motor.command.torque_Nm});
  }
  // Nobody knows what it does before it has reported.
  if (motor.reading.status == no_status) return order_frame(id, Order::disable);
  ++motor.tries;
  return order_frame(id, motor.reading.status == status_disabled ? Order::enable : Order::clear_fault);
}

}  // namespace tactus::devices::damiao
