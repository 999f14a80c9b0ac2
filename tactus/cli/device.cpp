#include <tactus/cli/device.hpp>
#include <tactus/cli/standard_output.hpp>
#include <tactus/cli/verbs.hpp>
#include <tactus/devices/bus_thread.hpp>
#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <chrono>
#include <cmath>
#include <iostream>
#include <thread>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

using devices::BusReadings;
using devices::MotorFault;

/// A kind of bus is a line here.
constexpr std::array bus_kinds{BusKind{"damiao", &make_damiao_bus}, BusKind{"dynamixel", &make_dynamixel_bus},
                               BusKind{"feetech", &make_feetech_bus}};

struct DeviceOptions {
  StatedBus bus{.kind = {}, .port = {}, .motors = {}, .framing = "usb2can"};
  std::vector<std::string> motors;
};

Result<StatedMotor> parse_motor(const std::string& text) {
  StatedMotor motor;
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

/// What is wrong with a motor that answers, and what mends it; empty where it is well.
std::string remedy_of(MotorFault fault) {
  switch (fault) {
    case MotorFault::none:
      return {};
    case MotorFault::silent:
      return "does not answer any more: look at its power and its plug";
    case MotorFault::voltage:
      return "its supply is too high or too low: measure it under load";
    case MotorFault::current:
      return "its current was too high: look for a short or a jam";
    case MotorFault::hot:
      return "too hot: let it cool, and lower the torque limit";
    case MotorFault::lost_master:
      return "let go when nobody spoke to it: this is cleared when it gets power";
    case MotorFault::overload:
      return "overloaded: take the load off; this is cleared when it gets power";
    case MotorFault::encoder:
      return "does not know where it is: start anew";
    case MotorFault::refused:
      return "refused what it was asked: switch it off and on";
  }
  return {};
}

std::string cell(double value) {
  constexpr int digits = 4;
  return std::isfinite(value) ? report::number(value, digits) : "not told";
}

/// Runs cycles without power for so long. None where the bus ended meanwhile.
std::optional<BusReadings> look(const devices::BusThread& bus, double& rate_Hz) {
  constexpr std::chrono::milliseconds duration{500};
  const auto before = bus.newest();
  std::this_thread::sleep_for(duration);
  const auto after = bus.newest();
  if (!before || !after || !bus.running()) return std::nullopt;
  rate_Hz = static_cast<double>(after->cycles - before->cycles) /
            (static_cast<double>(after->time_ns - before->time_ns) * 1e-9);
  return after;
}

/// Whether all is well.
Result<bool> check_bus(const DeviceOptions& options) {
  StatedBus stated = options.bus;
  for (const std::string& text : options.motors) {
    const auto motor = parse_motor(text);
    if (!motor) return motor.error();
    stated.motors.push_back(*motor);
  }
  const auto kind = std::find_if(bus_kinds.begin(), bus_kinds.end(),
                                 [&stated](const BusKind& one) { return one.name == stated.kind; });
  auto made = kind->make(stated);
  if (!made) return made.error();
  const auto sheet = std::move(made->sheet);
  auto bus = devices::BusThread::start(std::move(made->bus), std::move(made->port), {});
  if (!bus) return bus.error();

  Check wrong = (*bus)->wait_until_asked(Seconds{10.0});
  if (wrong && (*bus)->bus().state() != devices::BusState::refused) return *std::move(wrong);
  double rate_Hz = 0.0;
  std::optional<BusReadings> readings;
  if (!wrong) readings = look(**bus, rate_Hz);
  (*bus)->stop();

  report::Table table({{"motor"},
                       {"model", "", report::Column::Align::left},
                       {"scales", "", report::Column::Align::left},
                       {"firmware"},
                       {"position", "rad"},
                       {"temperature", "°C"},
                       {"age", "ms"},
                       {"verdict", "", report::Column::Align::left}});
  std::vector<std::string> wrongs;
  for (std::size_t i = 0; i < stated.motors.size(); ++i) {
    const MotorSheet told = sheet(i);
    const std::string id = std::to_string(stated.motors[i].id);
    std::string found = told.problem ? told.problem->message : std::string();
    std::vector<std::string> row{id, stated.motors[i].model, told.scales, told.firmware};
    if (readings) {
      const auto& motor = readings->motors[i];
      if (const std::string remedy = remedy_of(motor.fault); !remedy.empty()) found = "motor " + id + ": " + remedy;
      row.push_back(cell(motor.position_rad));
      row.push_back(cell(motor.temperature_C));
      row.push_back(cell(1e-6 * static_cast<double>(readings->time_ns - motor.heard_ns)));
    } else {
      row.resize(row.size() + 3);
    }
    row.emplace_back(found.empty() ? "well" : "wrong");
    table.add_row(std::move(row));
    if (!found.empty()) wrongs.push_back(std::move(found));
  }
  const bool well = wrongs.empty() && readings.has_value();
  if (well) {
    std::cout << "Clean: each motor is what was stated; " << std::llround(rate_Hz) << " cycles a second.\n\n";
  } else {
    std::cout << "Not clean; no motor got power.\n";
    if (!readings && !wrong) std::cout << "The port was closed meanwhile.\n";
    for (const std::string& one : wrongs) std::cout << report::printable(one) << ".\n";
    std::cout << "\n";
  }
  std::cout << table.to_text();
  if (Check error = flush_standard_output()) return *std::move(error);
  return well;
}

}  // namespace

void add_device(CLI::App& app, int& status) {
  auto options = std::make_shared<DeviceOptions>();
  CLI::App* verb = app.add_subcommand("device", "Motors and handles that you own");
  verb->require_subcommand(1);
  CLI::App* chosen = verb->add_subcommand("check", "Ask each motor what it is; what is wrong, and what mends it");
  std::vector<std::string> words;
  for (const BusKind& kind : bus_kinds) words.emplace_back(kind.name);
  chosen->add_option("--bus", options->bus.kind, "Kind of bus")->check(CLI::IsMember(words))->required();
  chosen->add_option("--port", options->bus.port, "Serial port, or CAN interface")->type_name("PATH")->required();
  chosen->add_option("--motors", options->motors, "Each motor's id and model, as in 1:DM4310,2:DM4310")
      ->type_name("ID:MODEL,...")
      ->delimiter(',')
      ->required();
  chosen->add_option("--framing", options->bus.framing, "Of CAN: usb2can, slcan, slcan-fd, socketcan or socketcan-fd")
      ->capture_default_str();
  chosen->add_option("--bits-per-s", options->bus.bits_per_s, "Of servos: what each has set")->capture_default_str();
  chosen->callback([options, &app, &status] {
    const auto well = check_bus(*options);
    if (!well) std::cerr << app.get_name() << ": " << describe(well.error()) << "\n";
    status = !well ? exit_status(well.error()) : (*well ? 0 : 1);
  });
}

}  // namespace tactus::cli
