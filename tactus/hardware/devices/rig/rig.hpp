// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>
#include <tactus/hardware/devices/motor_joint.hpp>
#include <tactus/hardware/devices/rig/bus_kinds.hpp>
#include <tactus/kernel/core/result.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactus::devices {

/// How the keys and units of a joint are called.
struct JointWords {
  const char *offset, *lower, *upper, *velocity_limit, *force_limit, *rate_limit;
  const char *position_unit, *velocity_unit, *force_unit;
};

/// A joint of a rig and its motor.
struct RigJoint {
  std::string path;     ///< its section: `arm.leader.elbow`
  bool slides = false;  ///< in m and N, itself or at the end of a lever; else it turns, in rad and N m
  StatedMotor motor;
  MotorJoint joint;

  [[nodiscard]] std::string_view name() const { return key_of(path); }
  [[nodiscard]] const JointWords& words() const;
};

/// A leader or a follower: one bus, and a joint for each motor behind it.
struct RigSide {
  std::string path;  ///< its section: `arm.leader`
  StatedBus bus;
  std::vector<RigJoint> joints;  ///< of a follower in the order of its leader's

  [[nodiscard]] Joints<MotorJoint> motor_joints() const;
};

/// What is coupled: joints of the same name. A rig may have one side of a pair alone, to be looked at.
struct RigPair {
  std::string name;
  std::optional<RigSide> leader, follower;
};

/// A motor of a side that did not switch off at the end, with bus, last status and remedy, as
/// `arm.follower.elbow: motor 2 at /dev/ttyACM0 (damiao) did not report within 0.5 s that it is off (status 0x1
/// (enabled)): switch off the supply of arm.follower and keep clear of it until then`.
std::string describe_powered(const RigSide& side, const PoweredMotor& motor);

/// What is on the desk, as a file reports it: one or two pairs of leader and follower, their buses, motors and
/// joints.
///
///     [arm.leader]                # PAIR.leader or PAIR.follower
///     bus = "damiao"
///     port = "/dev/serial/by-id/..."
///
///     [arm.leader.elbow]          # a joint, coupled with [arm.follower.elbow]
///     motor = 1
///     model = "DM4310"
///     lower_rad = -1.5
///     ...
///
/// Nothing is opened here. Not real-time safe.
class Rig {
 public:
  /// Errors, each with file, line and remedy: those of `Document`; `missing` for a key that has no default;
  /// `inconsistent` for a motor or a port twice, a limit beyond what the motor can do, joints of a pair that do not
  /// match; `out_of_bounds` for the numbers of pairs and joints.
  static Result<Rig> load(const std::filesystem::path& file);
  static Result<Rig> parse(std::string_view text, std::string name);

  [[nodiscard]] const std::vector<RigPair>& pairs() const noexcept { return pairs_; }
  /// All sides; of `name`, a pair, a side or a joint, those that are within it or hold it. Errors: `missing`, with what
  /// there is.
  [[nodiscard]] Result<std::vector<const RigSide*>> sides(std::string_view name = {}) const;
  /// Whether `name` is this path or holds it; the empty name holds all.
  static bool holds(std::string_view name, std::string_view path);
  /// Whether a key is written in it.
  [[nodiscard]] bool has(std::string_view key) const;
  /// The file, as it was named.
  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  /// The error with the line of its parameter, as `Document::locate`.
  [[nodiscard]] Error locate(Error error) const { return document_.locate(std::move(error)); }
  /// The same for an error of a side's bus, whose parameters are those of `StatedBus`.
  [[nodiscard]] Error locate(const RigSide& side, Error error) const;

 private:
  Rig(configuration::Document document, std::string name) : document_(std::move(document)), name_(std::move(name)) {}
  Check read_and_check();
  Check read();
  Check check_keys(const RigSide& side) const;
  Check check_side(const RigSide& side) const;
  Check check_ports() const;
  static Check match_joints(RigPair& pair);

  configuration::Document document_;
  std::string name_;
  std::vector<RigPair> pairs_;
};

}  // namespace tactus::devices
