// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/rig/examination.hpp>
#include <tactus/hardware/wire/latency_timer.hpp>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

namespace tactus::devices {

namespace {

constexpr Seconds longest_asking{10.0};

std::string motor_key(std::size_t motor, const char* key) {
  return std::string("motors[") + std::to_string(motor) + "]." + key;
}

std::string lower_case(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// Whether `told`, one model or several with ` or ` between them, is that model.
bool may_be(const std::string& told, const std::string& model) {
  const std::string all = " or " + lower_case(told) + " or ";
  return !told.empty() && all.find(" or " + lower_case(model) + " or ") != std::string::npos;
}

/// Cycles without power for so long. False where the bus ended meanwhile.
bool run_cycles(const MotorLink& bus, BusFinding& found) {
  constexpr std::chrono::milliseconds duration{500};
  const auto before = bus.newest();
  std::this_thread::sleep_for(duration);
  const auto after = bus.newest();
  if (!before || !after || !bus.running()) return false;
  found.rate_Hz = static_cast<double>(after->cycles - before->cycles) /
                  (static_cast<double>(after->time_ns - before->time_ns) * 1e-9);
  for (std::size_t i = 0; i < found.motors.size(); ++i) {
    found.motors[i].reading = after->motors[i];
    found.motors[i].age_s = 1e-9 * static_cast<double>(after->time_ns - after->motors[i].received_ns);
  }
  return true;
}

/// The other bit rate at which one of the motors answers.
std::optional<std::int64_t> answering_rate(StatedBus stated) {
  constexpr std::size_t enough = 2;
  if (stated.motors.size() > enough) stated.motors.resize(enough);
  const std::int64_t tried = stated.bits_per_s;
  for (const std::int64_t rate : bit_rates_of(stated.kind)) {
    if (rate == tried) continue;
    stated.bits_per_s = rate;
    auto bus = start(stated);
    if (!bus) continue;  // not every adapter does every rate
    static_cast<void>((*bus)->wait_until_asked(longest_asking));
    (*bus)->stop();
    const auto told = (*bus)->newest();
    for (std::size_t motor = 0; told && motor < stated.motors.size(); ++motor) {
      if (told->motors[motor].answers > 0) return rate;
    }
  }
  return std::nullopt;
}

void note_swaps(const StatedBus& stated, BusFinding& found) {
  for (std::size_t i = 0; i < found.motors.size(); ++i) {
    for (std::size_t other = 0; other < found.motors.size(); ++other) {
      const bool swapped = may_be(found.motors[i].sheet.model, stated.motors[other].model) &&
                           may_be(found.motors[other].sheet.model, stated.motors[i].model);
      if (other == i || !swapped) continue;
      found.motors[i].problems.back().message += "; it looks as if motors " + std::to_string(stated.motors[i].id) +
                                                 " and " + std::to_string(stated.motors[other].id) +
                                                 " were swapped: exchange their identifiers";
      break;
    }
  }
}

}  // namespace

const char* remedy_of(MotorFault fault) {
  switch (fault) {
    case MotorFault::none:
      return "";
    case MotorFault::not_responding:
      return "does not answer any more: look at its power and its plug";
    case MotorFault::voltage:
      return "its supply is too high or too low: measure it under load";
    case MotorFault::current:
      return "its current was too high: look for a short or a jam";
    case MotorFault::hot:
      return "too hot: let it cool, and lower the torque limit";
    case MotorFault::lost_master:
      return "released because it received no command: this is cleared when it gets power";
    case MotorFault::overload:
      return "overloaded: take the load off; this is cleared when it gets power";
    case MotorFault::encoder:
      return "does not know its position: start again";
    case MotorFault::refused:
      return "refused what it was asked: switch it off and on";
    case MotorFault::unknown_status:
      return "reports a status that is not known: switch it off and on, and look at its firmware";
    case MotorFault::stays_on:
      return "was commanded to switch off and does not report that it is off: switch off its supply, wait until it is "
             "still, and switch it on again";
  }
  return "";
}

bool BusFinding::well() const {
  return heard && problems.empty() &&
         std::ranges::all_of(motors, [](const MotorFinding& motor) { return motor.problems.empty(); });
}

Result<BusFinding> examine(const StatedBus& stated) {
  BusFinding found;
  found.motors.resize(stated.motors.size());
  auto bus = start(stated);
  if (!bus) return bus.error();
  if (Check slow = wire::check_latency_timer(stated.port)) {
    slow->parameter = "port";
    found.problems.push_back(*std::move(slow));
  }
  Check wrong = (*bus)->wait_until_asked(longest_asking);
  const auto asked = (*bus)->newest();
  const bool refused = wrong && asked && asked->state == BusState::refused;
  if (!wrong) {
    found.heard = run_cycles(**bus, found);
    if (!found.heard) wrong = Error{ErrorCode::failed, "port", "the port was closed meanwhile", stated.port};
  }
  (*bus)->stop();
  bool all_silent = true;
  for (std::size_t i = 0; i < found.motors.size(); ++i) {
    MotorFinding& motor = found.motors[i];
    motor.sheet = (*bus)->sheet(i);
    all_silent = all_silent && asked && asked->motors[i].answers == 0 && motor.sheet.firmware.empty();
    if (motor.sheet.problem) {
      Error problem = *motor.sheet.problem;
      problem.parameter = motor_key(i, motor.sheet.model.empty() ? "id" : "model");
      motor.problems.push_back(std::move(problem));
    } else if (const std::string remedy = found.heard ? remedy_of(motor.reading.fault) : ""; !remedy.empty()) {
      const MotorFault fault = motor.reading.fault;
      const bool named = fault == MotorFault::unknown_status || fault == MotorFault::stays_on;
      const std::string status = named ? " (" + status_text(stated.kind, motor.reading.status) + ")" : std::string();
      motor.problems.push_back({ErrorCode::failed,
                                motor_key(i, "id"),
                                "motor " + std::to_string(stated.motors[i].id) + status + ": " + remedy,
                                {}});
    }
  }
  // A driver of somebody else's has no sheets that say why.
  if (wrong && (!refused || stated.kind == BusKind::plugged)) found.problems.push_back(*wrong);
  bus->reset();  // so that the port is free for another rate
  note_swaps(stated, found);
  if (!refused || !all_silent) return found;
  if (const auto rate = answering_rate(stated)) {
    found.problems.push_back({ErrorCode::inconsistent,
                              "bits_per_s",
                              "the motors answer at " + std::to_string(*rate) + " bit/s, not at " +
                                  std::to_string(stated.bits_per_s) + ": state bits_per_s = " + std::to_string(*rate),
                              {}});
  }
  return found;
}

std::vector<Error> judge(const RigJoint& one, const MotorFinding& found, const std::string& file) {
  std::vector<Error> problems;
  const MotorJoint& joint = one.joint;
  const JointWords& words = one.words();
  const std::string unit = std::string(" ") + words.position_unit;
  const auto add = [&](const char* key, std::string message) {
    problems.push_back({ErrorCode::inconsistent, join(one.path, key), std::move(message), {}});
  };
  const auto rounded = [](double value) { return rounded_number(std::round(value * 1e3) * 1e-3); };
  const double position_rad = joint.first_position_rad(found.reading.position_rad);
  if (!joint.contains(position_rad)) {
    MotorJoint turned = joint;
    turned.sign = -joint.sign;
    const double turned_rad = turned.first_position_rad(found.reading.position_rad);
    add(words.offset,
        "it is at " + rounded(position_rad) + unit + ", where it may be from " + rounded(joint.lower_rad) + " to " +
            rounded(joint.upper_rad) +
            ": move it there by hand; where it is there, put it to its zero and run 'tactus device zero " + file + " " +
            one.path + "'" +
            (turned.contains(turned_rad) ? ", or state sign = " + std::to_string(turned.sign) +
                                               ", with which it were at " + rounded(turned_rad) + unit
                                         : std::string()));
  }
  if (found.reading.temperature_C > joint.temperature_limit_C) {
    add("temperature_limit_C", "its motor has " + rounded(found.reading.temperature_C) + " degC, more than " +
                                   rounded(joint.temperature_limit_C) + " degC: let it cool");
  }
  const double most_Nm = found.sheet.torque_limit_Nm * joint.gear;
  if (joint.gives_force && joint.torque_limit_Nm > most_Nm * (1.0 + 1e-9)) {
    add(words.force_limit, rounded_number(joint.torque_limit_Nm) + " " + words.force_unit +
                               " is more than its motor is set to give, " + rounded(most_Nm) + " " + words.force_unit +
                               ": lower it, or raise the limit in the motor with its maker's tool");
  }
  return problems;
}

Check refuse_undrivable(const RigSide& side, const RigJoint& joint) {
  if (joint.joint.gives_force || key_of(side.path) != "follower") return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = join(joint.path, "model"),
               .message = "a " + joint.motor.model +
                          " takes no command of force, so it can lead and not follow: swap leader and follower, or "
                          "only look at it with 'tactus device watch'",
               .place = {}};
}

BusFinding examine(const Rig& rig, const RigSide& side) {
  auto examined = examine(side.bus);
  BusFinding found;
  if (examined) {
    found = *std::move(examined);
  } else {
    found.motors.resize(side.joints.size());
    Error error = examined.error();
    const std::string port = std::exchange(error.place, {});
    if (error.parameter.empty()) error.parameter = "port";
    if (!port.empty()) error.message = port + ": " + error.message;
    found.problems.push_back(std::move(error));
  }
  for (Error& problem : found.problems) {
    if (problem.place == side.bus.port) problem.place.clear();
    problem = rig.locate(side, std::move(problem));
  }
  for (std::size_t i = 0; i < side.joints.size(); ++i) {
    MotorFinding& motor = found.motors[i];
    for (Error& problem : motor.problems) problem = rig.locate(side, std::move(problem));
    if (Check cannot = refuse_undrivable(side, side.joints[i])) {
      motor.problems.push_back(rig.locate(*std::move(cannot)));
    }
    if (!found.heard) continue;
    for (Error& problem : judge(side.joints[i], motor, rig.name()))
      motor.problems.push_back(rig.locate(std::move(problem)));
  }
  return found;
}

}  // namespace tactus::devices
