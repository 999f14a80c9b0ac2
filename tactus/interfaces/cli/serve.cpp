// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/data/telemetry/recorder.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/experiment_options.hpp>
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/interfaces/cli/run_log.hpp>
#include <tactus/interfaces/cli/serve_report.hpp>
#include <tactus/interfaces/live/live_view.hpp>
#include <tactus/interfaces/live/server.hpp>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

namespace tactus::cli {

/// The experiment that is served where none is named: experiments/tapping.toml as it was when this was built.
extern const std::string_view default_experiment;

namespace {

struct ServeOptions {
  std::string experiment;
  std::vector<std::string> set;
  live::ServerOptions server;
  bool allow_tuning = false;
  std::string page;
  OutputOptions output;
  std::uint64_t log_limit = 0;
  double duration_s = 0.0;
};

/// Where an installed tactus, or else one that was built in its source tree, has the page.
std::filesystem::path usual_page() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* folder : {"../share/tactus/page", "../../../web/dist"}) {
    if (fs::exists(program / folder / "index.html", error)) return (program / folder).lexically_normal();
  }
  return {};
}

Result<configuration::Document> experiment_of(const ServeOptions& options) {
  return with_set(options.experiment.empty() ? configuration::Document::parse(default_experiment, "tapping.toml")
                                             : configuration::Document::load(options.experiment),
                  options.set);
}

Check serve(const ServeOptions& options, const std::string& command) {
  auto output = OutputFolder::open(options.output);
  if (!output) return output.error();
  const auto document = experiment_of(options);
  if (!document) return document.error();
  const auto settings = live::Settings::make(*document);
  if (!settings) return document->locate(settings.error());
  const std::string name = options.experiment.empty() ? "tapping" : experiment_name(options.experiment);
  const auto view = live::LiveView::make(*settings, {.allow_tuning = options.allow_tuning, .experiment = name});
  if (!view) return document->locate(view.error());
  const std::string configuration = settings->configuration();

  // Before all other threads.
  runtime::EndRequest end;
  const auto interruption = Interruption::start(end);
  if (!interruption) return interruption.error();

  live::StaticFiles page;
  const std::filesystem::path folder = options.page.empty() ? usual_page() : std::filesystem::path(options.page);
  if (!folder.empty()) {
    auto loaded = live::StaticFiles::load(folder);
    if (!loaded) return loaded.error();
    page = *std::move(loaded);
  }
  const bool has_page = !page.empty();

  std::optional<telemetry::Recorder> log;
  std::filesystem::path log_file;
  if (output->wanted()) {
    log_file = output->log_folder() / "log.mcap";
    if (auto error = output->begin()) return error;
    if (auto error = report::prepare_directory(log_file.parent_path())) return error;
    auto recorder = telemetry::Recorder::create(log_file, options.log_limit);
    if (!recorder) return recorder.error();
    log.emplace(*std::move(recorder));
    auto about = log_origin();
    about["experiment"] = name;
    about["configuration"] = configuration;
    log->add_metadata("tactus", about);
    (*view)->engine().log_to(*log);
    log->start();
  }

  ServeSession session;
  {
    const auto server = live::Server::start(options.server, std::move(page), **view);
    if (!server) return server.error();
    std::cout << server->url() << "\n"
              << "Foxglove and PlotJuggler: ws" << server->url().substr(4) << "\n";
    if (!has_page) std::cout << "No page: it is not built. `make live` builds it, --page names its folder.\n";
    if (!options.allow_tuning) std::cout << "Parameters are read-only; --allow-tuning lets clients change them.\n";
    std::cout << std::flush;

    const auto start = std::chrono::steady_clock::now();
    (*view)->engine().run([&] {
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      return !end.asked() && (options.duration_s == 0.0 || elapsed.count() < options.duration_s);
    });
    session.server = server->counts();
  }
  const live::Engine& engine = (*view)->engine();
  session.duration_s = std::max(engine.newest(0).time_s, engine.newest(1).time_s);
  session.lost_ticks = (*view)->lost_ticks();
  const experiments::Request request{.document = *document, .variations = {}, .name = name, .command = command};
  if (auto error = write_outcome(
          *output, serve_outcome(session, (*view)->history(), settings->descriptions(), request, configuration))) {
    return error;
  }
  if (log) {
    if (auto error = log->stop()) return error;
    std::uint64_t dropped = 0;
    for (const std::uint64_t count : log->dropped()) dropped += count;
    std::cout << "Log: " << log_file.parent_path().string() << ", " << log->log().acknowledged() - log->log().removed()
              << " records, " << dropped << " dropped\n";
    return telemetry::write_bag_metadata(log_file, log->log());
  }
  return std::nullopt;
}

}  // namespace

void add_serve(CLI::App& app, const std::string& command, int& status) {
  auto options = std::make_shared<ServeOptions>();
  CLI::App* verb = app.add_subcommand("serve", "Serve the live page, on which you are the operator in a browser");
  verb->add_option("EXPERIMENT", options->experiment,
                   "Experiment file of the kind tapping or arm-tapping; a built-in one by default");
  add_set_option(*verb, options->set);
  verb->add_option("--port", options->server.port, "Port to listen on; 0: any free port");
  verb->add_option("--listen", options->server.address, "Address of this machine to listen on")->type_name("ADDRESS");
  verb->add_flag("--allow-tuning", options->allow_tuning, "Let clients change parameters, within their bounds");
  verb->add_option("--page", options->page, "Folder of the built page")->type_name("DIR");
  add_output_options(*verb, options->output, command,
                     "Folder for report.html, results.json, the figure and a log of every control cycle");
  verb->remove_option(verb->get_option("--json"));  // what is printed is where to look, not results
  add_log_limit_option(*verb, options->log_limit);
  verb->add_option("--duration-s", options->duration_s, "Time to run; 0: until interrupted")
      ->type_name("S")
      ->check(real_between(0.0, 1e6));
  verb->callback([options, &app, &command, &status] {
    if (const auto error = serve(*options, command)) {
      std::cerr << app.get_name() << ": " << describe(*error) << "\n";
      status = exit_status(*error);
    }
  });
}

}  // namespace tactus::cli
