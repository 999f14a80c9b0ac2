// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/heat_map.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/identification/diagnosis/diagnosis.hpp>

#include <optional>
#include <string>

namespace tactus::diagnosis {

/// For a terminal, the verdict first.
std::string to_text(const Signals& signals, const Diagnosis& diagnosis);

/// One JSON document: `oscillations`, `verdict`, `record_next`, and what was read.
std::string to_json(const Signals& signals, const Diagnosis& diagnosis, const std::string& file);

/// The power of a signal over time and frequency, in decades below its largest.
report::HeatMap spectrogram_of(const Signals& signals, const Diagnosis& diagnosis);

/// The signals over a dozen periods of the strongest oscillation; none without an oscillation.
std::optional<report::Figure> periods_of(const Signals& signals, const Diagnosis& diagnosis);

/// The loop as lines of text: what goes round, with amplitude and phase of each signal.
std::string loop_of(const Signals& signals, const Finding& finding);

/// A report of all this; the caller adds its footer.
report::Page to_page(const Signals& signals, const Diagnosis& diagnosis, const std::string& file);

}  // namespace tactus::diagnosis
