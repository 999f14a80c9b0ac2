// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/identification/axis/cancellation_model.hpp>
#include <tactus/identification/axis/isolation.hpp>

#include <vector>

namespace tactus::identification {

/// A figure or two for each stage: of a sweep, frequency responses from commanded force to position, measured and
/// modelled, and the coherence of the measured one; of slow loops, position over force; of a crossing, the force that
/// it took.
std::vector<report::Figure> figures(const Isolation& isolation);

/// What impacts induce, measured and modelled.
report::Figure figure(const ImpactCheck& check);

}  // namespace tactus::identification
