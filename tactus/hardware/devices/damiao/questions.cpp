// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/damiao/questions.hpp>

#include <bit>
#include <cmath>
#include <string>

namespace tactus::devices::damiao {

namespace {

constexpr std::int64_t answer_ns = 20'000'000;
constexpr int most_questions = 5;
/// A scale is a float in the motor.
constexpr double equal_enough = 1e-5;

const char* name_of_register(Register which) {
  switch (which) {
    case Register::feedback_id:
      return "MST_ID";
    case Register::motor_id:
      return "ESC_ID";
    case Register::timeout:
      return "TIMEOUT";
    case Register::control_mode:
      return "CTRL_MODE";
    case Register::software_version:
      return "sw_ver";
    case Register::position_scale:
      return "PMAX";
    case Register::velocity_scale:
      return "VMAX";
    case Register::torque_scale:
      return "TMAX";
  }
  return "?";
}

const char* unit_of(Register which) {
  switch (which) {
    case Register::position_scale:
      return " rad";
    case Register::velocity_scale:
      return " rad/s";
    case Register::torque_scale:
      return " Nm";
    default:
      return "";
  }
}

}  // namespace

double Questions::scale_stated(Register which) const noexcept {
  const Scale scale = scale_of(stated_.model);
  if (which == Register::position_scale) return scale.position_rad;
  return which == Register::velocity_scale ? scale.velocity_rad_per_s : scale.torque_Nm;
}

std::uint32_t Questions::wanted(Register which) const noexcept {
  return which == Register::control_mode ? mit_mode : wanted_timeout_;
}

std::optional<CanFrame> Questions::next(std::int64_t now_ns) noexcept {
  if (now_ns < deadline_ns_ || done()) return std::nullopt;
  if (tries_ == most_questions) {
    // One that does not answer to this answers to nothing.
    blame(on_status_ < 0 ? Wrong::silent : Wrong::stays_on, steps[at_].which, on_status_, status_disabled);
    at_ = steps.size();
    return std::nullopt;
  }
  ++tries_;
  deadline_ns_ = now_ns + answer_ns;
  const auto id = static_cast<std::uint16_t>(stated_.id);
  const Step& step = steps[at_];
  switch (step.what) {
    case What::disable:
      return order_frame(id, Order::disable);
    case What::read:
      return read_frame(id, step.which);
    case What::write:
      return write_frame(id, step.which, wanted(step.which));
  }
  return std::nullopt;
}

bool Questions::take(const CanFrame& frame) noexcept {
  if (done()) return false;
  const Step& step = steps[at_];
  const auto answer = register_answer_of(frame);
  if (step.what == What::disable) {
    // Wherever its feedback comes from: that is compared when the register is known.
    const bool own = !answer && frame.size == 8 && (frame.data[0] & 0x0f) == stated_.id && tries_ > 0;
    if (!own) return false;
    const auto status = static_cast<std::uint8_t>(frame.data[0] >> 4);
    on_status_ = means_off(status) ? -1 : status;
    if (means_off(status)) go_on();
    return true;
  }
  if (!answer || answer->motor != stated_.id) return false;
  const auto answers = [&answer](const Step& question) {
    return answer->which == static_cast<std::uint8_t>(question.which) &&
           answer->written == (question.what == What::write);
  };
  if (!answers(step)) {
    // To a question that was asked once and answered. Where it was asked again, both may be of one motor.
    if (at_ > 0 && asked_once_ && answers(steps[at_ - 1])) blame(Wrong::twice, step.which, 0.0, 0.0);
    return false;
  }
  note(step.which, answer->value);
  go_on();
  return true;
}

void Questions::go_on() noexcept {
  ++at_;
  asked_once_ = tries_ == 1;
  tries_ = 0;
  deadline_ns_ = 0;
}

void Questions::note(Register which, std::uint32_t value) noexcept {
  const auto number = static_cast<double>(std::bit_cast<float>(value));
  switch (which) {
    case Register::feedback_id:
      facts_.feedback_id = value;
      if (facts_.feedback_id != stated_.feedback_id) {
        blame(Wrong::feedback_id, which, value, static_cast<double>(stated_.feedback_id));
      }
      break;
    case Register::position_scale:
      facts_.position_scale_rad = number;
      break;
    case Register::velocity_scale:
      facts_.velocity_scale_rad_per_s = number;
      break;
    case Register::torque_scale:
      facts_.torque_scale_Nm = number;
      break;
    case Register::software_version:
      facts_.software_version = value;
      break;
    case Register::control_mode:
      facts_.control_mode = value;
      break;
    case Register::timeout:
      facts_.timeout = value;
      break;
    case Register::motor_id:
      break;
  }
  if (is_number(which)) {
    const double stated = scale_stated(which);
    // Not `>`: a scale may be no number at all.
    if (!(std::fabs(number - stated) <= equal_enough * stated)) blame(Wrong::scale, which, number, stated);
  } else if ((which == Register::control_mode || which == Register::timeout) && value != wanted(which)) {
    blame(Wrong::written, which, value, wanted(which));
  }
}

void Questions::blame(Wrong wrong, Register which, double found, double expected) noexcept {
  if (wrong_ != Wrong::nothing) return;
  wrong_ = wrong;
  which_ = which;
  found_ = found;
  expected_ = expected;
}

std::string Questions::model_told() const {
  const auto near = [](double told, double of_model) { return std::fabs(told - of_model) <= equal_enough * of_model; };
  std::string found;
  for (const auto& [model, name] : enumerators(Model{})) {
    const Scale scale = scale_of(model);
    if (!near(facts_.position_scale_rad, scale.position_rad) || !near(facts_.torque_scale_Nm, scale.torque_Nm) ||
        !near(facts_.velocity_scale_rad_per_s, scale.velocity_rad_per_s)) {
      continue;
    }
    if (model == stated_.model) return {};
    found += (found.empty() ? "" : " or ") + std::string(name);
  }
  return found;
}

Check Questions::problem() const {
  const std::string motor = "motor " + std::to_string(stated_.id) + " (" + name_of(stated_.model) + ")";
  const std::string reg =
      std::string("register ") + std::to_string(static_cast<int>(which_)) + " (" + name_of_register(which_) + ")";
  const std::string found = rounded_number(found_), expected = rounded_number(expected_) + unit_of(which_);
  std::string message;
  switch (wrong_) {
    case Wrong::nothing:
      return std::nullopt;
    case Wrong::silent:
      message = motor + " does not answer" + (which_ == Register::motor_id ? std::string() : " when asked for " + reg) +
                ": look at its power, its two wires, 120 ohm at both ends of them, its identifier (two motors with one "
                "destroy "
                "each other's answers) and the bit rate";
      break;
    case Wrong::stays_on:
      message = motor + " was commanded " + std::to_string(most_questions) +
                " times to switch off and does not report that it is off (" +
                status_text(static_cast<std::int64_t>(found_)) +
                "): switch off its supply, wait until it is at rest, and switch it on again";
      break;
    case Wrong::twice:
      message = motor + " answers twice to one question: two motors have the identifier " + std::to_string(stated_.id) +
                ": unplug one of them, and give the other one of its own (register 8, ESC_ID) with the maker's tool";
      break;
    case Wrong::feedback_id:
      message = motor + " gives feedback with the identifier " + found + " where " + expected +
                " is stated: state what it has, or set its " + reg;
      break;
    case Wrong::scale:
      message = motor + ": its " + reg + " reads " + found + " where this model has " + expected +
                ": state the model that it is, or set the register to " + expected + " with the maker's tool";
      break;
    case Wrong::written:
      message = motor + ": its " + reg + " stays at " + found + " where " + expected +
                " was written: switch its power off and on, and update its firmware where that does not help";
      break;
  }
  return Error{.code = ErrorCode::inconsistent, .parameter = {}, .message = std::move(message), .place = {}};
}

}  // namespace tactus::devices::damiao
