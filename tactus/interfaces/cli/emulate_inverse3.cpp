// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/emulate.hpp>
#include <tactus/interfaces/cli/real_between.hpp>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

using emulation::inverse3::Dialect;
using emulation::inverse3::Inverse3Service;

struct Inverse3Options {
  Inverse3Service::Params service;
  std::string dialect = name_of(Dialect::v3_5);
  bool uncalibrated = false;
  double late_s = 0.0;
  std::string mode;  ///< empty: its own
  std::uint16_t port = 10001;
};

}  // namespace

std::function<Result<emulation::inverse3::Inverse3Server>()> add_inverse3_options(CLI::App& verb) {
  auto options = std::make_shared<Inverse3Options>();
  verb.add_option("--devices", options->service.devices, "How many")->check(CLI::Range(1, 4));
  verb.add_option("--dialect", options->dialect, "Version of the protocol")->check(CLI::IsMember(words_of<Dialect>()));
  verb.add_option("--port", options->port, "Port to listen on; 0: any free port");
  verb.add_flag("--uncalibrated", options->uncalibrated,
                "Report that the device is not calibrated, and output no force");
  verb.add_flag("--partial", options->service.partial, "Leave out the parts of a state that equal the identity");
  verb.add_option("--late-s", options->late_s, "Delay of each reply")->check(real_between(0.0, 10.0));
  verb.add_option("--garbage", options->service.garbage, "Share of replies that are cut off")
      ->check(real_between(0.0, 1.0));
  verb.add_option("--closes-after", options->service.closes_after,
                  "Close the connection in place of this reply; 0: never");
  verb.add_flag("--keeps-force", options->service.keeps_force, "Keep the force after a message without a command");
  verb.add_option("--mode", options->mode, "Mode that each state reports, in place of the actual one")
      ->type_name("WORD");
  verb.add_option("--seed", options->service.seed, "Seed of the cut replies");
  return [options] {
    Inverse3Service::Params params = options->service;
    params.dialect = value_of<Dialect>(options->dialect);
    params.calibrated = !options->uncalibrated;
    if (!options->mode.empty()) params.mode = options->mode;
    params.late_ns = static_cast<std::int64_t>(options->late_s * 1e9);
    return emulation::inverse3::Inverse3Server::start(params, options->port);
  };
}

}  // namespace tactus::cli
