// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/rig/bus_kinds.hpp>
#include <tactus/kernel/core/result.hpp>

#include <filesystem>
#include <string>
#include <vector>

/// What is at the ports of this machine.
namespace tactus::devices {

/// A port as Linux shows it. Nothing was opened.
struct FoundPort {
  std::string path;    ///< `/dev/ttyUSB0`; the name of an interface of CAN
  std::string name;    ///< by which it stays the same: in `/dev/serial/by-id`; empty without such a name
  std::string remark;  ///< what is wrong with it, such as a slow latency timer
};
/// Serial adapters and interfaces of CAN. `device` and `system` are where Linux shows them.
std::vector<FoundPort> list_ports(const std::filesystem::path& device = "/dev",
                                  const std::filesystem::path& system = "/sys");

/// Motors that answered.
struct Answering {
  StatedBus bus;                  ///< with those motors; the model empty where they do not determine it
  std::vector<std::string> said;  ///< of each, for a user
};

/// Asks at a serial port who is there, in each protocol and at each bit rate that motors are commonly set to. It writes
/// questions alone, which change nothing in a motor, but to what is not one of ours they are bytes of any meaning.
/// Blocks for about two seconds. Errors: those of the port.
Result<std::vector<Answering>> probe(const std::string& port);

}  // namespace tactus::devices
