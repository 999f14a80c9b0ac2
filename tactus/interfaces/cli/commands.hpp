// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

// Only declared: headers are installed, and a user of the package need not have CLI11.
namespace CLI {  // NOLINT: the name is not ours
class App;
}

/// The commands of the `tactus` command. Each adds its subcommand to `app`; when chosen, it does its work and leaves
/// its exit status (0 done, 1 the job failed, 2 the request was wrong) in `status`. Messages begin with the name of
/// `app`.
namespace tactus::cli {

/// `command` is the whole command line as a user would type it again, for the report.
void add_run(CLI::App& app, const std::string& command, int& status);
void add_advise(CLI::App& app, const std::string& command, int& status);
/// Prints what completes all commands that `app` has when it is chosen.
void add_completion(CLI::App& app);
void add_device(CLI::App& app, const std::string& command, int& status);
void add_diagnose(CLI::App& app, const std::string& command, int& status);
void add_doctor(CLI::App& app, const std::string& command, int& status);
void add_emulate(CLI::App& app, int& status);
void add_estimate(CLI::App& app, const std::string& command, int& status);
void add_export(CLI::App& app, const std::string& command, int& status);
void add_faults(CLI::App& app, const std::string& command, int& status);
void add_identify(CLI::App& app, const std::string& command, int& status);
void add_key(CLI::App& app, int& status);
void add_plant(CLI::App& app, const std::string& command, int& status);
void add_rehearse(CLI::App& app, const std::string& command, int& status);
void add_relay(CLI::App& app, const std::string& command, int& status);
void add_replay(CLI::App& app, const std::string& command, int& status);
void add_stability(CLI::App& app, const std::string& command, int& status);
void add_schema(CLI::App& app, int& status);
void add_serve(CLI::App& app, const std::string& command, int& status);

}  // namespace tactus::cli
