#include <tactus/cli/verbs.hpp>
#include <tactus/experiments/experiment.hpp>

#include <iostream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

struct SchemaOptions {
  std::string kind = "tapping";
  bool reference = false;
};

}  // namespace

void add_schema(CLI::App& app, int& status) {
  auto options = std::make_shared<SchemaOptions>();
  CLI::App* verb = app.add_subcommand("schema", "Print what an experiment file may say, as JSON Schema");
  std::string kinds;
  for (const auto& experiment : experiments::experiments()) {
    kinds += (kinds.empty() ? "" : ", ") + std::string(experiment->kind());
  }
  verb->add_option("KIND", options->kind, "Kind of experiment: " + kinds);
  verb->add_flag("--reference", options->reference, "Print the reference page in Markdown instead");
  verb->callback([options, kinds, &app, &status] {
    for (const auto& experiment : experiments::experiments()) {
      if (experiment->kind() != options->kind) continue;
      std::cout << (options->reference ? experiment->reference() : experiment->schema());
      return;
    }
    std::cerr << app.get_name() << ": schema: '" << options->kind << "' is no kind of experiment: write one of "
              << kinds << "\n";
    status = 2;
  });
}

}  // namespace tactus::cli
