// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/hardware/devices/motor_link.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/interfaces/cli/rig_drive.hpp>
#include <tactus/interfaces/cli/rig_guard.hpp>
#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/servo/joint_streams.hpp>
#include <tactus/runtime/servo/site_log.hpp>

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// The sides of a rig's pair on their way to a servo thread and back: which pair is meant, what is wrong with its
/// motors, the links that drive them. Nothing here is real-time safe.
namespace tactus::cli {

/// Takes a line for the user, with its end of line.
using SayLine = std::function<void(const std::string& line)>;

/// `FILE.toml` or `FILE.toml:PAIR` as the file and the pair that is meant; empty where the file has only one.
std::pair<std::string, std::string> parts_of_rig(const std::string& device);

/// The role of the site that drives a side.
constexpr control::SiteRole driving(bool leads) { return leads ? control::SiteRole::master : control::SiteRole::slave; }

/// The pair of this name, or the only one, with the side that is driven, both where `only` is empty. Errors:
/// `inconsistent` for a pair that the rig does not have and a follower that gives no force; `missing` for a side.
Result<const devices::RigPair*> pair_of_rig(const devices::Rig& rig, const std::string& name,
                                            std::optional<control::SiteRole> only);

/// Asks all motors, without power. Everything that is wrong with them is reported to `say`, a line each. Errors:
/// `failed` where anything was.
Check refuse_unclean(const devices::Rig& rig, const std::vector<const devices::RigSide*>& sides, const SayLine& say);

/// A side that is driven. The guard ends after the port is closed.
struct DrivenSide {
  std::string side;
  bool problem_reported = false;  ///< the one that its link has
  std::optional<RigGuard> guard;
  std::unique_ptr<devices::MotorLink> link;
  std::unique_ptr<devices::MotorBusDevice> device;
};

/// Opens the bus of a side and asks its motors; motors without a watchdog of their own get a guard process first,
/// unless they are emulated, so that they end with this program.
Result<DrivenSide> drive(const devices::Rig& rig, const devices::RigSide& side, bool emulated);

/// Reports once why a link ended, or why it cannot drive its motors at present.
void report_problem(DrivenSide& driven, const SayLine& say);

/// Takes the power from all motors and ends their links. Errors: `failed` where a motor did not report in time that it
/// is off; each of these is reported to `say`.
Check switch_off(std::array<std::optional<DrivenSide>, 2>& driven, const std::vector<const devices::RigSide*>& sides,
                 const SayLine& say);

/// The joints of a side, as their records call them.
std::vector<runtime::StreamedJoint> streamed_joints(const devices::RigSide& side);

/// What the log of a pair, or of the side of it that is driven here, states of itself.
runtime::LogMetadata about_rig(const RigDrive& drive, const std::string& experiment,
                               const std::vector<runtime::StreamedJoint>& joints,
                               std::optional<control::SiteRole> only);

}  // namespace tactus::cli
