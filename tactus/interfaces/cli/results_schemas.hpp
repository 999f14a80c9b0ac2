// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace tactus::cli {

/// The JSON Schema of what a command prints with `--json`: a file of `docs/reference/results`, part of the program.
struct ResultsSchema {
  std::string_view verb;  ///< with a hyphen between its words: `stability-map`
  std::string_view text;
};

/// All of them, sorted by command.
std::span<const ResultsSchema> results_schemas();

}  // namespace tactus::cli
