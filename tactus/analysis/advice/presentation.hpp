// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/advise.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <string>

/// Advice for every reader.
namespace tactus::advice {

/// What the advice sets, as `--set` takes it: what was given of `[control]`, the method, display and force gain. Empty
/// without a start.
experiments::Settings settings_of(const Bench& bench, const Candidate& candidate);

/// The advice in one sentence that a user can act on.
std::string sentence(const Bench& bench, const Advice& advice);
/// The measurement that would buy most gain, and how much.
std::string next_measurement(const Bench& bench, const Advice& advice);

/// What `tactus run --with` loads: `settings_of` the start, which there must be, as TOML below command and sentence.
std::string advice_toml(const Bench& bench, const Advice& advice, const std::string& command);

/// Text whose first line is the sentence, JSON and a page. Errors: those of reading the document.
Result<experiments::Outcome> present(const Bench& bench, const Advice& advice, const experiments::Request& request);

}  // namespace tactus::advice
