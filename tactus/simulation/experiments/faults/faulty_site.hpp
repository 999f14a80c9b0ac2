// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/station/device.hpp>
#include <tactus/simulation/experiments/faults/process.hpp>
#include <tactus/simulation/experiments/faults/witness.hpp>
#include <tactus/simulation/teleoperator/packet_relay.hpp>

#include <vector>

namespace tactus::experiments {

/// One site of a run with faults: the plant that it drives, the process that it runs in, and what is between them
/// and the site, where faults have their place. To the site it is its device.
template <class PlantOfSite, class SupervisedSite>
struct FaultySite {
  /// What a site last commanded, and what its drives make of that.
  struct Forces {
    double motor_N = 0.0;
    double handle_N = 0.0;
    double drive_N = 0.0;
    bool enabled = true;  ///< the line that switches the drive on
  };

  FaultSite where;
  PlantOfSite plant;
  SupervisedSite site;
  std::vector<SupervisedSite> restarted;  ///< what a process that is started again runs, the next one last
  FaultProcess process;
  simulation::PacketRelay inbox;  ///< the link from the other site
  PacketWitness sent;             ///< what this site sent, and what the other applied of it
  Forces forces{};
  station::DeviceReading sensed{};  ///< at this tick, faults included

  station::DeviceReading read(const station::Tick&) noexcept { return sensed; }
  void write(const station::DeviceCommand& command) noexcept {
    forces.motor_N = command.force_N;
    forces.handle_N = command.handle_force_N;
    forces.enabled = command.enabled;
  }
};

}  // namespace tactus::experiments
