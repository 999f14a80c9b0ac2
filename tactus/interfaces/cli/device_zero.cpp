// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/hardware/devices/rig/examination.hpp>
#include <tactus/hardware/devices/rig/rig_edit.hpp>
#include <tactus/interfaces/cli/device.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

using devices::BusFinding;
using devices::Rig;
using devices::RigJoint;
using devices::RigSide;

/// The first thing that is wrong with a side whose motors could not be heard.
Error unheard(const RigSide& side, const BusFinding& found) {
  for (const auto& motor : found.motors) {
    if (!motor.problems.empty()) return motor.problems.front();
  }
  if (!found.problems.empty()) return found.problems.front();
  return {.code = ErrorCode::failed, .parameter = side.path, .message = "its motors did not respond", .place = {}};
}

struct ZeroOptions {
  std::string rig;
  std::vector<std::string> joints;
  std::string motor;  ///< of these alone, by its identifier or its joint's name; empty: all
};

bool is_motor(const RigJoint& joint, const std::string& wanted) {
  return wanted.empty() || wanted == joint.name() || wanted == std::to_string(joint.motor.id);
}

/// What is there in place of a motor that is not.
Error no_such_motor(const ZeroOptions& options, const std::vector<const RigSide*>& sides) {
  std::string all;
  for (const RigSide* side : sides) {
    for (const RigJoint& joint : side->joints) {
      const auto holds = [&joint](const std::string& name) { return Rig::holds(name, joint.path); };
      if (std::ranges::none_of(options.joints, holds)) continue;
      all += (all.empty() ? "" : ", ") + std::to_string(joint.motor.id) + " (" + joint.path + ")";
    }
  }
  return {.code = ErrorCode::missing,
          .parameter = {},
          .message = "'" + options.motor + "' is no motor and no joint there: the motors are " + all,
          .place = "--motor"};
}

/// Nothing is written unless every joint was heard, and nothing asked where the wanted motor is not in the file.
Result<bool> zero(const ZeroOptions& options) {
  const auto rig = Rig::load(options.rig);
  if (!rig) return rig.error();
  std::vector<const RigSide*> sides;
  for (const std::string& name : options.joints) {
    const auto named = rig->sides(name);
    if (!named) return rig->locate(named.error());
    for (const RigSide* side : *named) {
      if (std::ranges::find(sides, side) == sides.end()) sides.push_back(side);
    }
  }
  const auto wanted = [&options](const RigJoint& joint) {
    const auto holds = [&joint](const std::string& name) { return Rig::holds(name, joint.path); };
    return is_motor(joint, options.motor) && std::ranges::any_of(options.joints, holds);
  };
  const auto without = [&wanted](const RigSide* side) { return std::ranges::none_of(side->joints, wanted); };
  const std::vector<const RigSide*> named_sides = sides;
  std::erase_if(sides, without);
  if (sides.empty()) return no_such_motor(options, named_sides);
  std::vector<devices::NewOffset> offsets;
  std::string told;
  for (const RigSide* side : sides) {
    const BusFinding found = examine(*rig, *side);
    if (!found.heard) return unheard(*side, found);
    for (std::size_t i = 0; i < side->joints.size(); ++i) {
      const RigJoint& joint = side->joints[i];
      if (!wanted(joint)) continue;
      const double was_rad = joint.joint.first_position_rad(found.motors[i].reading.position_rad);
      offsets.push_back({.joint = joint.path, .offset_rad = joint.joint.offset_rad - was_rad});
      constexpr int digits = 4;
      told += joint.path + " was at " + report::number(was_rad, digits) + " " + joint.words().position_unit +
              " and is at zero now.\n";
    }
  }
  if (Check error = write_offsets(options.rig, offsets)) return *std::move(error);
  std::cout << told;
  if (Check error = flush_standard_output()) return *std::move(error);
  return true;
}

struct LimitsOptions {
  std::string rig, name;
};

std::string number(double value) {
  constexpr int digits = 4;
  return value > 0.0 && std::isfinite(value) ? report::number(value, digits) : "-";
}

const char* what_holds(double of_motor, double of_file) {
  if (!(of_motor > 0.0)) return "file";
  return of_motor < of_file ? "motor" : "file";
}

/// A row for each joint, within 80 columns.
report::Table limits_table(const RigSide& side, const BusFinding& found, const std::string& name) {
  using Align = report::Column::Align;
  const devices::JointWords& words = side.joints.front().words();
  report::Table table({{"joint", "", Align::left},
                       {"force: motor", words.force_unit},
                       {"file", words.force_unit},
                       {"holds", "", Align::left},
                       {"velocity: motor", words.velocity_unit},
                       {"file", words.velocity_unit},
                       {"position", words.position_unit, Align::left},
                       {"heat", "°C"}});
  for (std::size_t i = 0; i < side.joints.size(); ++i) {
    const RigJoint& one = side.joints[i];
    if (!Rig::holds(name, one.path)) continue;
    const double most_Nm = found.motors[i].sheet.torque_limit_Nm * one.joint.gear;
    const double fastest = ability_of(side.bus, one.motor).velocity_rad_per_s / one.joint.gear;
    table.add_row({std::string(one.name()), number(most_Nm),
                   one.joint.gives_force ? number(one.joint.torque_limit_Nm) : "-",
                   one.joint.gives_force ? what_holds(most_Nm, one.joint.torque_limit_Nm) : "no force", number(fastest),
                   number(one.joint.velocity_limit_rad_per_s),
                   rounded_number(one.joint.lower_rad) + " to " + rounded_number(one.joint.upper_rad),
                   number(one.joint.temperature_limit_C)});
  }
  return table;
}

/// The limits that the file alone has, of joints that give force.
report::Table rates_table(const std::vector<const RigJoint*>& joints) {
  const devices::JointWords& words = joints.front()->words();
  const std::string force = words.force_unit, position = words.position_unit;
  report::Table table({{"joint", "", report::Column::Align::left},
                       {"force rate", force + "/s"},
                       {"stiffness", force + "/" + position},
                       {"damping", force + " s/" + position}});
  for (const RigJoint* one : joints) {
    table.add_row({std::string(one->name()), number(one->joint.torque_rate_limit_Nm_per_s),
                   number(one->joint.stiffness_limit_Nm_per_rad), number(one->joint.damping_limit_Nms_per_rad)});
  }
  return table;
}

Result<bool> limits(const LimitsOptions& options) {
  const auto rig = Rig::load(options.rig);
  if (!rig) return rig.error();
  const auto sides = rig->sides(options.name);
  if (!sides) return rig->locate(sides.error());
  for (const RigSide* side : *sides) {
    const BusFinding found = examine(*rig, *side);
    if (!found.heard) return unheard(*side, found);
    std::cout << side->path << "\n" << limits_table(*side, found, options.name).to_text();
    std::vector<const RigJoint*> with_force;
    for (const RigJoint& one : side->joints) {
      if (Rig::holds(options.name, one.path) && one.joint.gives_force) with_force.push_back(&one);
    }
    if (!with_force.empty()) {
      std::cout << "\nLimits of the file for the force rate and for the motor's own control:\n"
                << rates_table(with_force).to_text();
    }
  }
  if (Check error = flush_standard_output()) return *std::move(error);
  return true;
}

}  // namespace

void add_device_zero(CLI::App& device, const CLI::App& app, int& status) {
  auto options = std::make_shared<ZeroOptions>();
  CLI::App* verb = device.add_subcommand(
      "zero", "Set the present position of joints to zero, and write the offsets into the rig file");
  verb->add_option("RIG", options->rig, "Rig file")->required();
  verb->add_option("JOINT", options->joints,
                   "Joints to set, such as arm.leader.elbow; a side, such as arm.leader, sets all of its joints")
      ->required();
  verb->add_option("--motor", options->motor,
                   "Set only this motor, given by its identifier or by the name of its joint")
      ->type_name("ID|JOINT");
  verb->callback([options, &app, &status] { end_command(app, zero(*options), status); });
}

void add_device_limits(CLI::App& device, const CLI::App& app, int& status) {
  auto options = std::make_shared<LimitsOptions>();
  CLI::App* verb =
      device.add_subcommand("limits", "Show the limits of the motors and of the file, and which of them apply");
  verb->add_option("RIG", options->rig, "Rig file")->required();
  verb->add_option("NAME", options->name, "Pair, side or joint of the rig, such as arm.leader");
  verb->callback([options, &app, &status] { end_command(app, limits(*options), status); });
}

}  // namespace tactus::cli
