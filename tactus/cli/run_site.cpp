#include <tactus/cli/interruption.hpp>
#include <tactus/cli/line_writer.hpp>
#include <tactus/cli/outcome_files.hpp>
#include <tactus/cli/person.hpp>
#include <tactus/cli/run_site.hpp>
#include <tactus/cli/site_loop.hpp>
#include <tactus/cli/site_report.hpp>
#include <tactus/configuration/document.hpp>
#include <tactus/experiments/experiment.hpp>
#include <tactus/report/text.hpp>
#include <tactus/station/device_registry.hpp>

#include <filesystem>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <unistd.h>

namespace tactus::cli {

namespace {

Error refused(ErrorCode code, const char* option, std::string message) {
  return Error{.code = code, .parameter = {}, .message = std::move(message), .place = option};
}

control::SiteRole role_of(const SiteOptions& options) {
  return options.site == "master" ? control::SiteRole::master : control::SiteRole::slave;
}

/// `PORT` or `HOST:PORT`; without it the peer's port on every own address.
Result<link::Address> listening_address(const std::optional<std::string>& listen, const link::Address& peer) {
  if (!listen) return peer.any_host();
  if (listen->find(':') != std::string::npos) return link::Address::parse(*listen);
  auto port = link::Address::parse((peer.is_ipv6() ? "[::1]:" : "127.0.0.1:") + *listen);
  if (!port) return port.error();
  return port->any_host();
}

Result<link::Endpoint::Settings> link_settings(const SiteOptions& options) {
  if (options.peer.empty()) return refused(ErrorCode::missing, "--peer", "name the other site: HOST:PORT");
  const auto peer = link::Address::parse(options.peer);
  if (!peer) return peer.error();
  const auto listen = listening_address(options.listen, *peer);
  if (!listen) return listen.error();
  std::optional<link::Key> key;
  if (options.unencrypted && options.key) {
    return refused(ErrorCode::inconsistent, "--unencrypted", "a key encrypts: leave out one of the two");
  }
  if (options.key) {
    const auto read = link::read_key_file(*options.key);
    if (!read) return read.error();
    key = *read;
  } else if (!options.unencrypted) {
    return refused(ErrorCode::missing, "--key",
                   "the link is encrypted: make a key with `tactus key FILE` and give it to both sites; on one host, "
                   "--unencrypted does without");
  }
  return link::Endpoint::Settings{.site = role_of(options), .peer = *peer, .listen = *listen, .key = key};
}

Result<SiteDevice> device_of(const SiteOptions& options, const experiments::TappingParams& params) {
  if (options.device.empty()) return simulated_device(params, role_of(options));
  auto device = station::open_device(options.device, role_of(options), Seconds{1.0 / params.servo.rate_Hz});
  if (!device) return device.error();
  return SiteDevice{.device = *std::move(device)};
}

/// Files first: a terminal that nobody reads keeps nothing from them, and with them what it misses is no loss.
Check leave_outcome(const experiments::Outcome& outcome, OutputFolder& folder, Check log_error, std::uint64_t removed,
                    LineWriter& output, LineWriter& errors) {
  std::string where;
  if (folder.wanted()) {
    if (auto error = write_results(folder, outcome)) return error;
    where = folder.report_line();
    if (!log_error) where += folder.log_line(removed);
  }
  const Check unread = output.finish(folder.json() ? outcome.json : outcome.text + where);
  if (folder.json()) errors.say(where);
  if (!folder.wanted()) return unread;
  if (unread) errors.say("tactus: " + describe(*unread) + "; the report has all of it\n");
  return log_error;
}

}  // namespace

void add_site_options(CLI::App& verb, SiteOptions& options) {
  constexpr const char* group = "One site, in real time";
  const auto add = [&verb](const char* name, auto& value, const char* help, const char* type) {
    return verb.add_option(name, value, help)->type_name(type)->group(group);
  };
  add("--site", options.site, "Run only this site, the other being elsewhere", "SITE")
      ->check(CLI::IsMember({"master", "slave"}));
  add("--peer", options.peer, "Where the other site listens", "HOST:PORT");
  add("--listen", options.listen, "Where to listen; without it at the peer's port on every own address", "[HOST:]PORT");
  add("--key", options.key, "The key that both sites share, made by `tactus key`", "FILE");
  verb.add_flag("--unencrypted", options.unencrypted, "Plain text, on this host's loopback only")->group(group);
  verb.add_flag("--arm", options.arm, "At the master: arm once, as soon as the slave is heard")->group(group);
  add("--duration-s", options.duration_s, "How long to run; 0 is until interrupted", "S")->capture_default_str();
  add("--device", options.device, "Drive this device, which the program must bring, not the simulated one", "NAME")
      ->needs("--site");
}

Check run_site(const SiteOptions& options, runtime::ServoThreadParams servo_params, const experiments::Request& request,
               OutputFolder& folder, std::uint64_t log_limit_bytes) {
  const configuration::Document& document = request.document;
  const auto experiment = experiments::choose_experiment(document);
  if (!experiment) return experiment.error();
  if ((*experiment)->kind() != "tapping") {
    return refused(ErrorCode::inconsistent, "--site", "only an experiment of the kind tapping runs as two sites");
  }
  const auto params = document.read<experiments::TappingParams>();
  if (!params) return params.error();
  const auto link = link_settings(options);
  if (!link) return link.error();

  SiteRun run;
  run.role = role_of(options);
  SiteExchange exchange;
  // Before all other threads: what they hold back, only these two hear.
  const auto interruption = Interruption::start(exchange.end);
  if (!interruption) return interruption.error();
  LineWriter errors(STDERR_FILENO), output(STDOUT_FILENO);
  LineWriter& lines = folder.json() ? errors : output;
  const auto person = Person::listen_to(STDIN_FILENO, run.role, exchange, errors);
  if (!person) return person.error();
  auto device = device_of(options, *params);
  if (!device) return document.locate(device.error());
  auto loop = SiteLoop::make(*params, {.link = *link, .duration_s = options.duration_s, .arm_at_once = options.arm},
                             exchange, *std::move(device));
  if (!loop) return document.locate(loop.error());
  const std::string configuration = configuration::to_toml(*params);
  std::optional<SiteLog> log;
  if (folder.wanted()) {
    if (auto error = folder.begin()) return error;
    auto created = SiteLog::create(folder.log_folder(), request, configuration, run.role, log_limit_bytes);
    if (!created) return created.error();
    log.emplace(*std::move(created));
    loop->log_to(log->streams());
  }

  servo_params.rate_Hz = params->servo.rate_Hz;
  auto servo = runtime::ServoThread<SiteLoop>::start(servo_params, *std::move(loop));
  if (!servo) return servo.error();
  lines.say(second_head(run.role));
  const auto take_seconds = [&] {
    SiteSecond second;
    while (exchange.seconds.try_pop(second)) {
      lines.say(second_line(second));
      run.seconds.push_back(second);
    }
    SiteMisfit misfit;
    while (exchange.misfits.try_pop(misfit)) errors.say("tactus: " + describe(misfit, run.role) + "\n");
  };
  while (!(*servo)->ended()) {
    take_seconds();
    usleep(20'000);
  }
  run.servo = (*servo)->finish();
  (*servo)->step().finish();
  take_seconds();
  run.totals = (*servo)->step().totals();
  run.ended_by = (*interruption)->signal() != 0 ? (*interruption)->name() : "its duration";
  run.lines_dropped = lines.dropped();
  Check log_error;
  if (log) {
    log_error = log->close();
    run.log_dropped = log->dropped();
  }
  return leave_outcome(site_outcome(run, request, configuration), folder, std::move(log_error),
                       log ? log->removed() : 0, output, errors);
}

}  // namespace tactus::cli
