// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/line_writer.hpp>
#include <tactus/interfaces/cli/operator_input.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/interfaces/cli/rig_run.hpp>
#include <tactus/interfaces/cli/run_log.hpp>
#include <tactus/interfaces/cli/settable.hpp>
#include <tactus/interfaces/cli/supervised_report.hpp>
#include <tactus/interfaces/cli/supervised_run.hpp>
#include <tactus/kernel/station/device_registry.hpp>
#include <tactus/runtime/servo/local_loop.hpp>
#include <tactus/runtime/servo/site_loop.hpp>
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/real_time/repeated_taps.hpp>

#include <algorithm>
#include <filesystem>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <unistd.h>

namespace tactus::cli {

namespace {

using control::SiteRole;
using experiments::TappingParams;
using runtime::SiteDevice;

Error refused(ErrorCode code, const char* option, std::string message) {
  return Error{.code = code, .parameter = {}, .message = std::move(message), .place = option};
}

std::optional<SiteRole> role_of(const std::string& word) {
  for (const auto& [role, name] : enumerators(SiteRole{})) {
    if (word == name) return role;
  }
  return std::nullopt;
}

/// `PORT` or `HOST:PORT`; without it the peer's port on every own address.
Result<link::Address> listening_address(const std::optional<std::string>& listen, const link::Address& peer) {
  if (!listen) return peer.any_host();
  if (listen->find(':') != std::string::npos) return link::Address::parse(*listen);
  auto port = link::Address::parse((peer.is_ipv6() ? "[::1]:" : "127.0.0.1:") + *listen);
  if (!port) return port.error();
  return port->any_host();
}

Result<link::EndpointSettings> link_settings(const SupervisedOptions& options, SiteRole role) {
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
  return link::EndpointSettings{.site = role, .peer = *peer, .listen = *listen, .key = key};
}

/// The name of the kind that each `--device` asks for, by role; empty for the device of the experiment.
using DeviceNames = std::array<std::string, 2>;

Result<DeviceNames> device_names(const SupervisedOptions& options, const SitesHere& here) {
  DeviceNames names;
  for (const std::string& asked : options.devices) {
    const std::size_t equals = asked.find('=');
    const auto role = equals == std::string::npos ? std::nullopt : role_of(asked.substr(0, equals));
    if (equals != std::string::npos && !role) {
      return refused(ErrorCode::syntax, "--device",
                     "'" + report::printable(asked) + "' names no site: write NAME, master=NAME or slave=NAME");
    }
    if (role && !here.has(*role)) {
      return refused(ErrorCode::inconsistent, "--device",
                     std::string("the ") + name_of(*role) + " is elsewhere: name its device there");
    }
    for (const auto& [each, unused] : enumerators(SiteRole{})) {
      std::string& name = names[static_cast<std::size_t>(each)];
      if (role ? each != *role : !here.has(each)) continue;
      if (!name.empty()) {
        return refused(ErrorCode::inconsistent, "--device",
                       std::string("the ") + name_of(each) + " has one device: leave out '" + name + "' or '" +
                           report::printable(asked) + "'");
      }
      name = role ? asked.substr(equals + 1) : asked;
    }
  }
  return names;
}

/// The devices of the sites that run here, by role.
using Devices = std::array<SiteDevice, 2>;

Result<Devices> open_devices(const DeviceNames& names, const SitesHere& here, const TappingParams& params) {
  Devices devices;
  for (const auto& [role, unused] : enumerators(SiteRole{})) {
    if (!here.has(role)) continue;
    const std::string& name = names[static_cast<std::size_t>(role)];
    SiteDevice& device = devices[static_cast<std::size_t>(role)];
    if (name.empty()) {
      auto simulated = real_time::simulated_device(params, role);
      if (!simulated) return simulated.error();
      device = *std::move(simulated);
    } else {
      auto opened = station::open_device(name, role, Seconds{1.0 / params.servo.rate_Hz});
      if (!opened) return opened.error();
      device.device = *std::move(opened);
    }
  }
  return devices;
}

/// What a log says of the run: enough to step its sites again.
runtime::LogMetadata about_run(const experiments::Request& request, const std::string& configuration,
                               const SitesHere& here, const Devices& devices) {
  runtime::LogMetadata about{{"tactus", log_origin()}};
  auto& run = about["tactus"];
  run["experiment"] = request.name;
  run["configuration"] = configuration;
  run["clock"] = "real";
  if (here.one) run["site"] = name_of(*here.one);
  for (const auto& [role, name] : enumerators(SiteRole{})) {
    if (!here.has(role)) continue;
    about[std::string("device_of_") + name] =
        runtime::in_words(devices[static_cast<std::size_t>(role)].device->limits());
  }
  return about;
}

void add_totals(SupervisedRun& run, const runtime::SiteLoop& loop) {
  run.sites.push_back({*run.here.one, loop.totals()});
  run.link = loop.link_totals();
}
void add_totals(SupervisedRun& run, const runtime::LocalLoop& loop) {
  for (const auto& [role, name] : enumerators(SiteRole{})) run.sites.push_back({role, loop.totals(role)});
}

/// What is there before the loop, and outlives it.
struct Surroundings {
  const experiments::Request& request;
  OutputFolder& folder;
  std::uint64_t log_limit_bytes;
  std::string configuration;
  runtime::LogMetadata about;
  runtime::ServoThreadParams servo;
  runtime::SiteExchange& exchange;
  const Interruption& interruption;
  Observers& observers;
  LineWriter& output;
  LineWriter& errors;
};

template <class Loop>
Check run_loop(Loop loop, SupervisedRun run, const Surroundings& around) {
  OutputFolder& folder = around.folder;
  LineWriter& lines = folder.json() ? around.errors : around.output;
  std::optional<runtime::SiteLog> log;
  runtime::SiteStreams streams;
  if (folder.wanted() || around.observers.any()) {
    streams = run.here.one ? runtime::SiteStreams::of_one(*run.here.one) : runtime::SiteStreams::of_both();
    loop.leave_in(streams);
    around.observers.watch(streams);
  }
  if (auto error = around.observers.begin([&lines](const std::string& line) { lines.say(line); })) return error;
  if (folder.wanted()) {
    if (auto error = folder.begin()) return error;
    auto created = runtime::SiteLog::create(folder.log_folder(), streams, around.about, around.log_limit_bytes);
    if (!created) return created.error();
    log.emplace(*std::move(created));
  }
  auto servo = runtime::ServoThread<Loop>::start(around.servo, std::move(loop));
  if (!servo) return servo.error();
  lines.say(second_head(run.here));
  const auto take_seconds = [&] {
    runtime::SiteSecond second;
    while (around.exchange.seconds.try_pop(second)) {
      lines.say(second_line(run.here, second));
      run.seconds.push_back(second);
    }
    runtime::SiteMismatch mismatch;
    while (around.exchange.mismatches.try_pop(mismatch)) {
      around.errors.say("tactus: " + describe(mismatch, *run.here.one) + "\n");
    }
  };
  while (!(*servo)->ended()) {
    take_seconds();
    usleep(20'000);
  }
  run.servo = (*servo)->finish();
  (*servo)->step().finish();
  take_seconds();
  if (const std::string seen = around.observers.end(); !seen.empty()) lines.say(seen);
  add_totals(run, (*servo)->step());
  run.ended_by = around.interruption.signal() != 0 ? around.interruption.name() : "its duration";
  run.lines_dropped = lines.dropped();
  Check log_error;
  if (log) {
    log_error = log->close();
    run.log_dropped = log->dropped();
  }
  Check unwritten = leave_outcome(supervised_outcome(run, around.request, around.configuration), folder,
                                  std::move(log_error), log ? log->removed() : 0, around.output, around.errors);
  const std::string fault = fault_of(run);
  return fault.empty() ? unwritten : ended_in_a_fault(fault, std::move(unwritten), around.errors);
}

}  // namespace

constexpr const char* supervised_group = "With supervision, in real time";

void add_supervised_options(CLI::App& verb, SupervisedOptions& options) {
  verb.add_option("--device", options.devices,
                  "Rig file, or one of its pairs (RIG.toml:PAIR). The command drives its leader and follower, or only "
                  "one of them with --site. Instead of a rig file, NAME is a device that the program provides, for "
                  "both sites or for one (SITE=NAME)")
      ->type_name("[SITE=]NAME|RIG.toml[:PAIR]")
      ->group(supervised_group)
      ->allow_extra_args(false);
  add_site_options(verb, options);
}

void add_site_options(CLI::App& verb, SupervisedOptions& options) {
  const auto add = [&verb](const char* name, auto& value, const char* help, const char* type) {
    return verb.add_option(name, value, help)->type_name(type)->group(supervised_group);
  };
  add("--site", options.site, "Run only this site; the other one runs elsewhere", "SITE")
      ->check(CLI::IsMember({"master", "slave"}));
  add("--peer", options.peer, "Address on which the other site listens", "HOST:PORT");
  add("--listen", options.listen, "Address to listen on; by default the peer's port on every address of this host",
      "[HOST:]PORT");
  add("--key", options.key, "Key that both sites share, created by `tactus key`", "FILE");
  verb.add_flag("--unencrypted", options.unencrypted, "Send plain text, on the loopback of this host only")
      ->group(supervised_group);
  verb.add_flag("--arm", options.arm,
                "Master only: arm automatically once, as soon as packets from the slave have arrived for as long as "
                "the watchdog's timeout")
      ->group(supervised_group);
  add("--duration-s", options.duration_s, "Time to run; 0: until interrupted", "S")->check(real_between(0.0, 1e6));
}

Check refuse_link_without_site(const CLI::App& verb, const SupervisedOptions& options) {
  if (!options.site.empty()) return std::nullopt;
  for (const char* name : {"--peer", "--listen", "--key", "--unencrypted"}) {
    if (verb.count(name) == 0) continue;
    return refused(ErrorCode::inconsistent, name,
                   "there is no link where both sites run in one program: add --site master or --site slave");
  }
  return std::nullopt;
}

Check run_supervised(const SupervisedOptions& options, const ObserverOptions& observer_options,
                     runtime::ServoThreadParams servo, const experiments::Request& request, OutputFolder& folder,
                     std::uint64_t log_limit_bytes) {
  const configuration::Document& document = request.document;
  const auto experiment = experiments::choose_experiment(document);
  if (!experiment) return experiment.error();
  const SitesHere here{.one = role_of(options.site)};
  const bool rig = std::ranges::any_of(options.devices, names_a_rig);
  if (const auto kind = (*experiment)->kind(); rig ? !drives_a_rig(kind) : kind != "tapping") {
    std::string why = "only an experiment of the kind tapping runs as two sites";
    if (rig) {
      why = "only an experiment of the kind tapping or arm-tapping drives a rig";
    } else if (drives_a_rig(kind) && !here.one) {
      why = "arms are those of a rig file, whose name ends in .toml";
    }
    return refused(ErrorCode::inconsistent, here.one ? "--site" : "--device", std::move(why));
  }
  std::optional<link::EndpointSettings> link;
  if (here.one) {
    auto stated = link_settings(options, *here.one);
    if (!stated) return stated.error();
    link = *std::move(stated);
  }
  if (rig) return run_rig(options, observer_options, servo, request, folder, log_limit_bytes, link);
  const auto params = document.read<TappingParams>();
  if (!params) return params.error();
  const auto names = device_names(options, here);
  if (!names) return names.error();

  runtime::SiteExchange exchange;
  if (here.one.value_or(SiteRole::master) == SiteRole::master) {
    const Seconds tick{1.0 / params->servo.rate_Hz};
    const auto& control = experiments::sites_of(*params).control;
    const auto sites = control::make_sites(control, tick);
    if (!sites) return document.locate(under("control", sites.error()));
    const auto settable = settable_of(sites->master.force_gain(), control.supervision.force_gain, tick, false);
    if (!settable) return document.locate(under("control.supervision.force_gain", settable.error()));
    exchange.allow(*settable);
  }
  // Before all other threads: what they hold back, only these two hear.
  const auto interruption = Interruption::start(exchange.end, Interrupted::site);
  if (!interruption) return interruption.error();
  LineWriter errors(STDERR_FILENO), output(STDOUT_FILENO);
  const auto person = OperatorInput::listen_to(STDIN_FILENO, here.one.value_or(SiteRole::master), exchange, errors);
  if (!person) return person.error();
  auto observers = Observers::open(observer_options, request, here.one, {}, &exchange);
  if (!observers) return observers.error();
  auto devices = open_devices(*names, here, *params);
  if (!devices) return document.locate(devices.error());
  servo.rate_Hz = params->servo.rate_Hz;
  const std::string configuration = configuration::to_toml(*params);
  const Surroundings around{.request = request,
                            .folder = folder,
                            .log_limit_bytes = log_limit_bytes,
                            .configuration = configuration,
                            .about = about_run(request, configuration, here, *devices),
                            .servo = servo,
                            .exchange = exchange,
                            .interruption = **interruption,
                            .observers = *observers,
                            .output = output,
                            .errors = errors};
  SupervisedRun run;
  run.here = here;
  auto& [master, slave] = *devices;
  if (!here.one) {
    auto loop = runtime::LocalLoop::make(experiments::sites_of(*params),
                                         {.duration_s = options.duration_s, .arm_at_once = options.arm}, exchange,
                                         std::move(master), std::move(slave));
    return loop ? run_loop(*std::move(loop), run, around) : document.locate(loop.error());
  }
  auto loop = runtime::SiteLoop::make(experiments::sites_of(*params),
                                      {.link = *link, .duration_s = options.duration_s, .arm_at_once = options.arm},
                                      exchange, std::move(*here.one == SiteRole::master ? master : slave));
  return loop ? run_loop(*std::move(loop), run, around) : document.locate(loop.error());
}

}  // namespace tactus::cli
