// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/results_schemas.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

struct SchemaOptions {
  std::string kind = "tapping";
  bool reference = false;
  std::vector<std::string> verb;
};

/// The schema of a verb's results. Errors: `out_of_bounds` for a verb that prints no JSON.
Result<std::string_view> results_schema(const std::vector<std::string>& words) {
  std::string verb, name;
  for (const std::string& word : words) {
    verb += (verb.empty() ? "" : "-") + word;
    name += (name.empty() ? "" : " ") + word;
  }
  if (verb == "rehearse") verb = "run";  // which it is, with emulated motors
  std::string known;
  for (const ResultsSchema& schema : results_schemas()) {
    if (schema.verb == verb) return schema.text;
    std::string spaced(schema.verb);
    const bool below = spaced.starts_with("stability-") || spaced.starts_with("identify-") ||
                       spaced.starts_with("estimate-") || spaced.starts_with("device-");
    if (below) spaced[spaced.find('-')] = ' ';
    known += (known.empty() ? "" : ", ") + spaced;
  }
  return Error{.code = ErrorCode::out_of_bounds,
               .parameter = {},
               .message = "'" + name + "' has no results in JSON: write one of " + known,
               .place = "--results"};
}

}  // namespace

void add_schema(CLI::App& app, int& status) {
  auto options = std::make_shared<SchemaOptions>();
  CLI::App* verb = app.add_subcommand("schema", "Print the JSON Schema of an experiment file or of results");
  std::string kinds;
  for (const auto& experiment : experiments::experiments()) {
    kinds += (kinds.empty() ? "" : ", ") + std::string(experiment->kind());
  }
  verb->add_option("KIND", options->kind, "Kind of experiment: " + kinds);
  verb->add_flag("--reference", options->reference, "Print the reference page in Markdown instead");
  verb->add_option("--results", options->verb,
                   "Print the schema of the JSON results of COMMAND, such as run or identify frf")
      ->type_name("COMMAND")
      ->expected(1, 2);
  verb->callback([options, kinds, &app, &status] {
    if (!options->verb.empty()) {
      const auto schema = results_schema(options->verb);
      if (schema) {
        result_stream() << *schema;
        return;
      }
      status = report_error(app.get_name(), schema.error());
      return;
    }
    for (const auto& experiment : experiments::experiments()) {
      if (experiment->kind() != options->kind) continue;
      result_stream() << (options->reference ? experiment->reference() : experiment->schema());
      return;
    }
    status = report_error(app.get_name(),
                          {.code = ErrorCode::out_of_bounds,
                           .parameter = {},
                           .message = "'" + options->kind + "' is no kind of experiment: write one of " + kinds,
                           .place = "schema"});
  });
}

}  // namespace tactus::cli
