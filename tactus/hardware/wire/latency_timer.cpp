// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/latency_timer.hpp>

#include <fstream>
#include <system_error>

namespace tactus::wire {

Check check_latency_timer(const std::string& port, const std::filesystem::path& system) {
  std::error_code problem;
  const auto device = std::filesystem::canonical(port, problem);
  if (problem) return std::nullopt;  // who opens it says so
  const auto timer = system / "bus/usb-serial/devices" / device.filename() / "latency_timer";
  std::ifstream file(timer);
  int waits_ms = 0;
  if (!(file >> waits_ms) || waits_ms <= 1) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = {},
               .message = "the adapter holds received bytes for " + std::to_string(waits_ms) +
                          " ms before it hands it over, where 1 ms is needed: echo 1 | sudo tee " + timer.string(),
               .place = port};
}

}  // namespace tactus::wire
