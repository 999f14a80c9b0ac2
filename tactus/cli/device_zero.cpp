#include <tactus/cli/device.hpp>
#include <tactus/cli/standard_output.hpp>
#include <tactus/devices/rig/examination.hpp>
#include <tactus/devices/rig/rig_edit.hpp>
#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>

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
  return {.code = ErrorCode::failed, .parameter = side.path, .message = "its motors were not heard", .place = {}};
}

struct ZeroOptions {
  std::string rig;
  std::vector<std::string> joints;
};

/// Nothing is written unless every joint was heard.
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
  std::vector<devices::NewOffset> offsets;
  std::string told;
  for (const RigSide* side : sides) {
    const BusFinding found = examine(*rig, *side);
    if (!found.heard) return unheard(*side, found);
    for (std::size_t i = 0; i < side->joints.size(); ++i) {
      const RigJoint& joint = side->joints[i];
      const auto holds = [&joint](const std::string& name) { return Rig::holds(name, joint.path); };
      if (std::ranges::none_of(options.joints, holds)) continue;
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

Result<bool> limits(const LimitsOptions& options) {
  const auto rig = Rig::load(options.rig);
  if (!rig) return rig.error();
  const auto sides = rig->sides(options.name);
  if (!sides) return rig->locate(sides.error());
  using Align = report::Column::Align;
  report::Table table({{"joint", "", Align::left},
                       {"force: motor"},
                       {"file"},
                       {"unit", "", Align::left},
                       {"holds", "", Align::left},
                       {"velocity: motor"},
                       {"file"},
                       {"unit", "", Align::left},
                       {"position", "", Align::left},
                       {"heat", "°C"}});
  for (const RigSide* side : *sides) {
    const BusFinding found = examine(*rig, *side);
    if (!found.heard) return unheard(*side, found);
    for (std::size_t i = 0; i < side->joints.size(); ++i) {
      const RigJoint& one = side->joints[i];
      if (!Rig::holds(options.name, one.path)) continue;
      const double most_Nm = found.motors[i].sheet.torque_limit_Nm * one.joint.gear;
      const double fastest = ability_of(side->bus.kind, one.motor).velocity_rad_per_s / one.joint.gear;
      table.add_row({one.path, number(most_Nm), one.joint.gives_force ? number(one.joint.torque_limit_Nm) : "-",
                     one.words().force_unit,
                     one.joint.gives_force ? what_holds(most_Nm, one.joint.torque_limit_Nm) : "gives no force",
                     number(fastest), number(one.joint.velocity_limit_rad_per_s), one.words().velocity_unit,
                     format_number(one.joint.lower_rad) + " to " + format_number(one.joint.upper_rad),
                     number(one.joint.temperature_limit_C)});
    }
  }
  std::cout << table.to_text();
  if (Check error = flush_standard_output()) return *std::move(error);
  return true;
}

}  // namespace

void add_device_zero(CLI::App& device, const CLI::App& app, int& status) {
  auto options = std::make_shared<ZeroOptions>();
  CLI::App* verb =
      device.add_subcommand("zero", "Write offsets into the rig file with which joints are at zero where they are now");
  verb->add_option("RIG", options->rig, "The rig file")->required();
  verb->add_option("JOINT", options->joints, "Joints of it, or all of a side, as arm.leader.elbow or arm.leader")
      ->required();
  verb->callback([options, &app, &status] { end_verb(app, zero(*options), status); });
}

void add_device_limits(CLI::App& device, const CLI::App& app, int& status) {
  auto options = std::make_shared<LimitsOptions>();
  CLI::App* verb = device.add_subcommand("limits", "The limits of motors and file, and which of them hold");
  verb->add_option("RIG", options->rig, "The rig file")->required();
  verb->add_option("NAME", options->name, "A pair, a side or a joint of it, as arm.leader");
  verb->callback([options, &app, &status] { end_verb(app, limits(*options), status); });
}

}  // namespace tactus::cli
