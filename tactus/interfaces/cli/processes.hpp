// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/tasks/engine.hpp>

#include <string>

/// Whether a command is one process of several that share its work, as `mpirun` starts them.
namespace tactus::cli {

/// The engine on which commands of this process run tasks; null: threads of this process.
tasks::Engine* engine_of_commands();
/// To be called before a command runs.
void set_engine_of_commands(tasks::Engine* engine);

/// Whether this process prints and writes results. Any other one only runs tasks for the process that does.
bool presents_results();

/// Refuses a command line that several processes were started for and whose command cannot share its work, and, in a
/// program without MPI, any command that several processes were started for to share its work.
Check refuse_processes(int argc, const char* const* argv);

/// Refuses several processes for work of a command that has no tasks; `what` names it, as in "a map of two arms".
Check refuse_to_share(const std::string& what);

}  // namespace tactus::cli
