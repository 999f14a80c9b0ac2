// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/hardware/devices/rig/rig_agreement.hpp>
#include <tactus/hardware/devices/rig/rig_loop.hpp>
#include <tactus/hardware/devices/rig/rig_site_loop.hpp>
#include <tactus/kernel/core/joints.hpp>
#include <tactus/kernel/station/described_arms.hpp>
#include <tactus/runtime/servo/site_command.hpp>
#include <tactus/runtime/servo/site_log.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>

namespace tactus::cli {

/// The pair as the experiment drives it.
struct RigDrive {
  RigDrive(devices::RigPair pair_, double rate, std::string configuration_)
      : pair(std::move(pair_)), rate_Hz(rate), configuration(std::move(configuration_)) {}

  devices::RigPair pair;
  double rate_Hz;
  std::string configuration;
  std::optional<station::DescribedArms> arms;  ///< where the sites are those of arms
  runtime::LogMetadata about;                  ///< what else a log needs, so that it can be replayed
  runtime::Settable settable;                  ///< while it runs
  /// What a servo thread steps where both sides are here, before devices that outlive it. Errors are those of the
  /// experiment's file.
  std::function<Result<devices::RigLoop>(runtime::SiteExchange&, devices::MotorBusDevice& leader,
                                         devices::MotorBusDevice& follower)>
      loop;

  // Where only one is:
  std::optional<devices::RigAgreement> agreement;
  std::function<Result<devices::JointSite>(std::int64_t session)> site;  ///< errors as those of `loop`
  devices::RigSiteLoop::Params settings;
  std::optional<Joints<control::ControlParams>> control;  ///< of joints that are driven each by itself
  std::optional<arm_control::MotorWatch> motors;          ///< of an arm that is to be watched
};

/// The side that the site of this role drives.
const devices::RigSide& side_of(const devices::RigPair& pair, control::SiteRole role);

/// A message about joints for which a URDF states no friction (`<dynamics friction>`): a line for each URDF with such
/// joints, else empty.
std::string unstated_friction(const station::DescribedArms& arms);

/// Of an experiment of one axis, whose sites drive each joint by itself; `only` where the other side runs elsewhere.
/// Errors are located in the experiment's file.
Result<RigDrive> joint_by_joint(const experiments::Request& request, const devices::RigPair& pair,
                                devices::RigLoop::Params settings, std::optional<control::SiteRole> only);

/// Of an experiment of two arms, each with all its joints. The same; errors of the rig are located in its file.
Result<RigDrive> as_two_arms(const experiments::Request& request, const devices::Rig& rig, const devices::RigPair& pair,
                             devices::RigLoop::Params settings, std::optional<control::SiteRole> only);

}  // namespace tactus::cli
