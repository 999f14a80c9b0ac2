// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/hardware/devices/rig/examination.hpp>
#include <tactus/interfaces/cli/guarded_link.hpp>
#include <tactus/interfaces/cli/rig_sides.hpp>
#include <tactus/interfaces/cli/run_log.hpp>

#include <algorithm>
#include <utility>

namespace tactus::cli {

using control::SiteRole;
using devices::MotorBusDevice;
using devices::Rig;
using devices::RigPair;
using devices::RigSide;

namespace {

Error refuse_option(const char* option, std::string message) {
  return {.code = ErrorCode::inconsistent, .parameter = {}, .message = std::move(message), .place = option};
}

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

}  // namespace

std::pair<std::string, std::string> parts_of_rig(const std::string& device) {
  if (device.ends_with(".toml")) return {device, {}};
  const auto colon = device.rfind(':');
  return {device.substr(0, colon), device.substr(colon + 1)};
}

Result<const RigPair*> pair_of_rig(const Rig& rig, const std::string& name, std::optional<SiteRole> only) {
  const auto& pairs = rig.pairs();
  if (name.empty() && pairs.size() > 1) {
    return refuse_option("--device", "the rig has two pairs: name one, as " + report::printable(rig.name()) + ":" +
                                         report::printable(pairs[0].name));
  }
  const auto found = name.empty() ? pairs.begin() : std::ranges::find(pairs, name, &RigPair::name);
  if (found == pairs.end()) {
    return refuse_option("--device",
                         "'" + report::printable(name) + "' is no pair of " + report::printable(rig.name()));
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

Check refuse_unclean(const Rig& rig, const std::vector<const RigSide*>& sides, const SayLine& say) {
  bool clean = true;
  for (const auto* side : sides) {
    const auto found = examine(rig, *side);
    clean = clean && found.well();
    const auto report = [&say](const std::vector<Error>& problems) {
      for (const Error& problem : problems) say("tactus: " + describe(problem) + "\n");
    };
    report(found.problems);
    for (const auto& motor : found.motors) report(motor.problems);
  }
  if (clean) return std::nullopt;
  return Error{.code = ErrorCode::failed,
               .parameter = {},
               .message = "it is not clean, so nothing was driven: fix what 'tactus device check' reports",
               .place = rig.name()};
}

Result<DrivenSide> drive(const Rig& rig, const RigSide& side, bool emulated) {
  DrivenSide driven{.side = side.path, .guard = {}, .link = {}, .device = {}};
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

void report_problem(DrivenSide& driven, const SayLine& say) {
  const Check problem = driven.link->problem();
  if (std::exchange(driven.problem_reported, problem.has_value()) || !problem) return;
  say("tactus: " + driven.side + ": " + describe(*problem) + "\n");
}

Check switch_off(std::array<std::optional<DrivenSide>, 2>& driven, const std::vector<const RigSide*>& sides,
                 const SayLine& say) {
  bool all_off = true;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (!driven[i]) continue;
    const RigSide& side = *sides[i];
    driven[i]->device.reset();
    driven[i]->link->stop();
    report_problem(*driven[i], say);
    for (const devices::PoweredMotor& one : driven[i]->link->powered_motors()) {
      all_off = false;
      say("tactus: " + describe_powered(side, one) + "\n");
    }
  }
  if (all_off) return std::nullopt;
  return Error{.code = ErrorCode::failed,
               .parameter = {},
               .message = "a motor did not report that it is off: switch off its supply",
               .place = {}};
}

std::vector<runtime::StreamedJoint> streamed_joints(const RigSide& side) {
  std::vector<runtime::StreamedJoint> joints;
  for (const devices::RigJoint& joint : side.joints) {
    joints.push_back({.name = std::string(joint.name()), .turns = !joint.slides});
  }
  return joints;
}

runtime::LogMetadata about_rig(const RigDrive& drive, const std::string& experiment,
                               const std::vector<runtime::StreamedJoint>& joints, std::optional<SiteRole> only) {
  runtime::LogMetadata about = drive.about;
  about["tactus"].merge(log_origin());
  about["tactus"]["experiment"] = experiment;
  about["tactus"]["configuration"] = drive.configuration;
  about["tactus"]["rig"] = drive.pair.name;
  if (only) about["tactus"]["site"] = name_of(*only);
  std::string names;
  for (const auto& joint : joints) names += (names.empty() ? "" : ",") + joint.name;
  about["tactus"]["joints"] = names;
  return about;
}

}  // namespace tactus::cli
