#include <tactus/data/report/text.hpp>
#include <tactus/hardware/devices/rig/examination.hpp>
#include <tactus/interfaces/cli/guarded_link.hpp>
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/line_writer.hpp>
#include <tactus/interfaces/cli/operator_input.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/rehearsal.hpp>
#include <tactus/interfaces/cli/rig_drive.hpp>
#include <tactus/interfaces/cli/rig_figures.hpp>
#include <tactus/interfaces/cli/rig_guard.hpp>
#include <tactus/interfaces/cli/rig_report.hpp>
#include <tactus/interfaces/cli/rig_run.hpp>
#include <tactus/interfaces/cli/run_log.hpp>
#include <tactus/runtime/servo/site_log.hpp>
#include <tactus/simulation/experiments/arm_tapping/params.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <unistd.h>

namespace tactus::cli {

namespace {

using control::SiteRole;
using devices::JointSite;
using devices::MotorBusDevice;
using devices::Rig;
using devices::RigLoop;
using devices::RigPair;
using devices::RigSide;
using devices::RigSiteLoop;

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

/// The role of the site that drives a side.
constexpr SiteRole driving(bool leads) { return leads ? SiteRole::master : SiteRole::slave; }

/// The pair that is meant, with the side that is driven, both where `only` says none.
Result<const RigPair*> pair_of(const Rig& rig, const std::string& name, std::optional<SiteRole> only) {
  const auto& pairs = rig.pairs();
  if (name.empty() && pairs.size() > 1) {
    return refused("--device", "the rig has two pairs: name one, as " + report::printable(rig.name()) + ":" +
                                   report::printable(pairs[0].name));
  }
  const auto found = name.empty() ? pairs.begin() : std::ranges::find(pairs, name, &RigPair::name);
  if (found == pairs.end()) {
    return refused("--device", "'" + report::printable(name) + "' is no pair of " + report::printable(rig.name()));
  }
  if (only && !(*only == SiteRole::master ? found->leader : found->follower)) {
    return rig.locate({.code = ErrorCode::missing,
                       .parameter = found->name,
                       .message = std::string("there is no ") +
                                  (*only == SiteRole::master ? "leader, which the master drives"
                                                             : "follower, which the slave drives") +
                                  ": write it, or name the other site",
                       .place = {}});
  }
  if (!only && (!found->leader || !found->follower)) {
    return rig.locate({.code = ErrorCode::missing,
                       .parameter = found->name,
                       .message = "a leader and a follower are driven together: write the other one too",
                       .place = {}});
  }
  if (!found->follower) return &*found;
  for (const devices::RigJoint& joint : found->follower->joints) {
    if (Check cannot = refuse_undrivable(*found->follower, joint)) return rig.locate(*std::move(cannot));
  }
  return &*found;
}

/// Everything that is wrong with them, in lines; nothing gets power.
Check refuse_unclean(const Rig& rig, const std::vector<const RigSide*>& sides, LineWriter& errors) {
  bool clean = true;
  for (const auto* side : sides) {
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
               .message = "it is not clean, so nothing was driven: fix what 'tactus device check' reports",
               .place = rig.name()};
}

/// A side that is driven. The guard ends after the port is closed.
struct Driven {
  std::string side;
  bool told = false;  ///< why its link ended by itself
  std::optional<RigGuard> guard;
  std::unique_ptr<devices::MotorLink> link;
  std::unique_ptr<MotorBusDevice> device;
};

/// The guard is there before the port is open, and has it before a motor is asked.
Result<std::unique_ptr<devices::MotorLink>> start_guarded(const Rig& rig, const RigSide& side,
                                                          std::optional<RigGuard>& guard) {
  auto started = RigGuard::start(rig.name(), side);
  if (!started) return started.error();
  guard.emplace(*std::move(started));
  auto port = open_port(side.bus);
  if (!port) return port.error();
  if (Check gone = guard->give(*port)) return *std::move(gone);
  auto link = start(side.bus, *std::move(port));
  if (!link) return link.error();
  return std::unique_ptr<devices::MotorLink>(std::make_unique<GuardedLink>(*std::move(link), guard->page()));
}

/// Emulated motors end with this program, and need no guard.
Result<Driven> drive(const Rig& rig, const RigSide& side, bool emulated) {
  Driven driven{.side = side.path, .guard = {}, .link = {}, .device = {}};
  const bool guarded = !emulated && !has_watchdog(side.bus.kind);
  auto link = guarded ? start_guarded(rig, side, driven.guard) : start(side.bus);
  if (!link) return rig.locate(side, link.error());
  driven.link = *std::move(link);
  constexpr Seconds longest{10.0};
  if (Check wrong = driven.link->wait_until_asked(longest)) return *std::move(wrong);
  auto device = MotorBusDevice::make(*driven.link, {.joints = side.motor_joints(), .silence_s = side.bus.watchdog_s});
  if (!device) return device.error();
  driven.device = *std::move(device);
  return driven;
}

/// Reports once why a link has ended.
void tell_why_ended(Driven& driven, LineWriter& errors) {
  if (driven.told || driven.link->running()) return;
  const Check problem = driven.link->problem();
  if (!problem) return;
  driven.told = true;
  errors.say("tactus: " + driven.side + ": " + describe(*problem) + "\n");
}

/// Takes the power from all motors and ends their links. Errors: `failed` where a motor did not report in time that it
/// is off; each of these has its line.
Check switch_off(std::array<std::optional<Driven>, 2>& driven, const std::vector<const RigSide*>& sides,
                 LineWriter& errors) {
  bool all_off = true;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (!driven[i]) continue;
    const RigSide& side = *sides[i];
    driven[i]->device.reset();
    driven[i]->link->stop();
    tell_why_ended(*driven[i], errors);
    for (const devices::PoweredMotor& one : driven[i]->link->powered_motors()) {
      all_off = false;
      errors.say("tactus: " + describe_powered(side, one) + "\n");
    }
  }
  if (all_off) return std::nullopt;
  return Error{.code = ErrorCode::failed,
               .parameter = {},
               .message = "a motor did not report that it is off: switch off its supply",
               .place = {}};
}

/// What is there before the loop, and outlives it.
struct RigSurroundings {
  const experiments::Request& request;
  OutputFolder& folder;
  std::uint64_t log_limit_bytes;
  const RigDrive& drive;
  std::optional<SiteRole> only;
  runtime::ServoThreadParams servo;
  runtime::SiteExchange& exchange;
  const Interruption& interruption;
  Observers& observers;
  LineWriter& output;
  LineWriter& errors;
  const std::vector<std::string>& names;               ///< of the joints
  const std::vector<runtime::StreamedJoint>& for_log;  ///< the same
  std::span<std::optional<Driven>> driven;
};

void add_link(RigRun&, const RigLoop&) {}
void add_link(RigRun& run, const RigSiteLoop& loop) { run.link = loop.link_totals(); }

/// Steps the loop until it is over, and leaves what there is to tell.
template <class Loop>
Check run_rig_loop(Loop loop, const RigSurroundings& around) {
  OutputFolder& folder = around.folder;
  const RigPair& pair = around.drive.pair;
  const std::vector<std::string>& names = around.names;
  LineWriter& lines = folder.json() ? around.errors : around.output;
  runtime::JointStreams streams(around.for_log, around.only);
  if (folder.wanted() || around.observers.any()) loop.leave_in(streams);
  std::optional<runtime::SiteLog> log;
  if (folder.wanted()) {
    if (Check error = folder.begin()) return error;
    runtime::LogMetadata about = around.drive.about;
    about["tactus"].merge(log_origin());
    about["tactus"]["experiment"] = around.request.name;
    about["tactus"]["configuration"] = around.drive.configuration;
    about["tactus"]["rig"] = pair.name;
    if (around.only) about["tactus"]["site"] = name_of(*around.only);
    for (const std::string& joint : names) about["tactus"]["joints"] += (joint == names.front() ? "" : ",") + joint;
    auto created = runtime::SiteLog::create(folder.log_folder(), streams, about, around.log_limit_bytes);
    if (!created) return created.error();
    log.emplace(*std::move(created));
  }
  around.observers.watch(streams);
  if (Check error = around.observers.begin([&lines](const std::string& line) { lines.say(line); })) return error;
  auto thread = runtime::ServoThread<Loop>::start(around.servo, std::move(loop));
  if (!thread) return thread.error();
  RigRun run;
  run.only = around.only;
  const auto take_seconds = [&] {
    while (const auto second = (*thread)->step().next_second()) {
      lines.say(cli::line_of(*second, pair, around.only));
      run.seconds.push_back(*second);
    }
    runtime::SiteMismatch mismatch;
    while (around.exchange.mismatches.try_pop(mismatch)) {
      around.errors.say("tactus: " + around.drive.agreement->describe(mismatch, *around.only) + "\n");
    }
  };
  constexpr unsigned between_looks_us = 20'000;
  while (!(*thread)->ended()) {
    take_seconds();
    for (auto& side : around.driven) {
      if (side && side->guard) side->guard->look();
      if (side) tell_why_ended(*side, around.errors);
    }
    usleep(between_looks_us);
  }
  run.servo = (*thread)->finish();
  // Before anything is written, which may take time: no motor has power any more, and no guard waits for a beat.
  for (auto& side : around.driven) {
    if (side) side->link->stop();
  }
  take_seconds();
  if (const std::string seen = around.observers.end(); !seen.empty()) lines.say(seen);
  run.totals = (*thread)->step().totals();
  run.last = (*thread)->step().last();
  add_link(run, (*thread)->step());
  run.ended_by = around.interruption.signal() != 0 ? around.interruption.name() : "its duration";
  run.lines_dropped = lines.dropped();
  Check log_error;
  if (log) {
    log_error = log->close();
    run.log_dropped = log->dropped();
  }
  const auto joints = log ? joints_figure(folder.log_folder(), pair) : std::nullopt;
  Check unwritten = leave_outcome(rig_outcome(run, pair, around.request, around.drive.configuration, joints), folder,
                                  std::move(log_error), log ? log->removed() : 0, around.output, around.errors);
  const std::string fault = fault_of(run, pair);
  return fault.empty() ? unwritten : ended_in_a_fault(fault, std::move(unwritten), around.errors);
}

}  // namespace

bool drives_a_rig(std::string_view kind) { return kind == "tapping" || kind == "arm-tapping"; }

bool names_a_rig(const std::string& device) {
  return device.ends_with(suffix) || device.find(std::string(suffix) + ":") != std::string::npos;
}

Check run_rig(const SupervisedOptions& options, const ObserverOptions& observer_options,
              runtime::ServoThreadParams servo, const experiments::Request& request, OutputFolder& folder,
              std::uint64_t log_limit_bytes, const std::optional<link::EndpointSettings>& link) {
  if (options.devices.size() > 1) return refused("--device", "a rig has the devices of both sites: name it alone");
  const std::optional<SiteRole> only = link ? std::optional(link->site) : std::nullopt;
  const auto [file, name] = parts_of(options.devices.front());
  const auto rig = Rig::load(file);
  if (!rig) return rig.error();
  const auto named = pair_of(*rig, name, only);
  if (!named) return named.error();
  const RigLoop::Params settings{.duration_s = options.duration_s, .arm_at_once = options.arm};
  const auto kind = request.document.text_at("task.kind");
  const bool arms = kind && *kind == name_of(experiments::ArmTappingKind::arm_tapping);
  auto found =
      arms ? as_two_arms(request, *rig, **named, settings, only) : joint_by_joint(request, **named, settings, only);
  if (!found) return found.error();
  RigPair& pair = found->pair;
  std::vector<const RigSide*> sides;
  for (const bool leads : {true, false}) {
    if (!only || *only == driving(leads)) sides.push_back(&side_of(pair, driving(leads)));
  }
  std::vector<std::string> names;
  std::vector<runtime::StreamedJoint> for_log;
  for (const devices::RigJoint& joint : sides.front()->joints) {
    names.emplace_back(joint.name());
    for_log.push_back({.name = names.back(), .turns = !joint.slides});
  }

  runtime::SiteExchange exchange;
  const auto interruption = Interruption::start(exchange.end, Interrupted::site);
  if (!interruption) return interruption.error();
  LineWriter errors(STDERR_FILENO), output(STDOUT_FILENO);
  auto observers = Observers::open(observer_options, request, only, names);
  if (!observers) return observers.error();
  std::optional<link::JointEndpoint> endpoint;
  std::optional<JointSite> site;
  if (link) {
    auto opened = link::JointEndpoint::make(*link, names.size());
    if (!opened) return opened.error();
    endpoint.emplace(*std::move(opened));
    auto made = found->site(endpoint->session());
    if (!made) return request.document.locate(made.error());
    site.emplace(*std::move(made));
  }
  std::optional<EmulatedRig> emulated;
  if (options.rehearsal) {
    auto started = EmulatedRig::start(*rig, pair, only, found->arms ? &*found->arms : nullptr, *options.rehearsal);
    if (!started) return started.error();
    emulated.emplace(*std::move(started));
    found->about["tactus"]["motors"] = "emulated";
    (folder.json() ? errors : output)
        .say("Rehearsal: all motors are emulated, and no port of the rig file is opened.\n" + emulated->description());
  }
  if (Check unclean = refuse_unclean(*rig, sides, errors)) return unclean;
  // The devices give up their motors before the links do, and these before the guards.
  std::array<std::optional<Driven>, 2> driven;
  for (std::size_t side = 0; side < sides.size(); ++side) {
    auto made = drive(*rig, *sides[side], emulated.has_value());
    if (!made) return made.error();
    driven[side].emplace(*std::move(made));
  }
  servo.rate_Hz = found->rate_Hz;
  const auto person = OperatorInput::listen_to(STDIN_FILENO, only.value_or(SiteRole::master), exchange, errors);
  if (!person) return person.error();
  const RigSurroundings around{.request = request,
                               .folder = folder,
                               .log_limit_bytes = log_limit_bytes,
                               .drive = *found,
                               .only = only,
                               .servo = servo,
                               .exchange = exchange,
                               .interruption = **interruption,
                               .observers = *observers,
                               .output = output,
                               .errors = errors,
                               .names = names,
                               .for_log = for_log,
                               .driven = driven};
  Check wrong;
  if (only) {
    auto loop = RigSiteLoop::make(*std::move(site), *std::move(endpoint), Seconds{1.0 / found->rate_Hz},
                                  found->settings, exchange, *driven[0]->device, found->control, found->motors);
    wrong = loop ? run_rig_loop(*std::move(loop), around) : request.document.locate(loop.error());
  } else {
    auto loop = found->loop(exchange, *driven[0]->device, *driven[1]->device);
    wrong = loop ? run_rig_loop(*std::move(loop), around) : request.document.locate(loop.error());
  }
  Check powered = switch_off(driven, sides, errors);
  if (!powered) return wrong;
  // What matters now comes last.
  if (wrong) errors.say("tactus: " + describe(*wrong) + "\n");
  return powered;
}

}  // namespace tactus::cli
