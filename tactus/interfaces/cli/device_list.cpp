// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/hardware/devices/rig/probe.hpp>
#include <tactus/interfaces/cli/device.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

struct ListOptions {
  std::vector<std::string> ports;
  bool probe = false;
};

std::string described(const devices::Answering& found) {
  std::string text = std::string("  ") + name_of(found.bus.kind);
  if (found.bus.kind == devices::BusKind::damiao) {
    text += ", framing = \"" + found.bus.framing + "\"";
  } else {
    text += ", bits_per_s = " + std::to_string(found.bus.bits_per_s);
  }
  text += ":";
  std::size_t begin = 0;  // of the last line
  for (std::size_t i = 0; i < found.bus.motors.size(); ++i) {
    const std::string motor = std::to_string(found.bus.motors[i].id) + " (" + found.said[i] + ")";
    if (i > 0) text += ",";
    // With a blank before it and a comma behind it.
    if (text.size() - begin + motor.size() + 2 > report::text_width()) {
      text += "\n   ";
      begin = text.size() - 3;
    }
    text += " " + motor;
  }
  return text;
}

Result<bool> list(const ListOptions& options) {
  std::vector<devices::FoundPort> ports;
  if (options.ports.empty()) ports = devices::list_ports();
  for (const std::string& path : options.ports) ports.push_back({.path = path, .name = {}, .remark = {}});
  if (ports.empty()) {
    std::cout << "No serial adapter and no CAN interface: plug one in, and read the output of dmesg.\n";
  }
  bool well = true;
  for (const devices::FoundPort& port : ports) {
    std::cout << report::printable(port.path) << (port.name.empty() ? "" : "  " + report::printable(port.name)) << "\n";
    if (!port.remark.empty()) std::cout << "  " << report::printable(port.remark) << "\n";
    const bool serial = port.path.starts_with("/");
    if (!options.probe || !serial) continue;
    const auto found = devices::probe(port.path);
    if (!found) {
      std::cout << "  " << report::printable(found.error().message) << "\n";
      well = false;
      continue;
    }
    if (found->empty()) std::cout << "  nobody answers: look at the power of the motors\n";
    for (const devices::Answering& one : *found) std::cout << described(one) << "\n";
  }
  if (Check error = flush_standard_output()) return *std::move(error);
  return well;
}

}  // namespace

void add_device_list(CLI::App& device, const CLI::App& app, int& status) {
  auto options = std::make_shared<ListOptions>();
  CLI::App* verb = device.add_subcommand(
      "list", "List serial adapters and CAN interfaces, and with --probe the devices behind them");
  verb->add_option("PORT", options->ports, "Ports to list; all by default");
  verb->add_flag(
      "--probe", options->probe,
      "Query the devices at each port; this changes nothing in a motor. Do not use it if a port has a device that "
      "is not yours");
  verb->callback([options, &app, &status] { end_command(app, list(*options), status); });
}

}  // namespace tactus::cli
