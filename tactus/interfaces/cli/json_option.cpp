// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/json_writer.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/interfaces/cli/json_option.hpp>
#include <tactus/kernel/core/version.hpp>

#include <algorithm>
#include <array>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using Json = nlohmann::ordered_json;

/// A word of the command line: a number where it is one.
Json value_of(const std::string& word) {
  Json parsed = report::parse_json<Json>(word);
  return parsed.is_number() ? parsed : Json(word);
}

Json value_of(const CLI::Option& option) {
  if (option.get_expected_max() == 0) return option.count() > 0;
  const std::vector<std::string> words =
      option.count() > 0 ? option.results() : std::vector<std::string>{option.get_default_str()};
  if (option.count() == 0 && (words.front().empty())) return nullptr;
  if (words.size() == 1) return value_of(words.front());
  Json list = Json::array();
  for (const std::string& word : words) list.push_back(value_of(word));
  return list;
}

/// What the results do not depend on: how they are shown and where they are left.
constexpr std::array<std::string_view, 4> about_output{"help", "out", "overwrite", "json"};

Json options_of(const CLI::App& verb) {
  Json all = Json::object();
  for (const CLI::Option* option : verb.get_options()) {
    std::string name = option->get_single_name();
    if (std::find(about_output.begin(), about_output.end(), name) == about_output.end()) all[name] = value_of(*option);
  }
  return all;
}

Json seed_in(const Json& configuration) {
  const auto task = configuration.find("task");
  const Json& holder = task != configuration.end() && task->is_object() ? *task : configuration;
  const auto seed = holder.find("seed");
  return seed != holder.end() ? *seed : Json(nullptr);
}

}  // namespace

std::string JsonOption::document(std::string_view results, std::string_view configuration) const {
  Json made_by = options_of(*verb);
  if (!configuration.empty()) {
    if (const auto written = configuration::json_of_toml(configuration)) made_by = report::parse_json<Json>(*written);
  }
  Json all{{"version", version()}, {"command", *command}, {"seed", seed_in(made_by)}, {"configuration", made_by}};
  all.update(report::parse_json<Json>(results));
  return report::json_text(all);
}

void add_json_option(CLI::App& verb, JsonOption& option, const std::string& command, const std::string& help) {
  verb.add_flag("--json", option.wanted, help);
  option.verb = &verb;
  option.command = &command;
}

}  // namespace tactus::cli
