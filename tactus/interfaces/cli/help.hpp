// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// Sets the layout of the help of `app` and of commands that are added later: no line is wider than the terminal
/// (`report::text_width`), and options that several commands have are always in the same order.
void set_help(CLI::App& app);

/// Gives every command of `app` its group and its example. Call it when all commands have been added.
void add_examples(CLI::App& app);

/// Adds `help [COMMAND...]`, which prints the same as `COMMAND... --help`.
void add_help(CLI::App& app, int& status);

}  // namespace tactus::cli
