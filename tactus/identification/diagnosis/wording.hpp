// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/diagnosis/decision.hpp>
#include <tactus/identification/diagnosis/evidence.hpp>

#include <string>
#include <vector>

namespace tactus::diagnosis {

/// What the signals show of an oscillation, in sentences with numbers and units.
std::vector<std::string> sentences_of(const Signals& signals, const Oscillation& oscillation, const Evidence& evidence);

}  // namespace tactus::diagnosis
