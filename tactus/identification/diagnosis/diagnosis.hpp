// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/axis_signals.hpp>
#include <tactus/identification/diagnosis/decision.hpp>
#include <tactus/identification/diagnosis/evidence.hpp>
#include <tactus/identification/diagnosis/following.hpp>
#include <tactus/identification/diagnosis/oscillation.hpp>
#include <tactus/identification/diagnosis/signals.hpp>

#include <optional>
#include <string>
#include <vector>

namespace tactus::diagnosis {

/// One oscillation with what it rests on.
struct Finding {
  Oscillation oscillation;
  Evidence evidence;
  Decision decision;
  /// For small motion, from what limits the force: by how much that loop must be turned down (`loop_gain`).
  std::optional<identification::Estimate> loop_gain;
};

struct Diagnosis {
  std::vector<Finding> findings;  ///< the strongest first
  std::string verdict;            ///< one or two sentences that a user can act on
  std::vector<std::string> record_next;
  std::optional<Following> following;  ///< where both positions move together
};

/// What shakes in a recording and why. Not real-time safe.
Diagnosis diagnose(const Signals& signals);

}  // namespace tactus::diagnosis
