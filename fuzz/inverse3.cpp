// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/inverse3/messages.hpp>
#include <tactus/hardware/emulation/inverse3/inverse3_service.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string_view>

using namespace tactus;

namespace {

void demand(bool holds) {
  if (!holds) std::abort();
}

/// A service, a client that heard its snapshot, and one that knows a device.
struct Begun {
  emulation::inverse3::Inverse3Service service = emulation::inverse3::Inverse3Service::make({}).value();
  devices::inverse3::Devices told, knowing;
  Begun() {
    demand(!told.take(service.snapshot(0)));
    demand(!knowing.take(R"({"inverse3":[{"device_id":"049D","status":{"ready":true}}]})"));
  }
};

}  // namespace

/// The input is what a service tells, what a client tells it, and what it answers to GET /version. Nothing may do harm;
/// what is refused changes nothing, and the emulated service answers each message with a state that is understood.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);  // NOLINT: bytes are text here
  static const Begun begun;
  devices::inverse3::Devices devices = begun.knowing;
  if (devices.take(text)) demand(devices.all().size() == 1 && devices.all().front().ready);
  (void)devices::inverse3::dialect_of(text);

  auto service = begun.service;
  devices::inverse3::Devices told = begun.told;
  for (int tick = 0; tick < 3; ++tick) demand(!told.take(service.answer(text, tick * 1'000'000).text));
  for (const double force_N : told.all().front().force_N) demand(std::abs(force_N) <= 10.0);
  (void)service.http("POST", text, text);
  return 0;
}
