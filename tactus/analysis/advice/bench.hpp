// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/knowledge.hpp>
#include <tactus/analysis/advice/methods.hpp>
#include <tactus/data/configuration/document.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// What is advised on.
namespace tactus::advice {

/// An experiment with what must stay as it is, and what is known of its rig.
struct Bench {
  configuration::Document document;  ///< of kind tapping, with the values that were given
  Conditions given;
  Knowledge knowledge;
  std::filesystem::path results = {};  ///< where the knowledge comes from; empty: what the document states
  std::vector<std::string> set = {};   ///< of what was given, the values that are in no file: `key=value`
};

/// From a document on which the files of `with` and the values of `set` are already applied. What is known comes from
/// the results.json alongside a file that holds the controller's model; without one, from the document's
/// `task.model_error`, which then counts for the searched rigs and no longer for each tap. Errors: `inconsistent` for
/// another kind than tapping; those of reading the files.
Result<Bench> make_bench(configuration::Document document, const std::vector<std::string>& with,
                         const std::vector<std::string>& set);

/// Which choices of each dimension agree with what was given. Where none does, the dimension has one choice without
/// settings: as given. Errors: those of reading the document.
Result<std::vector<Dimension>> allowed(const Bench& bench, const std::vector<Dimension>& dimensions);

/// The parameters of a method on top of the document; with a display that saturates at `force_limit_N`, where that is
/// given. Errors: those of reading the document.
Result<experiments::TappingParams> params_of(const Bench& bench, const Method& method,
                                             std::optional<double> force_limit_N = {});

}  // namespace tactus::advice
