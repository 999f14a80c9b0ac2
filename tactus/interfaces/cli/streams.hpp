// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <ostream>
#include <string_view>

/// Where a command prints. In the `tactus` program that is standard output and standard error; a program that runs
/// commands itself (in_process.hpp) gets both as text. All of this is for the thread that runs the command.
namespace tactus::cli {

/// For results.
std::ostream& result_stream();
/// For errors, notes and whatever else is not part of the results.
std::ostream& message_stream();

/// Prints the error as every command does, `name: place: parameter: message`, and returns its exit status.
int report_error(std::string_view name, const Error& error);

/// Whether the command runs in a program that is not the `tactus` command. Signals, standard streams and what else a
/// process has one of are not ours there.
bool is_in_process();

/// Reports the share of the work that is done, 0 to 1, to the program that runs the command. Where that wants the end,
/// it throws what `run_in_process` catches; so no lock may be held that the unwinding does not release.
void report_progress(double done);

}  // namespace tactus::cli
