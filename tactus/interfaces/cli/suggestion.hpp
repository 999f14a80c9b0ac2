#pragma once

#include <string>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// The verb of this name below `app`, or null.
const CLI::App* verb_below(const CLI::App& app, const std::string& name);

/// `'rnu' is no command: did you mean run?`, without the question where none is near.
std::string unknown_command(const CLI::App& app, const std::string& word);

/// What a command line that could not be parsed asked for that is not there, where that is a verb or an option; else
/// empty. `argv` is that of `main`.
std::string unknown_word(const CLI::App& app, int argc, const char* const* argv);

}  // namespace tactus::cli
