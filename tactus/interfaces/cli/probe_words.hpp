// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/kernel/control/sign_probe.hpp>

#include <string>

namespace tactus::cli {

/// What the sign probe of a rig's joint found wrong, as the rest of a line: joint, torque and travel with units, and
/// what to do. Empty for a probe that passed or is not over.
std::string words_of(const control::ProbeReport& found, const devices::RigJoint& joint);

}  // namespace tactus::cli
