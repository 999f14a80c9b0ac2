// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/line_writer.hpp>
#include <tactus/interfaces/cli/operator_input.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/rehearsal.hpp>
#include <tactus/interfaces/cli/rig_drive.hpp>
#include <tactus/interfaces/cli/rig_figures.hpp>
#include <tactus/interfaces/cli/rig_report.hpp>
#include <tactus/interfaces/cli/rig_run.hpp>
#include <tactus/interfaces/cli/rig_sides.hpp>
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
using devices::Rig;
using devices::RigLoop;
using devices::RigPair;
using devices::RigSide;
using devices::RigSiteLoop;

constexpr std::string_view suffix = ".toml";

Error refused(const char* option, std::string message) {
  return {.code = ErrorCode::inconsistent, .parameter = {}, .message = std::move(message), .place = option};
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
  const std::vector<runtime::StreamedJoint>& for_log;
  std::span<std::optional<DrivenSide>> driven;
};

void add_link(RigRun&, const RigLoop&) {}
void add_link(RigRun& run, const RigSiteLoop& loop) { run.link = loop.link_totals(); }

/// Steps the loop until it is over, and leaves what there is to tell.
template <class Loop>
Check run_rig_loop(Loop loop, const RigSurroundings& around) {
  OutputFolder& folder = around.folder;
  const RigPair& pair = around.drive.pair;
  LineWriter& lines = folder.json() ? around.errors : around.output;
  runtime::JointStreams streams(around.for_log, around.only);
  if (folder.wanted() || around.observers.any()) loop.leave_in(streams);
  std::optional<runtime::SiteLog> log;
  if (folder.wanted()) {
    if (Check error = folder.begin()) return error;
    const auto about = about_rig(around.drive, around.request.name, around.for_log, around.only);
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
  const SayLine say = [&around](const std::string& line) { around.errors.say(line); };
  while (!(*thread)->ended()) {
    take_seconds();
    for (auto& side : around.driven) {
      if (side && side->guard) side->guard->look();
      if (side) report_problem(*side, say);
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
  const auto [file, name] = parts_of_rig(options.devices.front());
  const auto rig = Rig::load(file);
  if (!rig) return rig.error();
  const auto named = pair_of_rig(*rig, name, only);
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
  const std::vector<runtime::StreamedJoint> for_log = streamed_joints(*sides.front());
  std::vector<std::string> names;
  for (const auto& joint : for_log) names.push_back(joint.name);

  runtime::SiteExchange exchange;
  const auto interruption = Interruption::start(exchange.end, Interrupted::site);
  if (!interruption) return interruption.error();
  LineWriter errors(STDERR_FILENO), output(STDOUT_FILENO);
  const SayLine say = [&errors](const std::string& line) { errors.say(line); };
  exchange.allow(found->settable);
  auto observers = Observers::open(observer_options, request, only, names, &exchange);
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
  const std::string friction = found->arms ? unstated_friction(*found->arms) : "";
  if (!friction.empty()) say(friction);
  if (Check unclean = refuse_unclean(*rig, sides, say)) return unclean;
  // The devices give up their motors before the links do, and these before the guards.
  std::array<std::optional<DrivenSide>, 2> driven;
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
  Check powered = switch_off(driven, sides, say);
  if (!powered) return wrong;
  // What matters now comes last.
  if (wrong) errors.say("tactus: " + describe(*wrong) + "\n");
  return powered;
}

}  // namespace tactus::cli
