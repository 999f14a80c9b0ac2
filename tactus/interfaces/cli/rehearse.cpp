// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/internal/touch_options.hpp>
#include <tactus/interfaces/cli/line_writer.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/interfaces/cli/rig_run.hpp>
#include <tactus/interfaces/cli/servo_options.hpp>
#include <tactus/interfaces/cli/supervised_run.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

namespace tactus::cli {

/// examples/rigs/joints.toml and axes.toml as they were when this was built.
extern const std::string_view default_joints, default_axes;

namespace {

struct RehearseOptions {
  std::string rig;
  ExperimentOptions experiment;
  OutputOptions output;
  std::uint64_t log_limit = 0;
  runtime::ServoThreadParams servo;
  SupervisedOptions supervised;
  Rehearsal rehearsal;
  std::vector<double> led;
  TouchOptions touch;
  ObserverOptions observers;
};

/// Only arms are led, tap and meet a surface: each joint of another rig turns freely.
Check refuse_without_arms(const RehearseOptions& options, const configuration::Document& document) {
  const auto kind = document.text_at("task.kind");
  if (kind && *kind == "arm-tapping") return std::nullopt;
  for (const auto& [given, option] :
       {std::pair{!options.led.empty(), "--led"}, std::pair{!options.touch.tapped.empty(), "--tapped"},
        std::pair{options.touch.wall_m.has_value(), "--wall"}}) {
    if (!given) continue;
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message =
                     "only arms are led, tap or meet a surface, those of an experiment of the kind arm-tapping: leave "
                     "it out, or name "
                     "such an experiment after RIG",
                 .place = option};
  }
  return std::nullopt;
}

/// Where none is named: each joint driven by itself, in the units of the rig.
Result<configuration::Document> experiment_of(RehearseOptions& options) {
  if (!options.experiment.file.empty()) return load_experiment(options.experiment);
  constexpr std::string_view ending = ".toml";
  const auto rig = devices::Rig::load(options.rig.substr(0, options.rig.rfind(ending) + ending.size()));
  if (!rig) return rig.error();
  const auto sides = rig->sides();
  if (!sides) return sides.error();
  const bool slides = sides->front()->joints.front().slides;
  options.experiment.file = slides ? "axes.toml" : "joints.toml";
  return with_changes(configuration::Document::parse(slides ? default_axes : default_joints, options.experiment.file),
                      options.experiment);
}

Check rehearse(RehearseOptions& options, const CLI::App& verb, const std::string& command) {
  if (Check wrong = refuse_link_without_site(verb, options.supervised)) return wrong;
  if (!names_a_rig(options.rig)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = "'" + report::printable(options.rig) +
                            "' is no rig file, whose name ends in .toml: name one, such as examples/rigs/openarm.toml",
                 .place = "RIG"};
  }
  auto document = experiment_of(options);
  if (!document) return document.error();
  const experiments::Request request{.document = *std::move(document),
                                     .variations = {},
                                     .name = experiment_name(options.experiment.file),
                                     .command = command};
  if (Check wrong = refuse_without_arms(options, request.document)) return wrong;
  if (Check wrong = options.touch.check()) return wrong;
  options.rehearsal.tapping = options.touch.tapping();
  options.rehearsal.surface = options.touch.surface();
  if (!options.led.empty()) {
    constexpr double farthest_rad = 3.0;
    if (options.led[0] > farthest_rad) {
      return Error{.code = ErrorCode::out_of_bounds,
                   .parameter = {},
                   .message = rounded_number(options.led[0]) + " rad is more than an arm can be led, " +
                              rounded_number(farthest_rad) + " rad: name less",
                   .place = "--led"};
    }
    options.rehearsal.led_reach_rad = options.led[0];
    options.rehearsal.led_after_s = options.led[1];
  }
  auto output = OutputFolder::open(options.output);
  if (!output) return output.error();
  options.supervised.devices = {options.rig};
  options.supervised.rehearsal = options.rehearsal;
  return run_supervised(options.supervised, options.observers, options.servo, request, *output, options.log_limit);
}

}  // namespace

void add_rehearse(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<RehearseOptions>();
  CLI::App* verb = app.add_subcommand("rehearse", "Run a rig file with emulated motors in place of yours");
  verb->add_option("RIG", options->rig, "Rig file, or one of its pairs; no port in it is opened")
      ->type_name("RIG.toml[:PAIR]")
      ->required();
  verb->add_option(
      "EXPERIMENT", options->experiment.file,
      "Experiment file (TOML) of the kind tapping or arm-tapping; by default examples/rigs/joints.toml, or "
      "axes.toml for axes that slide");
  add_with_option(*verb, options->experiment.with);
  add_set_option(*verb, options->experiment.set);
  verb->add_option("--fault", options->rehearsal.faults,
                   "Fault to inject, as SIDE:FAULT with a fault of `tactus emulate`, such as follower:silence:2@5; may "
                   "be repeated")
      ->type_name("SIDE:FAULT")
      ->allow_extra_args(false);
  constexpr double latest_s = 1000.0;
  verb->add_option("--led", options->led,
                   "Motion of a simulated hand that holds an emulated leader arm: it moves each joint back and forth "
                   "by REACH, in rad, and starts SECONDS after gravity compensation is on; 0.3,10 by default")
      ->type_name("REACH,SECONDS")
      ->delimiter(',')
      ->expected(2)
      ->check(real_between(0.0, latest_s));
  const TouchOptionsOf touch = add_touch_options(
      *verb, options->touch, "Horizontal surface for the tool of an emulated follower arm, GAP metres below it",
      "Tapping instead of the motion of --led: the simulated hand moves the leader's tool down by DEPTH, in m, and up "
      "again, once every PERIOD s, starting SECONDS after gravity compensation is on");
  touch.tapped->excludes("--led");
  add_output_options(*verb, options->output, command, "Folder for report.html, results.json, the figures and the log");
  add_log_limit_option(*verb, options->log_limit);
  add_servo_options(*verb, options->servo);
  add_site_options(*verb, options->supervised);
  add_observer_options(*verb, options->observers);
  verb->callback([options, verb, &app, &command, &status] {
    const Check error = rehearse(*options, *verb, command);
    if (!error) return;
    status = exit_status(*error);
    static_cast<void>(LineWriter(STDERR_FILENO).finish(app.get_name() + ": " + describe(*error) + "\n"));
  });
}

}  // namespace tactus::cli
