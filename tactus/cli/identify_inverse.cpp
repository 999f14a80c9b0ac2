#include <tactus/cli/identify.hpp>

#include <iostream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

namespace tactus::cli {

void add_identify_inverse(CLI::App& identify, const std::string& name, const std::string& command, int& status) {
  auto file = std::make_shared<std::string>();
  CLI::App* verb = identify.add_subcommand("inverse", "Inverse dynamic model of one axis from a recording");
  verb->add_option("RECORDING", *file, "Recording (.csv, .tsv, .txt or .mat)")->required();
  verb->callback([file, name, &command, &status] {
    std::cerr << name << ": identify inverse is not built yet: " << command << "\n";
    status = 1;
  });
}

}  // namespace tactus::cli
