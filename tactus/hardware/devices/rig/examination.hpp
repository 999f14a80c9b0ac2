// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_bus.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/kernel/core/result.hpp>

#include <string>
#include <vector>

/// What motors report of themselves when they are asked, and what is wrong with that. No motor gets power.
namespace tactus::devices {

/// What is wrong with a motor that answers, and what fixes it; empty where it is well.
const char* remedy_of(MotorFault fault);

struct MotorFinding {
  MotorSheet sheet;
  MotorReading reading;  ///< as last reported; meaningless unless the bus was `heard`
  double age_s = 0.0;    ///< of that
  std::vector<Error> problems;
};

struct BusFinding {
  std::vector<MotorFinding> motors;
  std::vector<Error> problems;  ///< of the bus as a whole
  bool heard = false;           ///< all motors are what was stated, and cycles ran
  double rate_Hz = 0.0;         ///< of its cycles

  [[nodiscard]] bool well() const;
};

/// Opens the port, asks all motors, runs cycles for half a second, and closes it. Where none answers at the stated bit
/// rate, the others that its servos know are tried. Problems have the parameters of `check(StatedBus)`. Errors: those
/// of `open_bus`; no thread. Blocks for a second, for ten at most.
Result<BusFinding> examine(const StatedBus& stated);

/// Why `tactus run` cannot drive a joint of this side with any experiment, under the key of the file; no value where it
/// can. A motor that takes no command of force can lead and not follow. Nothing is opened: `device check` and `run`
/// both ask this.
Check refuse_undrivable(const RigSide& side, const RigJoint& joint);

/// The same of a side of a rig, with what its joints make of it; every problem has the line of its key. A
/// joint that cannot be driven (`refuse_undrivable`) has that problem too.
BusFinding examine(const Rig& rig, const RigSide& side);

/// What is wrong with a joint whose motor reports that, under the key that it contradicts: outside of its limits, too
/// hot, more torque than the motor is set to give. `file` is for the command that fixes it.
std::vector<Error> judge(const RigJoint& joint, const MotorFinding& found, const std::string& file);

}  // namespace tactus::devices
