// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/kernel/control/estimators/slave_force.hpp>
#include <tactus/kernel/control/own_params.hpp>
#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/control/supervision.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <concepts>
#include <memory>
#include <span>
#include <string>
#include <string_view>

/// Architectures: how two sites share the work of making an operator feel what the slave touches.
namespace tactus::control {

/// The section `[control]` of a file: which architecture, what all of them have in common, and a group for each one
/// that brings keys of its own.
struct ControlParams : PositionForceMaster::Params {
  std::string architecture = "position-force";
  ServoPd::Params slave;
  SlaveForce::Params slave_force;
  SafetyGate::Params gate;
  ForceGate::Params handle_gate;
  SafetyGate::Params slave_gate;
  OwnParams groups;
  SupervisionParams supervision;
  static constexpr auto fields() {
    return joined(
        List{field("architecture", &ControlParams::architecture,
                   "Architecture of the two sites. The page of the architecture lists the keys below that it uses.")},
        PositionForceMaster::Params::fields(),
        List{field("slave", &ControlParams::slave, "The slave's position controller."),
             field("slave_force", &ControlParams::slave_force, "Source of the slave's tip force."),
             field("gate", &ControlParams::gate, "The safety gate of the master's motor."),
             field("handle_gate", &ControlParams::handle_gate,
                   "The safety gate of the actuator on the master's handle."),
             field("slave_gate", &ControlParams::slave_gate, "The safety gate of the slave's motor."),
             field("", &ControlParams::groups, "The groups of the architectures."),
             field("supervision", &ControlParams::supervision,
                   "States, watchdogs and checks of received packets, for supervised sites: `tactus faults` and "
                   "`tactus run --site`.")});
  }

  /// The parameters that an architecture has of its own, by their type: its defaults where nobody has set them.
  template <Described T>
  [[nodiscard]] const T& own() const {
    return groups.of<T>();
  }
  template <Described T>
  [[nodiscard]] T& own() {
    return groups.of<T>();
  }
};

/// The parameters of several joints. What takes them alongside those of one axis is a template, so that `{}` stays one
/// axis.
template <class T>
concept JointParams = std::same_as<T, Joints<ControlParams>>;

/// The controllers of both sites, before their safety gates.
struct Controllers {
  std::unique_ptr<MasterController> master;
  std::unique_ptr<SlaveController> slave;
};

/// How far the loop of an architecture is that of position-force, the one that margins and maps are made of.
enum class Likeness {
  unknown,     ///< not at all, or not declared: refused there by name
  about_rest,  ///< for motions and forces that are small enough: margins are its own, maps are refused
  equal,       ///< everywhere
};

/// An architecture by its name in a file. `make` fails where its parameters do not fit together; the parameters that
/// its errors name are those of `ControlParams`.
struct Architecture {
  std::string_view name;
  std::string_view summary;
  Result<Controllers> (*make)(const ControlParams& params, Seconds dt);
  /// The keys that it alone has; `make` finds them as `params.own<T>()`.
  OwnKeys keys = {};
  /// Whether anything listens to the slave's tip force, so that it makes a difference where it comes from.
  bool uses_tip_force = true;
  Likeness like_position_force = Likeness::unknown;
};

/// Every architecture there is, those of this library first.
std::span<const Architecture> architectures();

/// The one of this name, or null.
const Architecture* find_architecture(std::string_view name);

/// Adds an architecture. Call it before experiments are read, from one thread; its texts must outlive the program's use
/// of it. A second one of the same name takes the place of the first, and of its group.
///
/// Errors: `inconsistent` for a group whose name is a key of `[control]` already. Two architectures may share a group:
/// the same name with the same type.
[[nodiscard]] Check register_architecture(const Architecture& architecture);

/// Both sites, gates included.
template <class Master, class Slave>
struct SitesOf {
  Master master;
  Slave slave;
};
using Sites = SitesOf<MasterSite, SlaveSite>;
using JointSites = SitesOf<JointMasterSite, JointSlaveSite>;

/// Makes the sites that `params` describe. Errors: an unknown architecture, naming the nearest; what its `make`
/// refuses; an estimator of the slave's force that cannot be, or that the architecture has no use for; a gate's
/// parameters.
Result<Sites> make_sites(const ControlParams& params, Seconds dt);
/// The same for devices of several joints, each of which is controlled by itself, as `params` of that joint describe.
/// What couples joints is a controller of all of them: make a `JointMasterSite` around yours. Errors are under the
/// joint, as `joint_2`.
Result<JointSites> make_sites(const JointParams auto& params, Seconds dt);

}  // namespace tactus::control
