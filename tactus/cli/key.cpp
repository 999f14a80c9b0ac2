#include <tactus/cli/commands.hpp>
#include <tactus/link/key.hpp>

#include <iostream>
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
      std::cerr << app.get_name() << ": " << describe(*error) << "\n";
      status = exit_status(*error);
      return;
    }
    std::cout << "Key: " << *file << "\n";
  });
}

}  // namespace tactus::cli
