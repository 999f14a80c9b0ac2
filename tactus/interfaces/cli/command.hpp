// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace tactus::tasks {
class Engine;
}

namespace tactus::cli {

/// The whole `tactus` command, for a program that adds something to it: register architectures of your own, then return
/// from `main` what this returns. `argc` and `argv` are those of `main`. In messages and reports the command calls
/// itself by the file name in `argv[0]`. `engine` runs the tasks of commands that have any, and must outlive the call;
/// null: threads of this process. In a process that does not lead, the command runs tasks and leaves no results.
///
/// Returns the exit status: 0 done, 1 the job failed, 2 the request was wrong; why is on standard error. To be
/// called once: it prints to standard output and makes the process ignore SIGPIPE, so that the work is done, and the
/// status that of the work, where a reader goes away.
int run_command(int argc, char** argv, tasks::Engine* engine = nullptr);

}  // namespace tactus::cli
