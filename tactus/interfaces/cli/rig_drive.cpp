// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/hardware/devices/rig/rig_arms.hpp>
#include <tactus/interfaces/cli/rig_drive.hpp>
#include <tactus/interfaces/cli/settable.hpp>
#include <tactus/kernel/station/supervised_arms.hpp>
#include <tactus/kernel/station/watched_arm.hpp>
#include <tactus/runtime/servo/site_parts.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <filesystem>

namespace tactus::cli {

using control::SiteRole;
using devices::Rig;
using devices::RigLoop;
using devices::RigPair;
using devices::RigSide;

namespace {

Joints<station::DeviceLimits> limits_of(const RigSide& side) {
  Joints<station::DeviceLimits> limits(side.joints.size());
  for (std::size_t i = 0; i < limits.size(); ++i) limits[i] = side.joints[i].joint.limits();
  return limits;
}

/// Leaves the limits of the devices that are driven for a log.
void tell_devices(RigDrive& drive, std::optional<SiteRole> only) {
  for (const auto& [role, name] : enumerators(SiteRole{})) {
    if (only && *only != role) continue;
    drive.about[std::string("device_of_").append(name)] = runtime::in_words(limits_of(side_of(drive.pair, role)));
  }
}
/// The same of what a site that is alone has in common with the other.
void tell_agreement(RigDrive& drive) {
  drive.about["tactus"]["agreement"] = runtime::text_of(drive.agreement->agreement());
}

}  // namespace

const RigSide& side_of(const RigPair& pair, SiteRole role) {
  return role == SiteRole::master ? *pair.leader : *pair.follower;
}

std::string unstated_friction(const station::DescribedArms& arms) {
  const auto line_of = [](const station::DescribedArm& one) {
    std::string joints;
    for (std::size_t i = 0; i < one.joints.size(); ++i) {
      if (one.arm.chain.joints[i].friction.coulomb_N_m > 0.0) continue;
      joints += (joints.empty() ? "" : ", ") + one.joints[i];
    }
    if (joints.empty()) return joints;
    return "tactus: " + one.urdf + " states no friction for " + joints +
           ": 0 is assumed, so neither feed-forward nor the observer's dead band accounts for it; write <dynamics "
           "friction=\"...\"/> in N m, or identify it with 'tactus identify arm'\n";
  };
  const std::string leader = line_of(arms.leader), follower = line_of(arms.follower);
  return leader == follower ? leader : leader + follower;
}

Result<RigDrive> joint_by_joint(const experiments::Request& request, const RigPair& pair, RigLoop::Params settings,
                                std::optional<SiteRole> only) {
  const auto params = request.document.read<experiments::TappingParams>();
  if (!params) return params.error();
  const RigSide& side = side_of(pair, only.value_or(SiteRole::master));
  const Joints<control::ControlParams> joints(side.joints.size(), experiments::sites_of(*params).control);
  const Seconds tick{1.0 / params->servo.rate_Hz};
  const control::SupervisionParams& supervision = joints[0].supervision;
  settings.listen_before_arming_s = supervision.watchdog.timeout_s;
  RigDrive drive(pair, params->servo.rate_Hz, configuration::to_toml(*params));
  tell_devices(drive, only);
  if (only != SiteRole::slave) {
    const auto sites = control::make_sites(joints, tick);
    if (!sites) return request.document.locate(under("control", sites.error()));
    const auto settable = settable_of(sites->master.force_gain(), supervision.force_gain, tick, false);
    if (!settable) return request.document.locate(under("control.supervision.force_gain", settable.error()));
    drive.settable = *settable;
  }
  if (!only) {
    drive.loop = [joints, settings, tick, channel = params->channel](auto& exchange, auto& leader, auto& follower) {
      return RigLoop::make(joints, channel, tick, settings, exchange, leader, follower);
    };
    return drive;
  }
  if (!devices::tells_its_place(joints, tick)) {
    return request.document.locate(
        {.code = ErrorCode::inconsistent,
         .parameter = "control.architecture",
         .message = "a follower of " + joints[0].architecture +
                    " does not send its position, so its leader on another host cannot see how far it is: write "
                    "position-position or four-channel, or drive both in one program",
         .place = {}});
  }
  drive.agreement = devices::RigAgreement::of(side, joints[0], tick);
  tell_agreement(drive);
  const bool leads = *only == SiteRole::master;
  drive.settings = {.pair = settings,
                    .scales = Joints<double>(joints.size(), leads ? joints[0].position_scale : 1.0),
                    .longest_age_s = supervision.packets.longest_age_s,
                    .timeout_s = supervision.watchdog.timeout_s};
  drive.control = joints;
  drive.site = [params = experiments::sites_of(*params), limits = limits_of(side), role = *only,
                agreement = drive.agreement->agreement()](std::int64_t session) {
    return runtime::make_supervised_site(params, role, limits, session, agreement);
  };
  return drive;
}

Result<RigDrive> as_two_arms(const experiments::Request& request, const Rig& rig, const RigPair& pair,
                             RigLoop::Params settings, std::optional<SiteRole> only) {
  const auto params = request.document.read<experiments::ArmTappingParams>();
  if (!params) return params.error();
  if (Check wrong = station::refuse_tool_coupling(*params, "a rig of two arms")) {
    return request.document.locate(*std::move(wrong));
  }
  const std::filesystem::path folder = std::filesystem::path(request.document.name()).parent_path();
  const auto setup = experiments::set_up_arm_pair(*params, folder);
  if (!setup) return request.document.locate(setup.error());
  auto arms = devices::as_arms(pair, *params, *setup);
  if (!arms) return rig.locate(arms.error());
  const control::SupervisionParams& supervision = params->rig.supervision;
  settings.listen_before_arming_s = supervision.watchdog.timeout_s;
  RigDrive drive(*std::move(arms), params->servo.rate_Hz, configuration::to_toml(*params));
  drive.arms = *setup;
  tell_devices(drive, only);
  drive.about["urdf"] = runtime::urdfs_of(*setup);
  const auto leader_motors = station::motor_watch(*params, setup->leader),
             follower_motors = station::motor_watch(*params, setup->follower);
  if (!leader_motors) return request.document.locate(leader_motors.error());
  if (!follower_motors) return request.document.locate(follower_motors.error());
  const bool watches = leader_motors->judges();
  const Seconds tick{1.0 / params->servo.rate_Hz};
  drive.settable.tares = true;
  if (only != SiteRole::slave) {
    const auto leader = station::arm_leader_site(*params, *setup, limits_of(*drive.pair.leader), {});
    if (!leader) return request.document.locate(leader.error());
    const auto settable = settable_of(leader->site().force_gain(), supervision.force_gain, tick, true);
    if (!settable) return request.document.locate(under("rig.supervision.force_gain", settable.error()));
    drive.settable = *settable;
  }
  if (!only) {
    auto sites = station::arm_sites(*params, *setup, limits_of(*drive.pair.leader), limits_of(*drive.pair.follower));
    if (!sites) return request.document.locate(sites.error());
    std::optional<RigLoop::Watches> motors;
    if (watches) motors = {.leader = *leader_motors, .follower = *follower_motors};
    drive.loop = [settings, motors, sites = *std::move(sites), tick](auto& exchange, auto& leader, auto& follower) {
      return RigLoop::around(sites, tick, settings, exchange, leader, follower, motors);
    };
    return drive;
  }
  if (watches) drive.motors = *only == SiteRole::master ? *leader_motors : *follower_motors;
  const RigSide& side = side_of(drive.pair, *only);
  drive.agreement = devices::RigAgreement::of(side, *params, *setup);
  tell_agreement(drive);
  drive.settings = {.pair = settings,
                    .scales = Joints<double>(side.joints.size(), 1.0),
                    .longest_age_s = supervision.packets.longest_age_s,
                    .timeout_s = supervision.watchdog.timeout_s};
  drive.site = [setup = *setup, limits = limits_of(side), role = *only,
                agreement = drive.agreement->agreement()](std::int64_t session) {
    return runtime::make_supervised_site(setup.params, setup, role, limits, session, agreement);
  };
  return drive;
}

}  // namespace tactus::cli
