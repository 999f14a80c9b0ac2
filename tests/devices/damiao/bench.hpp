// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/damiao/damiao_bus.hpp>
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>
#include <tactus/hardware/wire/join.hpp>
#include <tactus/hardware/wire/paced.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tactus::devices::damiao {
namespace bus_test {

using emulation::damiao::AdapterType;
using emulation::damiao::DamiaoPeer;
using emulation::damiao::FaultKind;
using EmulatedFault = emulation::damiao::Fault;

inline constexpr std::int64_t ms = 1'000'000;
inline constexpr double torque_step_Nm = 20.0 / 4095.0;
inline constexpr std::array all_framings{Framing::usb2can, Framing::slcan, Framing::slcan_fd, Framing::socketcan,
                                         Framing::socketcan_fd};

/// A bus and the emulated motors behind it, in virtual time.
struct Bench {
  struct Setup {
    std::size_t motors = 2;
    Framing framing = Framing::usb2can;
    std::vector<EmulatedFault> faults = {};
    std::uint64_t seed = 1;
  };

  explicit Bench(const Setup& setup) {
    DamiaoBusParams params;
    emulation::damiao::PeerSettings settings;
    params.framing = setup.framing;
    // The same words in another module.
    settings.adapter = static_cast<AdapterType>(setup.framing);
    settings.faults = setup.faults;
    settings.seed = setup.seed;
    for (std::uint32_t id = 1; id <= setup.motors; ++id) {
      params.motors.push_back({.id = id, .feedback_id = id + 0x10, .model = Model::dm4310});
      settings.motors.push_back({.id = id, .feedback_id = id + 0x10});
    }
    bus = *DamiaoBus::make(params);
    peer = *DamiaoPeer::make(settings);
    const bool serial = is_serial(settings.adapter);
    if (serial) paced = std::make_unique<wire::Paced>(*peer, wire::byte_ns(921'600), wire::Paced::Line::full_duplex);
  }

  void run(std::int64_t duration_ns) {
    wire::WireEnd& there = paced ? static_cast<wire::WireEnd&>(*paced) : *peer;
    wire::join(*bus, there, now_ns, now_ns + duration_ns);
    now_ns += duration_ns;
  }
  void command_all(double torque_Nm, bool enabled = true) {
    for (std::size_t motor = 0; motor < bus->motors(); ++motor) {
      bus->command(motor, {.torque_Nm = torque_Nm, .enabled = enabled ? 1 : 0});
    }
  }
  /// Whether no motor ever gave more than is between zero and this torque, but for a step of its number.
  [[nodiscard]] bool never_beyond(double torque_Nm) const {
    for (std::size_t motor = 0; motor < bus->motors(); ++motor) {
      if (peer->motor(motor).most_torque_Nm() > std::max(torque_Nm, 0.0) + torque_step_Nm) return false;
      if (peer->motor(motor).least_torque_Nm() < std::min(torque_Nm, 0.0) - torque_step_Nm) return false;
    }
    return true;
  }
  [[nodiscard]] std::string problem() const { return bus->problem() ? describe(*bus->problem()) : std::string(); }

  std::unique_ptr<DamiaoBus> bus;
  std::unique_ptr<DamiaoPeer> peer;
  std::unique_ptr<wire::Paced> paced;
  std::int64_t now_ns = 0;
};

}  // namespace bus_test
}  // namespace tactus::devices::damiao
