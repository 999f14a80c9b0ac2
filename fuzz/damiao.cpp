// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/damiao/damiao_bus.hpp>
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

using namespace tactus;
using devices::damiao::CanFrame;
using devices::damiao::FrameReader;
using devices::damiao::Framing;

namespace {

void demand(bool holds) {
  if (!holds) std::abort();
}

std::vector<CanFrame> frames_in(Framing framing, std::span<const std::uint8_t> bytes, std::size_t piece) {
  FrameReader reader(framing);
  std::vector<CanFrame> found;
  for (std::size_t at = 0; at < bytes.size(); at += piece) {
    reader.take(bytes.subspan(at, std::min(piece, bytes.size() - at)), [&found](const CanFrame& frame) {
      demand(frame.id <= 0x7ff && frame.size <= 8);
      found.push_back(frame);
    });
  }
  return found;
}

void drive(Framing framing, std::span<const std::uint8_t> bytes, std::size_t piece) {
  devices::damiao::DamiaoBusParams params;
  params.framing = framing;
  params.motors = {{.id = 1, .feedback_id = 0x11}, {.id = 2, .feedback_id = 0x12}};
  const auto bus = *devices::damiao::DamiaoBus::make(params);
  emulation::damiao::PeerSettings settings;
  settings.adapter = static_cast<emulation::damiao::AdapterType>(framing);
  settings.motors = {{.id = 1, .feedback_id = 0x11}, {.id = 2, .feedback_id = 0x12}};
  const auto peer = *emulation::damiao::DamiaoPeer::make(settings);
  std::int64_t now_ns = 0;
  for (std::size_t at = 0; at < bytes.size(); at += piece, now_ns += 1'000'000) {
    const auto some = bytes.subspan(at, std::min(piece, bytes.size() - at));
    bus->hear(some, now_ns);
    while (!bus->say(now_ns).empty()) continue;
    peer->hear(some, now_ns);
    while (!peer->say(now_ns).empty()) continue;
  }
  for (const std::size_t motor : {0U, 1U}) {
    const auto& reading = bus->reading(motor);
    demand(reading.answers >= 0 && reading.position_rad - reading.position_rad == 0.0);
  }
}

}  // namespace

/// The input is what an adapter says, its kind and the size of pieces before it; the emulated motors hear the same.
/// Whole and in pieces the same frames are found; nothing may do harm; what is read is finite.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 2) return 0;
  const auto framing = static_cast<Framing>(data[0] % 5);
  const std::size_t piece = 1 + data[1];
  const std::span<const std::uint8_t> bytes(data + 2, size - 2);
  // Linux' structures come whole, so there a piece is what it is.
  const bool serial = framing <= Framing::slcan_fd;
  if (serial) demand(frames_in(framing, bytes, piece) == frames_in(framing, bytes, bytes.size() + 1));
  drive(framing, bytes, serial ? piece : sizeof(std::uint64_t) * (piece % 2 == 0 ? 2 : 9));
  return 0;
}
