// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

/// What `tactus identify` can identify: each adds one subcommand to `identify`, in a file of its own
/// (`identify_<what>.cpp`). When chosen, it does its work and leaves its exit status in `status`; messages begin with
/// `name`, which is what the program calls itself.
namespace tactus::cli {

void add_identify_arm(CLI::App& identify, const std::string& name, const std::string& command, int& status);
void add_identify_excitation(CLI::App& identify, const std::string& name, const std::string& command, int& status);
void add_identify_frf(CLI::App& identify, const std::string& name, const std::string& command, int& status);
void add_identify_inverse(CLI::App& identify, const std::string& name, const std::string& command, int& status);
void add_identify_bench(CLI::App& identify, const std::string& name, const std::string& command, int& status);
void add_identify_operator(CLI::App& identify, const std::string& name, const std::string& command, int& status);
void add_identify_prediction(CLI::App& identify, const std::string& name, const std::string& command, int& status);

}  // namespace tactus::cli
