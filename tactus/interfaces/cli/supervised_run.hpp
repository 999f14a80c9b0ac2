// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/cli/observers.hpp>
#include <tactus/interfaces/cli/output_folder.hpp>
#include <tactus/interfaces/cli/rehearsal.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/servo_thread.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// Only declared: headers are installed, and a user of the package need not have CLI11.
namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// What `tactus run EXPERIMENT` was asked for where a user arms it: `--site`, or `--realtime --device`.
struct SupervisedOptions {
  std::string site;  ///< master or slave; empty where both sites run in this program
  std::string peer;
  std::optional<std::string> listen;
  std::optional<std::string> key;
  bool unencrypted = false;
  bool arm = false;
  double duration_s = 0.0;
  /// `NAME` in the registry, or `master=NAME` and `slave=NAME`; a site without one has the device that the experiment
  /// describes.
  std::vector<std::string> devices;
  std::optional<Rehearsal> rehearsal = {};  ///< emulated motors in place of those of the rig

  [[nodiscard]] bool wanted() const { return !site.empty() || !devices.empty(); }
};

/// Adds these options to the command.
void add_supervised_options(CLI::App& verb, SupervisedOptions& options);
/// The same without `--device`.
void add_site_options(CLI::App& verb, SupervisedOptions& options);
/// `inconsistent` for an option of the link where both sites run in this program.
Check refuse_link_without_site(const CLI::App& verb, const SupervisedOptions& options);

/// Runs one site of the request's experiment, or both, in real time until it ends or is interrupted: a line a second,
/// then tables. In the folder of `output`, if there is one, it leaves a report, and every tick in its log. With JSON
/// the lines go to standard error and one document to standard output. What a user asks for is read from standard
/// input, a `SiteWord` a line; SIGUSR1 arms. Of `servo`, the rate is the experiment's.
Check run_supervised(const SupervisedOptions& options, const ObserverOptions& observers,
                     runtime::ServoThreadParams servo, const experiments::Request& request, OutputFolder& output,
                     std::uint64_t log_limit_bytes);

}  // namespace tactus::cli
