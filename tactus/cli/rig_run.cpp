#include <tactus/cli/interruption.hpp>
#include <tactus/cli/line_writer.hpp>
#include <tactus/cli/outcome_files.hpp>
#include <tactus/cli/person.hpp>
#include <tactus/cli/rig_guard.hpp>
#include <tactus/cli/rig_report.hpp>
#include <tactus/cli/rig_run.hpp>
#include <tactus/cli/run_log.hpp>
#include <tactus/configuration/document.hpp>
#include <tactus/configuration/toml_writer.hpp>
#include <tactus/devices/motor_bus_device.hpp>
#include <tactus/devices/rig/examination.hpp>
#include <tactus/devices/rig/rig_arms.hpp>
#include <tactus/devices/rig/rig_loop.hpp>
#include <tactus/experiments/arm_tapping/params.hpp>
#include <tactus/experiments/tapping/tapping.hpp>
#include <tactus/report/text.hpp>
#include <tactus/runtime/site_log.hpp>
#include <tactus/runtime/site_parts.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

namespace tactus::cli {

namespace {

using devices::MotorBusDevice;
using devices::Rig;
using devices::RigLoop;
using devices::RigPair;
using devices::RigSide;

constexpr std::string_view suffix = ".toml";

Error refused(const char* option, std::string message) {
  return {.code = ErrorCode::inconsistent, .parameter = {}, .message = std::move(message), .place = option};
}

/// A file, and the pair of it that is meant; empty where it has only one.
std::pair<std::string, std::string> parts_of(const std::string& device) {
  if (device.ends_with(suffix)) return {device, {}};
  const auto colon = device.rfind(':');
  return {device.substr(0, colon), device.substr(colon + 1)};
}

Result<const RigPair*> pair_of(const Rig& rig, const std::string& name) {
  const auto& pairs = rig.pairs();
  if (name.empty() && pairs.size() > 1) {
    return refused("--device", "the rig has two pairs: name one, as " + report::printable(rig.name()) + ":" +
                                   report::printable(pairs[0].name));
  }
  const auto found = name.empty() ? pairs.begin() : std::ranges::find(pairs, name, &RigPair::name);
  if (found == pairs.end()) {
    return refused("--device", "'" + report::printable(name) + "' is no pair of " + report::printable(rig.name()));
  }
  if (!found->leader || !found->follower) {
    return rig.locate({.code = ErrorCode::missing,
                       .parameter = found->name,
                       .message = "a leader and a follower are driven together: write the other one too",
                       .place = {}});
  }
  for (const devices::RigJoint& joint : found->follower->joints) {
    if (joint.joint.gives_force) continue;
    return rig.locate(
        {.code = ErrorCode::inconsistent,
         .parameter = join(joint.path, "model"),
         .message = "a " + joint.motor.model +
                    " takes no command of force, so it can lead and not follow: swap leader and follower, "
                    "or watch it",
         .place = {}});
  }
  return &*found;
}

/// Everything that is wrong with the two, in lines; nothing gets power.
Check refuse_unclean(const Rig& rig, const RigPair& pair, LineWriter& errors) {
  bool clean = true;
  for (const auto* side : {&*pair.leader, &*pair.follower}) {
    const auto found = examine(rig, *side);
    clean = clean && found.well();
    const auto say = [&errors](const std::vector<Error>& problems) {
      for (const Error& problem : problems) errors.say("tactus: " + describe(problem) + "\n");
    };
    say(found.problems);
    for (const auto& motor : found.motors) say(motor.problems);
  }
  if (clean) return std::nullopt;
  return Error{.code = ErrorCode::failed,
               .parameter = {},
               .message = "it is not clean, so nothing was driven: mend what 'tactus device check' tells",
               .place = rig.name()};
}

/// A side that is driven. The guard is there before the port is open, and goes after it is closed.
struct Driven {
  std::optional<RigGuard> guard;
  std::unique_ptr<devices::MotorLink> link;
  std::unique_ptr<MotorBusDevice> device;
};

Result<Driven> drive(const Rig& rig, const RigSide& side) {
  Driven driven;
  if (!has_watchdog(side.bus.kind)) {
    auto guard = RigGuard::start(rig.name(), side);
    if (!guard) return guard.error();
    driven.guard.emplace(*std::move(guard));
  }
  auto link = start(side.bus);
  if (!link) return rig.locate(side, link.error());
  driven.link = *std::move(link);
  constexpr Seconds longest{10.0};
  if (Check wrong = driven.link->wait_until_asked(longest)) return *std::move(wrong);
  auto device = MotorBusDevice::make(*driven.link, {.joints = side.motor_joints(), .silence_s = side.bus.watchdog_s});
  if (!device) return device.error();
  driven.device = *std::move(device);
  return driven;
}

/// The pair as the experiment drives it.
struct Drive {
  RigPair pair;
  double rate_Hz = 0.0;
  std::string configuration;
  /// What a servo thread steps, before devices that outlive it. Errors are those of the experiment's file.
  std::function<Result<RigLoop>(runtime::SiteExchange&, MotorBusDevice& leader, MotorBusDevice& follower)> loop;
};

/// Each joint by itself.
Result<Drive> joint_by_joint(const experiments::Request& request, const RigPair& pair, RigLoop::Params settings) {
  const auto params = request.document.read<experiments::TappingParams>();
  if (!params) return params.error();
  const Joints<control::ControlParams> joints(pair.leader->joints.size(), runtime::control_of(*params));
  settings.listen_before_arming_s = joints[0].supervision.watchdog.timeout_s;
  return Drive{.pair = pair,
               .rate_Hz = params->servo.rate_Hz,
               .configuration = configuration::to_toml(*params),
               .loop = [joints, settings, params = *params](auto& exchange, auto& leader, auto& follower) {
                 return RigLoop::make(joints, params.channel, Seconds{1.0 / params.servo.rate_Hz}, settings, exchange,
                                      leader, follower);
               }};
}

Joints<station::DeviceLimits> limits_of(const RigSide& side) {
  Joints<station::DeviceLimits> limits(side.joints.size());
  for (std::size_t i = 0; i < limits.size(); ++i) limits[i] = side.joints[i].joint.limits();
  return limits;
}

/// Two arms, each with all its joints.
Result<Drive> as_two_arms(const experiments::Request& request, const Rig& rig, const RigPair& pair,
                          RigLoop::Params settings) {
  const auto params = request.document.read<experiments::ArmTappingParams>();
  if (!params) return params.error();
  const std::filesystem::path folder = std::filesystem::path(request.document.name()).parent_path();
  const auto setup = experiments::set_up_arm_pair(*params, folder);
  if (!setup) return request.document.locate(setup.error());
  auto arms = devices::as_arms(pair, *setup);
  if (!arms) return rig.locate(arms.error());
  auto sites = devices::arm_sites(*setup, limits_of(*arms->leader), limits_of(*arms->follower));
  if (!sites) return request.document.locate(sites.error());
  settings.listen_before_arming_s = params->rig.supervision.watchdog.timeout_s;
  return Drive{.pair = *std::move(arms),
               .rate_Hz = params->servo.rate_Hz,
               .configuration = configuration::to_toml(*params),
               .loop = [settings, sites = *std::move(sites), tick = Seconds{1.0 / params->servo.rate_Hz}](
                           auto& exchange, auto& leader, auto& follower) {
                 return RigLoop::around(sites, tick, settings, exchange, leader, follower);
               }};
}

}  // namespace

bool drives_a_rig(std::string_view kind) { return kind == "tapping" || kind == "arm-tapping"; }

bool names_a_rig(const std::string& device) {
  return device.ends_with(suffix) || device.find(std::string(suffix) + ":") != std::string::npos;
}

Check run_rig(const SupervisedOptions& options, const OnlookerOptions& looking_on, runtime::ServoThreadParams servo,
              const experiments::Request& request, OutputFolder& folder, std::uint64_t log_limit_bytes) {
  if (options.devices.size() > 1) return refused("--device", "a rig has the devices of both sites: name it alone");
  const auto [file, name] = parts_of(options.devices.front());
  const auto rig = Rig::load(file);
  if (!rig) return rig.error();
  const auto named = pair_of(*rig, name);
  if (!named) return named.error();
  const RigLoop::Params settings{.duration_s = options.duration_s, .arm_at_once = options.arm};
  const auto kind = request.document.text_at("task.kind");
  const bool arms = kind && *kind == name_of(experiments::ArmTappingKind::arm_tapping);
  const auto found = arms ? as_two_arms(request, *rig, **named, settings) : joint_by_joint(request, **named, settings);
  if (!found) return found.error();
  const RigPair& pair = found->pair;

  runtime::SiteExchange exchange;
  const auto interruption = Interruption::start(exchange.end);
  if (!interruption) return interruption.error();
  LineWriter errors(STDERR_FILENO), output(STDOUT_FILENO);
  LineWriter& lines = folder.json() ? errors : output;
  std::vector<std::string> names;
  for (const devices::RigJoint& joint : pair.leader->joints) names.emplace_back(joint.name());
  auto onlookers = Onlookers::open(looking_on, request, {}, names);
  if (!onlookers) return onlookers.error();
  if (Check unclean = refuse_unclean(*rig, pair, errors)) return unclean;
  // The devices give up their motors before the links do, and these before the guards.
  std::array<std::optional<Driven>, 2> driven;
  for (std::size_t side = 0; side < driven.size(); ++side) {
    auto made = drive(*rig, side == 0 ? *pair.leader : *pair.follower);
    if (!made) return made.error();
    driven[side].emplace(*std::move(made));
  }
  servo.rate_Hz = found->rate_Hz;
  auto loop = found->loop(exchange, *driven[0]->device, *driven[1]->device);
  if (!loop) return request.document.locate(loop.error());
  const auto person = Person::listen_to(STDIN_FILENO, control::SiteRole::master, exchange, errors);
  if (!person) return person.error();

  runtime::JointStreams streams(names.size());
  if (folder.wanted() || onlookers->any()) loop->leave_in(streams);
  std::optional<runtime::SiteLog> log;
  if (folder.wanted()) {
    if (Check error = folder.begin()) return error;
    runtime::LogMetadata about{{"tactus", log_origin()}};
    about["tactus"]["experiment"] = request.name;
    about["tactus"]["configuration"] = found->configuration;
    about["tactus"]["rig"] = pair.name;
    for (const std::string& joint : names) about["tactus"]["joints"] += (joint == names.front() ? "" : ",") + joint;
    auto created = runtime::SiteLog::create(folder.log_folder(), streams, about, log_limit_bytes);
    if (!created) return created.error();
    log.emplace(*std::move(created));
  }
  onlookers->watch(streams);
  if (Check error = onlookers->begin([&lines](const std::string& line) { lines.say(line); })) return error;
  auto thread = runtime::ServoThread<RigLoop>::start(servo, *std::move(loop));
  if (!thread) return thread.error();
  RigRun run;
  const auto take_seconds = [&] {
    while (const auto second = (*thread)->step().next_second()) {
      lines.say(line_of(*second, pair));
      run.seconds.push_back(*second);
    }
  };
  constexpr unsigned between_looks_us = 20'000;
  while (!(*thread)->ended()) {
    take_seconds();
    usleep(between_looks_us);
  }
  run.servo = (*thread)->finish();
  take_seconds();
  if (const std::string seen = onlookers->end(); !seen.empty()) lines.say(seen);
  run.totals = (*thread)->step().totals();
  run.ended_by = (*interruption)->signal() != 0 ? (*interruption)->name() : "its duration";
  run.lines_dropped = lines.dropped();
  Check log_error;
  if (log) {
    log_error = log->close();
    run.log_dropped = log->dropped();
  }
  return leave_outcome(rig_outcome(run, pair, request, found->configuration), folder, std::move(log_error),
                       log ? log->removed() : 0, output, errors);
}

}  // namespace tactus::cli
