// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/kernel/control/support_raise.hpp>

#include <string>

namespace tactus::cli {

/// What is wrong with the support of a joint of a rig, as the rest of a line: which joint, what was measured with
/// units, the likely cause and what to look at. Empty where nothing is wrong.
std::string words_of(const control::SupportFinding& found, const devices::RigJoint& joint);

}  // namespace tactus::cli
