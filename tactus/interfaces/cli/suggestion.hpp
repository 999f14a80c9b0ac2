// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// The command of this name below `app`, or null.
const CLI::App* verb_below(const CLI::App& app, const std::string& name);

/// `'rnu' is no command: did you mean run?`, without the question where none is near.
std::string unknown_command(const CLI::App& app, const std::string& word);

/// The unknown command or option of a command line that could not be parsed; empty if the cause is another one.
/// `argv` is that of `main`.
std::string unknown_word(const CLI::App& app, int argc, const char* const* argv);

}  // namespace tactus::cli
