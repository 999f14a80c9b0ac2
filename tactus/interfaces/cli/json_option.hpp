// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// What a command line states about JSON, and what made the results.
struct JsonOption {
  bool wanted = false;
  const CLI::App* verb = nullptr;
  const std::string* command = nullptr;

  /// Results, a JSON object as text, as they are printed and written, with what made them in front:
  ///
  /// - `version` of tactus;
  /// - `command`, as a user would type it again;
  /// - `seed` that draws what is random: `task.seed` of the configuration, else that of an option; null where nothing
  ///   is drawn;
  /// - `configuration`: where there is an experiment, all of its keys, defaults included (of several combinations those
  ///   of the first; `set` of each states what differs), and else the command's options.
  ///
  /// `configuration` is TOML, empty where there is no experiment.
  [[nodiscard]] std::string document(std::string_view results, std::string_view configuration = {}) const;
};

/// Adds `--json` to a command whose command line is `command`; both outlive `option`.
void add_json_option(CLI::App& verb, JsonOption& option, const std::string& command,
                     const std::string& help = "Print one JSON document and nothing else");

}  // namespace tactus::cli
