// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/json_option.hpp>
#include <tactus/interfaces/cli/line_writer.hpp>
#include <tactus/interfaces/cli/servo_options.hpp>
#include <tactus/runtime/servo/servo_presentation.hpp>
#include <tactus/simulation/real_time/plant_server.hpp>

#include <chrono>
#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace tactus::cli {

namespace {

using real_time::PlantStatus;

struct PlantOptions {
  ExperimentOptions experiment;
  std::string name = "plant";
  double duration_s = 0.0;
  double silence_s = station::usual_silence.value;
  JsonOption json;
  runtime::ServoThreadParams servo;
};

std::string line_of(const PlantStatus& now, const PlantStatus& before, std::int64_t second) {
  return std::to_string(second) + " s: " + std::to_string(now.readings - before.readings) + " readings, " +
         std::to_string(now.commands - before.commands) + " commands, " +
         (now.controller ? "driven by process " + std::to_string(*now.controller) : "nobody drives") + ", " +
         std::to_string(now.missed - before.missed) + " control cycles missed" +
         (now.held_back > before.held_back
              ? ", " + std::to_string(now.held_back - before.held_back) + " commands held back to the limits"
              : "") +
         (now.released > before.released ? std::string(", released: ") + station::in_words(now.cause) : "") + "\n";
}

std::string text_of(const std::string& name, const PlantStatus& status, const runtime::ServoReport& servo) {
  report::Table table({{"readings"}, {"commands"}, {"taps"}, {"held back"}, {"released"}, {"control cycles missed"}},
                      "Plant '" + name + "'");
  table.add_row({std::to_string(status.readings), std::to_string(status.commands), std::to_string(status.taps),
                 std::to_string(status.held_back), std::to_string(status.released), std::to_string(status.missed)});
  return table.to_text() + "\n" + runtime::timing_text(servo);
}

std::string json_of(const std::string& name, const PlantStatus& status, const runtime::ServoReport& servo) {
  const nlohmann::ordered_json document{
      {"name", name},
      {"readings", status.readings},
      {"commands", status.commands},
      {"taps", status.taps},
      {"held_back", status.held_back},
      {"released", status.released},
      {"cause", name_of(status.cause)},
      {"missed", status.missed},
      {"servo", report::parse_json<nlohmann::ordered_json>(runtime::servo_json(servo))}};
  return report::json_text(document);
}

Result<experiments::TappingParams> params_of(const PlantOptions& options) {
  const auto document = load_experiment(options.experiment);
  if (!document) return document.error();
  auto params = document->read<experiments::TappingParams>();
  if (!params) return params.error();
  if (auto error = experiments::refuse_supervised(*params, "plant")) return document->locate(*std::move(error));
  if (const auto ensemble = experiments::TappingEnsemble::make(*params); !ensemble) {
    return document->locate(ensemble.error());
  }
  return params;
}

Check check_duration(double duration_s) {
  constexpr Bounds durations = between(0.0, 1e6);
  if (durations.contain(duration_s)) return std::nullopt;
  Error error = out_of_bounds({}, duration_s, durations, units::second);
  error.place = "--duration-s";
  return error;
}

Check own_plant(const PlantOptions& options) {
  if (auto error = check_duration(options.duration_s)) return error;
  const auto params = params_of(options);
  if (!params) return params.error();
  const auto plant = real_time::PlantServer::make(options.name, *params, Seconds{options.silence_s});
  if (!plant) return plant.error();
  real_time::PlantServer& server = **plant;
  runtime::ServoThreadParams keep = options.servo;
  keep.rate_Hz = params->servo.rate_Hz;

  runtime::EndRequest end;
  const auto interruption = Interruption::start(end);
  if (!interruption) return interruption.error();
  LineWriter output(STDOUT_FILENO), errors(STDERR_FILENO);
  const auto step = [&server](const station::Tick& tick) noexcept {
    server.step(tick);
    return true;
  };
  const auto servo = runtime::ServoThread<decltype(step)>::start(keep, step);
  if (!servo) return servo.error();
  LineWriter& lines = options.json.wanted ? errors : output;
  lines.say("Plant '" + options.name + "': tactus run " + report::printable(options.experiment.file) +
            " --realtime --plant " + options.name + "\n");

  using std::chrono::steady_clock;
  const auto start = steady_clock::now();
  PlantStatus before;
  std::int64_t second = 1;
  while (!end.asked()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
    server.serve();
    const std::chrono::duration<double> elapsed = steady_clock::now() - start;
    if (elapsed.count() >= static_cast<double>(second)) {
      const PlantStatus now = server.status();
      lines.say(line_of(now, before, second));
      before = now;
      second = static_cast<std::int64_t>(elapsed.count()) + 1;
    }
    if (options.duration_s > 0.0 && elapsed.count() >= options.duration_s) break;
    if (server.status().cut) break;
  }
  (*servo)->stop();
  const runtime::ServoReport& report = (*servo)->finish();
  Check told = output.finish(options.json.wanted ? options.json.document(json_of(options.name, server.status(), report),
                                                                         configuration::to_toml(*params))
                                                 : "\n" + text_of(options.name, server.status(), report));
  if (told || !server.status().cut) return told;
  return Error{
      .code = ErrorCode::failed,
      .parameter = {},
      .message =
          "plant '" + options.name +
          "': another process has shortened its shared memory; the plant released its force: start it again, and "
          "find out what writes to /dev/shm",
      .place = "--name"};
}

}  // namespace

void add_plant(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<PlantOptions>();
  CLI::App* verb = app.add_subcommand(
      "plant", "Simulate the devices of an experiment for `tactus run --realtime --plant` in another process");
  add_experiment_options(*verb, options->experiment);
  verb->add_option("--name", options->name, "Name that the other process connects to")->type_name("NAME");
  verb->add_option("--duration-s", options->duration_s, "Time to run; 0: until interrupted")->type_name("S");
  verb->add_option("--silence-s", options->silence_s,
                   "Timeout of the other process, after which the motors get no force, 0.001 to 10")
      ->type_name("S");
  add_servo_options(*verb, options->servo);
  add_json_option(*verb, options->json, command, "Print one JSON document; progress goes to standard error");
  verb->callback([options, &app, &status] {
    if (const auto error = own_plant(*options)) {
      std::cerr << app.get_name() << ": " << describe(*error) << "\n";
      status = exit_status(*error);
    }
  });
}

}  // namespace tactus::cli
