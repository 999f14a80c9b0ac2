// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/runtime/link/key.hpp>

#include <memory>
#include <string>

#include <CLI/CLI.hpp>

namespace tactus::cli {

void add_key(CLI::App& app, int& status) {
  auto file = std::make_shared<std::string>();
  CLI::App* verb = app.add_subcommand("key", "Create a key for the encrypted link between two sites");
  verb->add_option("FILE", *file, "New file; copy it to the other site over a channel that you trust")->required();
  verb->callback([file, &app, &status] {
    if (const auto error = link::make_key_file(*file)) {
      status = report_error(app.get_name(), *error);
      return;
    }
    result_stream() << "Key: " << *file << "\n";
  });
}

}  // namespace tactus::cli
