// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/hardware/wire/talk.hpp>
#include <tactus/interfaces/cli/device.hpp>
#include <tactus/interfaces/cli/device_guide.hpp>
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

namespace tactus::cli {

namespace {

using devices::BusReadings;
using devices::MotorFault;
using devices::Rig;
using devices::RigJoint;
using devices::RigSide;

constexpr std::chrono::milliseconds between_looks{200};

struct WatchOptions {
  std::string rig, name, guide;
  double duration_s = 0.0;
};

/// A side whose bus runs without power, and where its joints were first.
struct Watched {
  const RigSide* side = nullptr;
  std::unique_ptr<devices::MotorLink> bus;
  std::array<std::optional<double>, most_joints> first_rad{};
};

/// One joint at one moment.
struct Shown {
  const RigJoint* joint = nullptr;
  double position_rad = 0.0, moved_rad = 0.0, velocity_rad_per_s = 0.0, temperature_C = 0.0, age_s = 0.0;
  std::string state;
};

Result<Watched> open(const Rig& rig, const RigSide& side) {
  auto bus = start(side.bus);
  if (!bus) return bus.error().place.empty() ? rig.locate(side, bus.error()) : bus.error();
  constexpr Seconds longest{10.0};
  if (Check wrong = (*bus)->wait_until_asked(longest)) return *std::move(wrong);
  return Watched{.side = &side, .bus = *std::move(bus)};
}

std::vector<Shown> look(Watched& watched, const BusReadings& now, const std::string& name) {
  std::vector<Shown> all;
  for (std::size_t i = 0; i < watched.side->joints.size(); ++i) {
    const RigJoint& joint = watched.side->joints[i];
    if (!Rig::holds(name, joint.path)) continue;
    const auto& motor = now.motors[i];
    const double position_rad = joint.joint.first_position_rad(motor.position_rad);
    const bool heard = motor.answers > 0;
    if (heard && !watched.first_rad[i]) watched.first_rad[i] = position_rad;
    constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
    const bool outside = !joint.joint.contains(position_rad);
    all.push_back({.joint = &joint,
                   .position_rad = heard ? position_rad : unknown,
                   .moved_rad = heard ? position_rad - *watched.first_rad[i] : unknown,
                   .velocity_rad_per_s = joint.joint.velocity_rad_per_s(motor.velocity_rad_per_s),
                   .temperature_C = motor.temperature_C,
                   .age_s = !heard ? unknown : 1e-9 * static_cast<double>(wire::monotonic_ns() - motor.received_ns),
                   .state = motor.fault != MotorFault::none ? name_of(motor.fault)
                            : outside                       ? "outside"
                                                            : "well"});
  }
  return all;
}

std::string table_of(const std::vector<Shown>& all) {
  report::Table table({{"joint", "", report::Column::Align::left},
                       {"position"},
                       {"moved"},
                       {"velocity"},
                       {"unit", "", report::Column::Align::left},
                       {"heat", "°C"},
                       {"age", "ms"},
                       {"state", "", report::Column::Align::left}});
  for (const Shown& one : all) {
    table.add_row({one.joint->path, report::fixed(one.position_rad, 3), report::fixed(one.moved_rad, 3),
                   report::fixed(one.velocity_rad_per_s, 2), one.joint->words().velocity_unit,
                   report::fixed(one.temperature_C, 0), report::fixed(1e3 * one.age_s, 1), one.state});
  }
  return table.to_text();
}

std::string lines_of(const std::vector<Shown>& all, double time_s) {
  std::string lines;
  for (const Shown& one : all) {
    lines += report::fixed(time_s, 1) + " " + one.joint->path + " " + one.joint->words().position_unit + " " +
             report::fixed(one.position_rad, 4) + " " + report::fixed(one.moved_rad, 4) + " " +
             report::fixed(one.velocity_rad_per_s, 3) + " " + report::fixed(one.temperature_C, 0) + " " +
             report::fixed(1e3 * one.age_s, 1) + " " + one.state + "\n";
  }
  return lines;
}

Result<bool> watch(const WatchOptions& options) {
  const auto rig = Rig::load(options.rig);
  if (!rig) return rig.error();
  const auto sides = rig->sides(options.name);
  if (!sides) return rig->locate(sides.error());
  runtime::EndRequest end;
  const auto interruption = Interruption::start(end);
  if (!interruption) return interruption.error();
  std::vector<Watched> all;
  for (const RigSide* side : *sides) {
    auto opened = open(*rig, *side);
    if (!opened) return opened.error();
    all.push_back(*std::move(opened));
  }
  const bool terminal = isatty(STDOUT_FILENO) != 0;
  if (!terminal) std::cout << "# time_s joint unit position moved velocity temperature_C age_ms state\n";
  const auto began = std::chrono::steady_clock::now();
  const auto time_s = [began] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
  };
  while (!end.asked() && (options.duration_s == 0.0 || time_s() < options.duration_s)) {
    std::vector<Shown> shown;
    for (Watched& watched : all) {
      if (!watched.bus->running()) return *watched.bus->wait_until_asked(Seconds{0.0});
      const auto now = watched.bus->newest();
      if (!now) continue;
      const auto of_side = look(watched, *now, options.name);
      shown.insert(shown.end(), of_side.begin(), of_side.end());
    }
    // Home, what was there erased: the table stays where it is.
    constexpr const char* home_and_erase = "\033[H\033[J";
    std::cout << (terminal ? home_and_erase + table_of(shown) + "No motor has power. Ctrl-C ends.\n"
                           : lines_of(shown, time_s()));
    if (Check error = flush_standard_output()) return *std::move(error);
    std::this_thread::sleep_for(between_looks);
  }
  return true;
}

}  // namespace

void add_device_watch(CLI::App& device, const CLI::App& app, int& status) {
  auto options = std::make_shared<WatchOptions>();
  CLI::App* verb = device.add_subcommand("watch", "Show the position of each joint, without power, until Ctrl-C");
  verb->add_option("RIG", options->rig, "Rig file")->required();
  verb->add_option("NAME", options->name, "Pair, side or joint of the rig, such as arm.leader");
  verb->add_option("--duration-s", options->duration_s, "Time to run; 0: until interrupted")
      ->type_name("S")
      ->check(real_between(0.0, 1e6));
  verb->add_option(
          "--guide", options->guide,
          "Experiment (TOML) that names the arm's URDF: moves one arm by hand through three poses and names each "
          "joint whose direction, zero or gear disagrees")
      ->type_name("EXPERIMENT")
      ->excludes("--duration-s");
  verb->callback([options, &app, &status] {
    end_command(app, options->guide.empty() ? watch(*options) : guide_arm(options->rig, options->name, options->guide),
                status);
  });
}

}  // namespace tactus::cli
