// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/off_watch.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numbers>
#include <system_error>
#include <tuple>
#include <utility>

namespace tactus::devices {

namespace {

constexpr Bounds pair_counts = between(1.0, 2.0), joint_counts = between(1.0, static_cast<double>(most_joints));

constexpr JointWords turning{
    "offset_rad", "lower_rad", "upper_rad", "velocity_limit_rad_per_s", "torque_limit_Nm", "torque_rate_limit_Nm_per_s",
    "rad",        "rad/s",     "N m"};
constexpr JointWords sliding{
    "offset_m", "lower_m", "upper_m", "velocity_limit_m_per_s", "force_limit_N", "force_rate_limit_N_per_s",
    "m",        "m/s",     "N"};

Error at(const std::string& parameter, ErrorCode code, std::string message) {
  return {.code = code, .parameter = parameter, .message = std::move(message), .place = {}};
}

std::string in_quotes(std::string_view text) { return std::string("'").append(text).append("'"); }

/// What tells one port from another, whatever link it is named by.
std::string own_port(const std::string& port) {
  std::error_code problem;
  const auto real = std::filesystem::canonical(port, problem);
  return problem ? port : real.string();
}

/// What a number may be where it is too large by far: in degrees, or in millimetres.
std::string in_another_unit(const RigJoint& one, double value) {
  const auto rounded = [](double number) { return rounded_number(std::round(number * 1e4) / 1e4); };
  if (one.slides) return rounded_number(value) + " mm are " + rounded(value * 1e-3) + " m";
  return rounded_number(value) + " degrees are " + rounded(value * std::numbers::pi / 180.0) + " rad";
}

/// That a joint's limits, and its offset, are where its motor can be: `farthest` either way from the motor's zero.
Check check_positions(const RigJoint& one, double farthest) {
  const MotorJoint& joint = one.joint;
  const JointWords& words = one.words();
  const double range = farthest / joint.gear;
  // A motor may be mounted anywhere within its range, and a joint may be anywhere within that of its own.
  const double first = joint.offset_rad - range, last = joint.offset_rad + range;
  for (const auto& [key, value, least, most] :
       {std::tuple{words.offset, joint.offset_rad, -2.0 * range, 2.0 * range},
        std::tuple{words.lower, joint.lower_rad, first, last}, std::tuple{words.upper, joint.upper_rad, first, last}}) {
    if (value >= least && value <= most) continue;
    const std::string unit = std::string(" ") + words.position_unit;
    const auto rounded = [](double number) { return rounded_number(std::round(number * 1e4) / 1e4); };
    return at(join(one.path, key), ErrorCode::inconsistent,
              rounded_number(value) + unit + " is beyond where a joint with a " + one.motor.model + " can be, from " +
                  rounded(least) + " to " + rounded(most) + unit + ": state it in " + words.position_unit + " (" +
                  in_another_unit(one, value) + ")");
  }
  return std::nullopt;
}

/// After which angle the number of a motor starts again when it gets power, 0 for one that knows its turn. Feetech
/// servos count one turn. Dynamixel servos and Damiao motors count turns while they have power and lose them with it; a
/// joint that may go farther than one turn of theirs is taken as they report it.
double turn_of(BusKind kind, const MotorJoint& joint) {
  constexpr double turn_rad = 2.0 * std::numbers::pi;
  const bool loses_turns = kind == BusKind::dynamixel || kind == BusKind::damiao;
  const bool only_one_fits = (joint.upper_rad - joint.lower_rad) * joint.gear < turn_rad;
  return kind == BusKind::feetech || (loses_turns && only_one_fits) ? turn_rad : 0.0;
}

}  // namespace

const JointWords& RigJoint::words() const { return slides ? sliding : turning; }

Joints<MotorJoint> RigSide::motor_joints() const {
  Joints<MotorJoint> all(joints.size());
  for (std::size_t i = 0; i < joints.size(); ++i) all[i] = joints[i].joint;
  return all;
}

std::string describe_powered(const RigSide& side, const PoweredMotor& motor) {
  const RigJoint& joint = side.joints[motor.motor];
  const auto seconds = [](std::int64_t ns) { return rounded_number(static_cast<double>(ns) * 1e-9) + " s"; };
  const std::string what =
      motor.off ? " did not switch off within " + seconds(off_within_ns) + " when commanded to, and is off now"
                : " did not report within " + seconds(farewell_ns) + " that it is off";
  return joint.path + ": motor " + std::to_string(joint.motor.id) +
         (side.bus.port.empty() ? std::string() : " at " + side.bus.port) + " (" + std::string(bus_name(side.bus)) +
         ")" + what + " (" + status_text(side.bus.kind, motor.status) + "): switch off the supply of " + side.path +
         ", and keep clear of it until then";
}

Result<Rig> Rig::load(const std::filesystem::path& file) {
  auto document = configuration::Document::load(file);
  if (!document) return document.error();
  Rig rig(*std::move(document), file.string());
  if (Check error = rig.read_and_check()) return rig.locate(*std::move(error));
  return rig;
}

Result<Rig> Rig::parse(std::string_view text, std::string name) {
  auto document = configuration::Document::parse(text, name);
  if (!document) return document.error();
  Rig rig(*std::move(document), std::move(name));
  if (Check error = rig.read_and_check()) return rig.locate(*std::move(error));
  return rig;
}

Check Rig::read_and_check() {
  if (Check error = read()) return error;
  if (!pair_counts.contain(static_cast<double>(pairs_.size()))) {
    return at({}, ErrorCode::missing,
              pairs_.empty() ? "there is no leader and no follower in it: write [arm.leader] with bus and port, and "
                               "[arm.leader.JOINT] for each joint"
                             : "there are " + std::to_string(pairs_.size()) + " pairs in it: a rig has one or two");
  }
  for (RigPair& pair : pairs_) {
    if (Check error = match_joints(pair)) return error;
    for (auto* side : {&pair.leader, &pair.follower}) {
      if (!*side) continue;
      RigSide& here = **side;
      for (const RigJoint& joint : here.joints) here.bus.motors.push_back(joint.motor);
      if (Check error = check_keys(here)) return error;
      if (Check error = check_side(here)) return error;
      for (RigJoint& joint : here.joints) {
        const MotorAbility ability = ability_of(here.bus, joint.motor);
        joint.joint.gives_force = ability.torque_Nm > 0.0;
        if (here.bus.kind == BusKind::plugged) joint.joint.velocity_step_rad_per_s = ability.velocity_step_rad_per_s;
        joint.joint.turn_rad = turn_of(here.bus.kind, joint.joint);
      }
    }
  }
  return check_ports();
}

/// What has no default that could be right.
Check Rig::check_keys(const RigSide& side) const {
  const auto needed = [this](const std::string& section, const char* key, const char* example) -> Check {
    if (has(join(section, key))) return std::nullopt;
    return at(
        section, ErrorCode::missing,
        std::string(key) + " is needed: write for instance " + key + " = " + example + " under [" + section + "]");
  };
  const bool plugged = side.bus.kind == BusKind::plugged;
  if (!plugged) {
    if (Check error = needed(side.path, "port", "\"/dev/serial/by-id/...\"")) return error;
  }
  if (!joint_counts.contain(static_cast<double>(side.joints.size()))) {
    return at(side.path, ErrorCode::out_of_bounds,
              std::to_string(side.joints.size()) + " joints: one to " + std::to_string(most_joints) +
                  " must follow, as [" + side.path + ".elbow]");
  }
  for (const RigJoint& joint : side.joints) {
    Check error = needed(joint.path, "motor", "1");
    if (!error && !plugged) {
      const std::string model = "\"" + models_of(side.bus.kind).front() + "\"";
      error = needed(joint.path, "model", model.c_str());
    }
    const JointWords& words = joint.words();
    if (!error) error = needed(joint.path, words.lower, joint.slides ? "-0.1" : "-1.5");
    if (!error) error = needed(joint.path, words.upper, joint.slides ? "0.1" : "1.5");
    if (!error) error = needed(joint.path, words.velocity_limit, joint.slides ? "1.0" : "3.0");
    if (!error && ability_of(side.bus, joint.motor).torque_Nm > 0.0) {
      error = needed(joint.path, words.force_limit, "1.0");
      if (!error) error = needed(joint.path, words.rate_limit, "50.0");
    }
    if (error) return error;
  }
  return std::nullopt;
}

Check Rig::check_side(const RigSide& side) const {
  for (std::size_t i = 0; i < side.joints.size(); ++i) {
    for (std::size_t other = 0; other < i; ++other) {
      if (side.joints[other].motor.id != side.joints[i].motor.id) continue;
      return at(join(side.joints[i].path, "motor"), ErrorCode::inconsistent,
                std::to_string(side.joints[i].motor.id) + " is the motor of " + side.joints[other].path +
                    " too: each motor has an identifier of its own");
    }
  }
  if (Check error = check(side.bus)) return locate(side, *std::move(error));
  for (const RigJoint& one : side.joints) {
    const MotorJoint& joint = one.joint;
    const MotorAbility ability = ability_of(side.bus, one.motor);
    const JointWords& words = one.words();
    if (one.slides != side.joints.front().slides) {
      return at(one.path, ErrorCode::inconsistent,
                "it is in " + std::string(words.position_unit) + ", and " + side.joints.front().path + " in " +
                    side.joints.front().words().position_unit + ": state lever_m of all joints of a side, or of none");
    }
    if (joint.sign == 0) {
      return at(join(one.path, "sign"), ErrorCode::out_of_bounds,
                "0 must be 1, or -1 where the motor turns against the joint");
    }
    if (!(joint.lower_rad < joint.upper_rad)) {
      return at(join(one.path, words.upper), ErrorCode::inconsistent,
                rounded_number(joint.upper_rad) + " " + words.position_unit + " must be above " + words.lower + ", " +
                    rounded_number(joint.lower_rad) + " " + words.position_unit);
    }
    if (Check error = check_positions(one, ability.position_rad)) return error;
    const auto beyond = [&](const char* key, double limit, double most, const char* unit) {
      return at(join(one.path, key), ErrorCode::inconsistent,
                rounded_number(limit) + unit + " is beyond what a " + one.motor.model +
                    (joint.gear == 1.0 ? std::string()
                     : one.slides      ? " with a lever of " + rounded_number(1.0 / joint.gear) + " m"
                                       : " behind a gear of " + rounded_number(joint.gear)) +
                    " can do, " + rounded_number(most) + unit + ": lower it, or state the model that is there");
    };
    const std::string force_unit = std::string(" ") + words.force_unit,
                      velocity_unit = std::string(" ") + words.velocity_unit;
    const double most_Nm = ability.torque_Nm * joint.gear;
    if (ability.torque_Nm > 0.0 && joint.torque_limit_Nm > most_Nm) {
      return beyond(words.force_limit, joint.torque_limit_Nm, most_Nm, force_unit.c_str());
    }
    const double fastest = ability.velocity_rad_per_s / joint.gear;
    if (ability.velocity_rad_per_s > 0.0 && joint.velocity_limit_rad_per_s > fastest) {
      return beyond(words.velocity_limit, joint.velocity_limit_rad_per_s, fastest, velocity_unit.c_str());
    }
    const double squared = joint.gear * joint.gear;
    for (const auto& [key, limit, most, unit] :
         {std::tuple{"stiffness_limit_Nm_per_rad", joint.stiffness_limit_Nm_per_rad,
                     ability.stiffness_Nm_per_rad * squared, " N m/rad"},
          std::tuple{"damping_limit_Nms_per_rad", joint.damping_limit_Nms_per_rad,
                     ability.damping_Nms_per_rad * squared, " N m s/rad"}}) {
      if (limit <= most) continue;
      if (most > 0.0) return beyond(key, limit, most, unit);
      return at(join(one.path, key), ErrorCode::inconsistent,
                "a " + one.motor.model + " runs no law by itself: remove this key");
    }
  }
  return std::nullopt;
}

Check Rig::check_ports() const {
  std::map<std::string, const RigSide*> taken;
  for (const RigPair& pair : pairs_) {
    for (const auto* side : {&pair.leader, &pair.follower}) {
      if (!*side || (*side)->bus.port.empty()) continue;
      const auto [earlier, fresh] = taken.emplace(own_port((*side)->bus.port), &**side);
      if (fresh) continue;
      return at(join((*side)->path, "port"), ErrorCode::inconsistent,
                in_quotes((*side)->bus.port) + " is the port of " + earlier->second->path + " too" +
                    ((*side)->bus.port == earlier->second->bus.port ? "" : ", by another name") +
                    ": leader and follower each have a bus of their own");
    }
  }
  return std::nullopt;
}

Check Rig::match_joints(RigPair& pair) {
  if (!pair.leader || !pair.follower) return std::nullopt;
  const auto lone = [](const RigSide& side, const RigSide& other) -> Check {
    for (const RigJoint& joint : side.joints) {
      const auto same = [&joint](const RigJoint& one) { return one.name() == joint.name(); };
      if (std::ranges::any_of(other.joints, same)) continue;
      return at(joint.path, ErrorCode::inconsistent,
                other.path + " has no joint of this name to be coupled with: write [" + join(other.path, joint.name()) +
                    "], or leave this one out");
    }
    return std::nullopt;
  };
  if (Check error = lone(*pair.leader, *pair.follower)) return error;
  if (Check error = lone(*pair.follower, *pair.leader)) return error;
  for (const RigJoint& joint : pair.follower->joints) {
    const auto& leads = *std::ranges::find(pair.leader->joints, joint.name(), &RigJoint::name);
    if (leads.slides == joint.slides) continue;
    return at(joint.path, ErrorCode::inconsistent,
              std::string("it is in ") + joint.words().position_unit + ", and " + leads.path + " in " +
                  leads.words().position_unit +
                  ": for the joint that turns, state lever_m (its displacement in m per radian of the motor), and "
                  "limits in m and N");
  }
  const auto place = [&pair](const RigJoint& joint) {
    return std::ranges::find(pair.leader->joints, joint.name(), &RigJoint::name) - pair.leader->joints.begin();
  };
  std::ranges::sort(pair.follower->joints, {}, place);
  return std::nullopt;
}

bool Rig::has(std::string_view key) const {
  const auto written = document_.keys();
  return std::ranges::find(written, key) != written.end();
}

bool Rig::holds(std::string_view name, std::string_view path) {
  return name.empty() || path == name || (path.starts_with(name) && path[name.size()] == '.');
}

Result<std::vector<const RigSide*>> Rig::sides(std::string_view name) const {
  std::vector<const RigSide*> found;
  std::string all;
  for (const RigPair& pair : pairs_) {
    for (const auto* side : {&pair.leader, &pair.follower}) {
      if (!*side) continue;
      const auto named = [name](const RigJoint& joint) { return holds(name, joint.path); };
      if (std::ranges::any_of((*side)->joints, named)) found.push_back(&**side);
      for (const RigJoint& joint : (*side)->joints) all += (all.empty() ? "" : ", ") + joint.path;
    }
  }
  if (!found.empty()) return found;
  return at({}, ErrorCode::missing, in_quotes(name) + " is no part of the rig: its joints are " + all);
}

Error Rig::locate(const RigSide& side, Error error) const {
  // `motors[2].id` is the motor of the joint with that number.
  constexpr std::string_view of_motor = "motors[";
  if (error.parameter.starts_with(of_motor)) {
    const auto number = static_cast<std::size_t>(std::strtoul(error.parameter.c_str() + of_motor.size(), nullptr, 10));
    const std::string key(error.parameter.substr(error.parameter.find("].") + 2));
    if (number < side.joints.size()) error.parameter = join(side.joints[number].path, key == "id" ? "motor" : key);
  } else {
    error.parameter = join(side.path, error.parameter);
  }
  return document_.locate(std::move(error));
}

}  // namespace tactus::devices
