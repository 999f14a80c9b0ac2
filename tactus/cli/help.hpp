#pragma once

namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// Help of `app` and of verbs that are added later: no line is wider than the terminal (`report::text_width`).
void set_help(CLI::App& app);

/// Adds `help [VERB...]`, which prints what `VERB... --help` does.
void add_help(CLI::App& app, int& status);

}  // namespace tactus::cli
