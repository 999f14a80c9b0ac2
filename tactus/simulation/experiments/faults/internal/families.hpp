// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/signal/random.hpp>
#include <tactus/simulation/experiments/faults/rows.hpp>

#include <cmath>
#include <vector>

/// Rows by what fails. Each family draws the rest of a plan of its own kinds and leaves those of others as they are.
namespace tactus::experiments::fault_families {

/// Ticks that a message may wait at a tick boundary on its way, and a state for its packet.
inline constexpr double grace_ticks = 6.0;

/// The drive of a device that is in use lets go of a command that is as old.
inline constexpr double drive_timeout_s = 0.02;
/// Clocks of two machines may differ by so much; crystals by a tenth of it.
inline constexpr double tolerable_drift = 1e-3;

inline constexpr std::string_view late = "not stopped within the time-out", unseen = "not detected";

/// Drawn evenly in its logarithm.
inline double between_logarithms(signal::Random& random, double lower, double upper) {
  return lower * std::pow(upper / lower, random.uniform());
}

/// The passivity monitors as loose as their bounds allow.
inline void loosen_monitor(simulation::Teleoperator::Params& params) {
  for (control::SafetyGate::Params* gate : {&params.control.gate, &params.control.slave_gate}) {
    gate->energy.damp_above_J = 100.0;
    gate->energy.hold_above_J = 200.0;
    gate->energy.credit_J = 100.0;
    gate->energy.drain_W = 50.0;
  }
}

/// Motors, encoders, force sensors, wiring, supply, and the hand on the handle.
std::vector<FaultRow> device_rows();
void draw_device(FaultPlan& plan, signal::Random& random, double sign);

/// Clocks, ways, the other site, configuration, the person's buttons, and several faults at once.
std::vector<FaultRow> course_rows();
void draw_course(FaultPlan& plan, signal::Random& random, double sign);

}  // namespace tactus::experiments::fault_families
