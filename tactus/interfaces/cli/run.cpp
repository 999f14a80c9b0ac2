// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/line_writer.hpp>
#include <tactus/interfaces/cli/observers.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/processes.hpp>
#include <tactus/interfaces/cli/progress_line.hpp>
#include <tactus/interfaces/cli/ros2_session.hpp>
#include <tactus/interfaces/cli/run_log.hpp>
#include <tactus/interfaces/cli/servo_options.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/interfaces/cli/supervised_run.hpp>
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/real_time/real_time_arm_tap.hpp>
#include <tactus/simulation/real_time/real_time_tapping.hpp>
#include <tactus/simulation/tasks/work.hpp>

#include <array>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <unistd.h>

namespace tactus::cli {

namespace {

constexpr const char* recording_file = "recording.csv";

struct RunOptions {
  ExperimentOptions experiment;
  std::vector<std::string> vary;
  OutputOptions output;
  std::uint64_t log_limit = 0;
  bool real_time = false;
  std::optional<std::string> plant;
  double plant_silence_s = station::usual_silence.value;
  runtime::ServoThreadParams servo;
  SupervisedOptions supervised;
  ObserverOptions observers;
};

Result<experiments::Request> make_request(const RunOptions& options, const std::string& command) {
  auto document = load_experiment(options.experiment);
  if (!document) return document.error();
  std::vector<experiments::Variation> variations;
  for (const std::string& text : options.vary) {
    auto variation = experiments::parse_variation(text);
    if (!variation) return variation.error();
    if (auto error = refuse_set_and_varied(options.experiment.set, variation->key)) return *std::move(error);
    variations.push_back(*std::move(variation));
  }
  return experiments::Request{.document = *std::move(document),
                              .variations = std::move(variations),
                              .name = experiment_name(options.experiment.file),
                              .command = command};
}

/// `status` is what an interruption makes the exit status.
Check run_in_real_time(const RunOptions& options, const experiments::Request& request, OutputFolder& output,
                       int& status) {
  runtime::EndRequest end;
  const auto interruption = Interruption::start(end);
  if (!interruption) return interruption.error();
  real_time::RealTimeOptions settings{
      .servo = options.servo, .log = {}, .log_limit_bytes = options.log_limit, .about = log_origin(), .end = &end};
  if (options.plant) {
    settings.plant = real_time::PlantChoice{.name = *options.plant, .silence = Seconds{options.plant_silence_s}};
  }
  if (output.wanted()) {
    settings.log = output.log_folder() / "log.mcap";
    settings.before_log = [&output] { return output.begin(); };
  }
  const auto say = [&output](const std::string& line) {
    if (!line.empty()) (output.json() ? std::cerr : std::cout) << line << std::flush;
  };
  std::optional<Observers> observers;
  const auto open_observers = [&](const std::vector<std::string>& joints) -> Check {
    auto opened = Observers::open(options.observers, request, {}, joints);
    if (!opened) return opened.error();
    observers.emplace(*std::move(opened));
    return std::nullopt;
  };
  if (options.observers.any()) {
    settings.look_on = [&](const std::vector<runtime::RealTimeStreams>& all) -> Check {
      if (auto error = open_observers({})) return error;
      for (const runtime::RealTimeStreams& streams : all) observers->watch(streams);
      return observers->begin(say);
    };
    settings.look_on_arms = [&](const real_time::ArmTapStreams& streams,
                                const std::vector<std::string>& joints) -> Check {
      if (auto error = open_observers(joints)) return error;
      observers->watch(streams);
      return observers->begin(say);
    };
  }
  const auto done = [&] {
    ProgressLine line(request.name);
    return real_time::run_in_real_time(request, settings, [&line](double share) { line.update(share); });
  }();
  if (observers) say(observers->end());
  if (!done) return done.error();
  if (done->interrupted) status = (*interruption)->exit_status();
  if (auto error = write_outcome(output, done->outcome)) return error;
  if (output.wanted() && !done->log) output.announce_log();
  return done->log;
}

Error refuse_ros2(std::string message) {
  return {.code = ErrorCode::inconsistent, .parameter = {}, .message = std::move(message), .place = "--ros2"};
}

Check run_among_ros2_nodes(const RunOptions& options, const experiments::Request& request, std::string_view kind,
                           OutputFolder& output) {
  if (kind != "tapping") {
    return refuse_ros2("an experiment of kind " + std::string(kind) +
                       " cannot be run in real time: choose one of kind tapping");
  }
  if (!request.variations.empty()) {
    return refuse_ros2("there is one teleoperator at a time: write --set in place of --vary");
  }
  runtime::EndRequest end;
  const auto interruption = Interruption::start(end);
  if (!interruption) return interruption.error();
  const Ros2Options session{.name_space = options.observers.name_space,
                            .live = options.observers.live,
                            .servo = options.servo,
                            .end = end,
                            .log_limit_bytes = options.log_limit};
  const auto outcome = run_ros2_session(request, session, output);
  if (!outcome) return outcome.error();
  if (auto error = write_outcome(output, *outcome)) return error;
  if (output.wanted()) output.announce_log();
  return std::nullopt;
}

/// What cannot go together, with the reason and what to write in its place.
Check refuse_what_makes_no_sense(const CLI::App& verb, const RunOptions& options) {
  const bool one_site = !options.supervised.site.empty();
  const bool own_devices = !options.supervised.devices.empty();
  const bool at_real_clock = options.real_time || options.observers.ros2 || one_site;
  struct Rule {
    bool broken;
    std::vector<const char*> options;  ///< of which the first that was given is named
    const char* why;
  };
  const std::array rules{
      Rule{options.plant && one_site,
           {"--plant"},
           "a plant has both devices, for one process that drives both: leave out --plant, and name the device of this "
           "site with --device, or leave out --site"},
      Rule{options.plant && own_devices,
           {"--plant"},
           "a plant has the devices of both sites: leave out --plant or --device"},
      Rule{options.plant && !options.real_time, {"--plant"}, "a plant runs at the real clock: add --realtime"},
      Rule{own_devices && !options.real_time && !one_site,
           {"--device"},
           "a device runs at the real clock: add --realtime for both sites in this program, or --site for one of two"},
      Rule{options.supervised.wanted() && !options.vary.empty(),
           {"--vary"},
           "sites that an operator arms run one combination: write --set in place of --vary"},
      Rule{!options.supervised.wanted(),
           {"--arm", "--duration-s"},
           "the taps of an experiment are armed by nobody and end by themselves: add --realtime --device or --site"},
      Rule{!at_real_clock,
           {"--live"},
           "virtual time is over before anybody looks: add --realtime or --site, or be the operator yourself on the "
           "page of `tactus serve`"},
      Rule{!at_real_clock,
           {"--priority", "--core", "--spin-s"},
           "there is no servo thread in virtual time: add --realtime, --ros2 or --site"}};
  for (const Rule& rule : rules) {
    if (!rule.broken) continue;
    for (const char* name : rule.options) {
      if (verb.count(name) == 0) continue;
      return Error{.code = ErrorCode::inconsistent, .parameter = {}, .message = rule.why, .place = name};
    }
  }
  return refuse_link_without_site(verb, options.supervised);
}

Check run(const RunOptions& options, const std::string& command, int& status) {
  auto request = make_request(options, command);
  if (!request) return request.error();
  auto output = OutputFolder::open(presents_results() ? options.output : OutputOptions{});
  if (!output) return output.error();
  if (options.supervised.wanted() || options.real_time || options.observers.ros2) {
    if (auto error = refuse_to_share("a run in real time")) return error;
  }
  if (options.supervised.wanted()) {
    return run_supervised(options.supervised, options.observers, options.servo, *request, *output, options.log_limit);
  }
  const auto experiment = experiments::choose_experiment(request->document);
  if (!experiment) {
    Error error = experiment.error();
    if (const auto kind = request->document.text_at("task.kind"); kind && *kind == "stability-map") {
      error.message = "a stability map is not run by `run`: use `tactus stability map " + options.experiment.file +
                      " --vary KEY=FROM:TO:COUNT --vary ...`";
    }
    return error;
  }

  if (options.real_time) return run_in_real_time(options, *request, *output, status);
  if (options.observers.ros2) return run_among_ros2_nodes(options, *request, (*experiment)->kind(), *output);

  if ((*experiment)->has_tasks()) {
    // A program that ends a command of its own finds nothing of it left.
    const std::filesystem::path folder = is_in_process() ? "" : output->path();
    request->place = {.engine = engine_of_commands(), .folder = folder};
  } else if (auto error = refuse_to_share("an experiment of kind " + std::string((*experiment)->kind()))) {
    return error;
  }
  Result<experiments::Outcome> outcome = [&] {
    ProgressLine line(request->name);
    return (*experiment)->run(*request, [&line](double done) { line.update(done); });
  }();
  if (!outcome) return outcome.error();
  if (!presents_results()) return std::nullopt;

  std::vector<NamedText> files;
  if (!outcome->recording.empty()) files.push_back({recording_file, outcome->recording});
  if (auto error = write_outcome(*output, *outcome, files)) return error;
  if (output->wanted()) tasks::remove_finished_tasks(output->path());
  if (!output->wanted() || outcome->traces.empty()) return std::nullopt;
  if (auto error = write_run_log(output->log_folder(), *request, *outcome, options.log_limit)) return error;
  output->announce_log();
  return std::nullopt;
}

}  // namespace

void add_run(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* verb = app.add_subcommand("run", "Run an experiment, in virtual or in real time");
  add_experiment_options(*verb, options->experiment);
  verb->add_option("--vary", options->vary, "Run every value of a key, in all combinations; may be repeated")
      ->type_name("KEY=A,B,C")
      ->allow_extra_args(false);
  add_output_options(*verb, options->output, command, "Folder for report.html, results.json, the figures and the log");
  options->output.own_files = {recording_file};
  add_log_limit_option(*verb, options->log_limit);
  verb->add_flag("--realtime", options->real_time,
                 "Run taps of one axis or of two arms in real time on a servo thread, with simulated devices, "
                 "the devices of a plant, or your own");
  CLI::Option* plant =
      verb->add_option("--plant", options->plant, "Drive the devices of the `tactus plant` with this name")
          ->type_name("NAME");
  verb->add_option("--plant-silence-s", options->plant_silence_s,
                   "Timeout of that plant, after which both sites release their force, 0.001 to 10")
      ->type_name("S")
      ->needs(plant);
  add_servo_options(*verb, options->servo);
  add_supervised_options(*verb, options->supervised);
  add_observer_options(*verb, options->observers);
  verb->callback([options, verb, &app, &command, &status] {
    Check error = refuse_what_makes_no_sense(*verb, *options);
    if (!error) error = run(*options, command, status);
    if (!error) return;
    if (options->supervised.wanted() && !is_in_process()) {
      // Who drove devices ends, whether or not anybody reads why.
      status = exit_status(*error);
      static_cast<void>(LineWriter(STDERR_FILENO).finish(app.get_name() + ": " + describe(*error) + "\n"));
    } else {
      status = report_error(app.get_name(), *error);
    }
  });
}

}  // namespace tactus::cli
