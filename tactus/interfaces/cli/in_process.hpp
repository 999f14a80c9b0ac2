// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace tactus::cli {

/// What a command left that ran in a program of somebody else.
struct InProcessOutcome {
  int status = 0;                   ///< exit status of the command
  std::string results;              ///< what it would print to standard output
  std::string messages;             ///< what it would print to standard error: notes, and the error's line
  std::optional<Error> error = {};  ///< why the status is not 0, where the command reported one
  bool interrupted = false;         ///< ended early because `progress` returned false; there are no results then
};

/// Called in the thread of the command with the share of the work that is done, 0 to 1, at most fifty times a second
/// and never by some commands; false ends the command before its next piece of work.
using InProcessProgress = std::function<bool(double done)>;

/// Runs one command of tactus in this thread, as `tactus WORDS...` does: `{"run", "tapping.toml", "--json"}`. What it
/// prints is in the outcome, without colours, and tables are 80 columns wide. It writes the files that its options
/// name.
///
/// Refused with an error (`inconsistent`): the commands that drive devices, measure the machine or serve others
/// (`device`, `doctor`, `emulate`, `plant`, `rehearse`, `relay`, `serve`), `--plugin`, and what runs at the real clock,
/// for these take signals and threads of the process. `progress` may be empty, and must not run another command.
///
/// Any thread; commands of several threads run one after the other. What is thrown, for lack of memory or of a thread,
/// is an error (`failed`). Not real-time safe.
InProcessOutcome run_in_process(const std::vector<std::string>& words, const InProcessProgress& progress);

/// Held while a command runs. HDF5, as Debian has it, and matio keep state for the whole process: a program that reads
/// files with them outside of a command holds it too.
std::mutex& one_command_at_a_time();

}  // namespace tactus::cli
