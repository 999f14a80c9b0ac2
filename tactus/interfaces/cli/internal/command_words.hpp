// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace tactus::cli {

/// Reads the words of a command line, runs the command that they name in this thread and returns its exit status.
/// `name` is what the command calls itself; `argv` is that of `main`. Results and messages go to `streams.hpp`. What
/// nobody can do without, memory or a thread, is thrown.
int run_words(const std::string& name, int argc, const char* const* argv);

}  // namespace tactus::cli
