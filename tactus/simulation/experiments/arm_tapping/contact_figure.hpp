// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>

#include <string>

namespace tactus::experiments {

/// Both arms on the surface, from the side: their links, the surface, the force of the contact, what the leader's
/// motors display, and the motion that this induces, magnified by a power of ten. `settings` goes into the caption.
report::Figure contact_figure(const ArmPairSetup& setup, const ArmTrace::Contact& contact, const std::string& settings);

}  // namespace tactus::experiments
