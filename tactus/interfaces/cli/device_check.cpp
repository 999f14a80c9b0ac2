// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/hardware/devices/rig/examination.hpp>
#include <tactus/interfaces/cli/device.hpp>
#include <tactus/interfaces/cli/json_option.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using devices::BusFinding;
using devices::MotorFinding;
using devices::Rig;
using devices::RigSide;
using devices::StatedBus;
using devices::StatedMotor;

struct CheckOptions {
  std::string rig, name;
  std::string kind;
  StatedBus bus;
  std::vector<std::string> motors;
  JsonOption json;
};

/// A bus that was examined, and the joints that are wanted of it; without a rig its motors have no joints.
struct Checked {
  const StatedBus* bus = nullptr;
  const RigSide* side = nullptr;
  std::vector<std::size_t> motors;
  BusFinding found;
};

Result<StatedMotor> parse_motor(const std::string& text) {
  StatedMotor motor;
  motor.torque_Nm_per_A = 1.0;  // no torque is asked for
  const auto colon = text.find(':');
  const char* end = text.data() + std::min(colon, text.size());
  const auto read = std::from_chars(text.data(), end, motor.id);
  if (colon == std::string::npos || read.ec != std::errc() || read.ptr != end || colon + 1 == text.size()) {
    return Error{.code = ErrorCode::syntax,
                 .parameter = {},
                 .message = "'" + text + "' is no motor: write ID:MODEL, as in 1:DM4310,2:DM4310",
                 .place = "--motors"};
  }
  motor.model = text.substr(colon + 1);
  return motor;
}

Result<StatedBus> bus_of(const CheckOptions& options) {
  StatedBus stated = options.bus;
  for (const auto& [kind, word] : enumerators(devices::BusKind{})) {
    if (options.kind == word) stated.kind = kind;
  }
  for (const std::string& text : options.motors) {
    const auto motor = parse_motor(text);
    if (!motor) return motor.error();
    stated.motors.push_back(*motor);
  }
  if (Check error = check(stated)) {
    const bool framing = error->parameter == "framing", rate = error->parameter == "bits_per_s";
    error->place = framing ? "--framing" : rate ? "--bits-per-s" : "--motors";
    error->parameter.clear();
    return *std::move(error);
  }
  return stated;
}

double position_of(const Checked& checked, std::size_t motor) {
  const double of_motor_rad = checked.found.motors[motor].reading.position_rad;
  return checked.side == nullptr ? of_motor_rad : checked.side->joints[motor].joint.first_position_rad(of_motor_rad);
}

/// Of all joints of a side.
bool slides(const Checked& checked) { return checked.side != nullptr && checked.side->joints.front().slides; }

report::Table table_of(const Checked& checked) {
  using Align = report::Column::Align;
  std::vector<report::Column> columns;
  if (checked.side != nullptr) columns.push_back({"joint", "", Align::left});
  columns.insert(columns.end(), {{"motor"},
                                 {"model", "", Align::left},
                                 {"scales", "", Align::left},
                                 {"firmware"},
                                 {"position", slides(checked) ? "m" : "rad"},
                                 {"heat", "°C"},
                                 {"age", "ms"},
                                 {"state", "", Align::left}});
  report::Table table(std::move(columns));
  for (const std::size_t i : checked.motors) {
    const StatedMotor& stated = checked.bus->motors[i];
    const MotorFinding& motor = checked.found.motors[i];
    std::vector<std::string> row;
    if (checked.side != nullptr) row.emplace_back(checked.side->joints[i].name());
    row.insert(row.end(), {std::to_string(stated.id), stated.model, motor.sheet.scales, motor.sheet.firmware});
    if (checked.found.heard) {
      row.insert(row.end(), {report::fixed(position_of(checked, i), 4), report::fixed(motor.reading.temperature_C, 0),
                             report::fixed(1e3 * motor.age_s, 1)});
    } else {
      row.resize(row.size() + 3);
    }
    const bool asked = checked.found.heard || checked.found.problems.empty();
    row.emplace_back(!motor.problems.empty() ? "wrong" : asked ? "well" : "not asked");
    table.add_row(std::move(row));
  }
  return table;
}

nlohmann::ordered_json json_of(const std::vector<Error>& problems) {
  auto all = nlohmann::ordered_json::array();
  for (const Error& problem : problems) {
    all.push_back({{"place", problem.place}, {"key", problem.parameter}, {"message", problem.message}});
  }
  return all;
}

nlohmann::ordered_json json_of(const Checked& checked) {
  using nlohmann::ordered_json;
  const auto number = [](double value) { return std::isfinite(value) ? ordered_json(value) : ordered_json(nullptr); };
  ordered_json motors = ordered_json::array();
  for (const std::size_t i : checked.motors) {
    const StatedMotor& stated = checked.bus->motors[i];
    const MotorFinding& motor = checked.found.motors[i];
    ordered_json one;
    if (checked.side != nullptr) one["joint"] = checked.side->joints[i].path;
    one.update({{"motor", stated.id},
                {"model", stated.model},
                {"scales", motor.sheet.scales},
                {"firmware", motor.sheet.firmware},
                {checked.bus->kind == devices::BusKind::inverse3 ? "force_limit_N" : "torque_limit_Nm",
                 number(motor.sheet.torque_limit_Nm)}});
    if (checked.found.heard) {
      one.update({{slides(checked) ? "position_m" : "position_rad", number(position_of(checked, i))},
                  {"temperature_C", number(motor.reading.temperature_C)},
                  {"age_s", number(motor.age_s)},
                  {"state", motor.reading.fault == devices::MotorFault::none ? "well" : name_of(motor.reading.fault)}});
    }
    one["problems"] = json_of(motor.problems);
    motors.push_back(std::move(one));
  }
  ordered_json bus;
  if (checked.side != nullptr) bus["side"] = checked.side->path;
  bus.update({{"bus", bus_name(*checked.bus)},
              {"port", checked.bus->port},
              {"cycles_per_s", number(checked.found.rate_Hz)},
              {"problems", json_of(checked.found.problems)},
              {"motors", std::move(motors)}});
  return bus;
}

bool well(const Checked& checked) {
  const auto wrong = [&checked](std::size_t i) { return !checked.found.motors[i].problems.empty(); };
  // One that was not asked for may keep the others from being heard.
  return checked.found.heard && checked.found.problems.empty() && std::ranges::none_of(checked.motors, wrong);
}

void print_problems(const Checked& checked) {
  const auto print = [](const std::vector<Error>& problems, bool with_key) {
    for (const Error& problem : problems) {
      std::cout << report::printable(with_key ? describe(problem) : problem.message) << ".\n";
    }
  };
  print(checked.found.problems, checked.side != nullptr);
  bool wrong = !checked.found.problems.empty();
  for (const std::size_t i : checked.motors) {
    print(checked.found.motors[i].problems, checked.side != nullptr);
    wrong = wrong || !checked.found.motors[i].problems.empty();
  }
  if (!wrong && !checked.found.heard && checked.side != nullptr) {
    std::cout << checked.side->path << ": another motor of this bus is wrong: check all of it.\n";
  }
}

/// Whether motors of one bus are of one model, so that none can tell whether two were swapped.
bool alike(const std::vector<Checked>& all) {
  return std::ranges::any_of(all, [](const Checked& checked) {
    const auto& motors = checked.bus->motors;
    for (std::size_t i = 1; i < motors.size(); ++i) {
      if (std::ranges::count(motors, motors[i].model, &StatedMotor::model) > 1) return true;
    }
    return false;
  });
}

Result<bool> print(const std::vector<Checked>& all, const CheckOptions& options) {
  const bool clean = std::ranges::all_of(all, well);
  if (options.json.wanted) {
    nlohmann::ordered_json document{{"clean", clean}, {"buses", nlohmann::ordered_json::array()}};
    for (const Checked& checked : all) document["buses"].push_back(json_of(checked));
    std::cout << options.json.document(report::json_text(document));
  } else {
    if (clean) {
      double slowest_Hz = std::numeric_limits<double>::infinity();
      for (const Checked& checked : all) slowest_Hz = std::min(slowest_Hz, checked.found.rate_Hz);
      std::cout << "Clean: each motor is what was stated; " << std::llround(slowest_Hz) << " cycles a second.\n";
      if (!options.rig.empty() && alike(all)) {
        std::cout << "Motors of one model cannot detect that two were swapped: move each joint by hand under "
                     "'tactus device watch "
                  << report::printable(options.rig) << "'.\n";
      }
    } else {
      std::cout << "Not clean; no motor got power.\n";
      for (const Checked& checked : all) print_problems(checked);
    }
    for (const Checked& checked : all) {
      std::cout << "\n";
      if (checked.side != nullptr) {
        std::cout << checked.side->path << ": " << bus_name(*checked.bus);
        if (!checked.bus->port.empty()) std::cout << " at " << report::printable(checked.bus->port);
        std::cout << "\n";
      }
      std::cout << table_of(checked).to_text();
    }
  }
  if (Check error = flush_standard_output()) return *std::move(error);
  return clean;
}

Result<bool> check_rig(const CheckOptions& options) {
  const auto rig = Rig::load(options.rig);
  if (!rig) return rig.error();
  const auto sides = rig->sides(options.name);
  if (!sides) return rig->locate(sides.error());
  std::vector<Checked> all;
  for (const RigSide* side : *sides) {
    Checked& checked = all.emplace_back();
    checked.bus = &side->bus;
    checked.side = side;
    checked.found = examine(*rig, *side);
    for (std::size_t i = 0; i < side->joints.size(); ++i) {
      if (Rig::holds(options.name, side->joints[i].path)) checked.motors.push_back(i);
    }
  }
  return print(all, options);
}

Result<bool> check_bus(const CheckOptions& options) {
  const auto stated = bus_of(options);
  if (!stated) return stated.error();
  auto found = devices::examine(*stated);
  if (!found) return found.error();
  std::vector<Checked> all(1);
  all[0].bus = &*stated;
  all[0].found = *std::move(found);
  for (std::size_t i = 0; i < stated->motors.size(); ++i) all[0].motors.push_back(i);
  return print(all, options);
}

}  // namespace

void add_device_check(CLI::App& device, const CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<CheckOptions>();
  CLI::App* verb = device.add_subcommand("check", "Query each motor, report configuration errors, and suggest a fix");
  auto* rig = verb->add_option("RIG", options->rig, "Rig file");
  verb->add_option("NAME", options->name, "Pair, side or joint of the rig, such as arm.leader");
  add_json_option(*verb, options->json, command);
  std::vector<std::string> words;
  for (const auto& entry : enumerators(devices::BusKind{})) words.emplace_back(entry.name);
  auto* bus = verb->add_option("--bus", options->kind, "Kind of bus, without a rig file")->check(CLI::IsMember(words));
  auto* port = verb->add_option("--port", options->bus.port, "Serial port, or CAN interface")->type_name("PATH");
  auto* motors =
      verb->add_option("--motors", options->motors, "Identifier and model of each motor, such as 1:DM4310,2:DM4310")
          ->type_name("ID:MODEL,...")
          ->delimiter(',');
  auto* framing = verb->add_option("--framing", options->bus.framing,
                                   "CAN framing: usb2can, slcan, slcan-fd, socketcan or socketcan-fd");
  auto* rate = verb->add_option("--bits-per-s", options->bus.bits_per_s, "Bit rate that the servos use");
  for (CLI::Option* one : {port, motors, framing, rate}) one->needs(bus);
  bus->needs(port)->needs(motors)->excludes(rig);
  verb->callback([options, bus, rig, &app, &status] {
    if (bus->count() + rig->count() == 0) throw CLI::RequiredError("RIG, or --bus with --port and --motors,");
    end_command(app, rig->count() > 0 ? check_rig(*options) : check_bus(*options), status);
  });
}

}  // namespace tactus::cli
