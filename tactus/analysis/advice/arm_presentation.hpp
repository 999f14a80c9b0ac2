// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/arm_advise.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <string>

/// Advice on two arms for every reader, in the shape of that on one axis.
namespace tactus::advice {

/// What the advice sets, as `--set` takes it: what was given of `[control]`, the method and the force gain. Empty
/// without a start.
experiments::Settings settings_of(const ArmBench& bench, const ArmCandidate& candidate);

/// The advice in one sentence that a user can act on.
std::string sentence(const ArmBench& bench, const ArmAdvice& advice);

/// What `tactus run --with` loads: `settings_of` the start, which there must be, as TOML below command and sentence.
std::string advice_toml(const ArmBench& bench, const ArmAdvice& advice, const std::string& command);

/// Text whose first line is the sentence, JSON and a page. Errors: those of reading the document.
Result<experiments::Outcome> present(const ArmBench& bench, const ArmAdvice& advice,
                                     const experiments::Request& request);

}  // namespace tactus::advice
