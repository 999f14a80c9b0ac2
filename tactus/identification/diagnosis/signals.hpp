// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/diagnosis/reported_velocity.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Why a teleoperator shakes, computed from a recording of it.
namespace tactus::diagnosis {

/// What a column of a recording can be. Positions are positive toward the environment.
enum class Role {
  master_position,  ///< of the master, leader
  slave_position,   ///< of the slave, follower
  displayed_force,  ///< of the master's actuator, positive when it pushes the hand back
  tip_force,        ///< of the environment on the slave, positive when it pushes the slave back
  hand_force,       ///< of the hand on the master, positive toward the environment
  slave_force,      ///< of the slave's actuator, positive toward the environment
};
inline constexpr std::size_t role_count = 6;
inline constexpr std::array<Role, role_count> all_roles{Role::master_position, Role::slave_position,
                                                        Role::displayed_force, Role::tip_force,
                                                        Role::hand_force,      Role::slave_force};
constexpr bool is_position(Role role) { return role == Role::master_position || role == Role::slave_position; }
/// `master position`.
std::string_view words_of(Role role);
/// The option that names its column: `--master-position`.
std::string option_of(Role role);

/// Which columns of a recording are what. Whatever is not named is looked for by names and units; what is not found is
/// missing, which only limits what can be determined. As `recording::Source` names them; in a MATLAB file `:COLUMN` may
/// follow.
struct SignalRoles {
  std::filesystem::path file = {};
  std::array<std::string, role_count> names = {};
  std::array<double, role_count> signs = {1.0, 1.0, 1.0, 1.0, 1.0, 1.0};  ///< 1 or -1
  std::string joint = {};  ///< of a ROS 2 bag; empty: the one that moves most roughly
  std::string time = {};
  std::string time_unit = {};  ///< s, ms, us or ns, instead of what the file states; empty: as the file states
  std::optional<double> sample_time_s = {};
};

/// One signal in m and N, or rad and N m, turned by its sign.
struct Channel {
  std::string name = {};
  std::vector<double> values = {};
  /// The distance between neighbouring values that occur: one count of an encoder, one digit of a file. In the unit of
  /// the values, of either sign that was given.
  double step = 0.0;
  [[nodiscard]] bool constant() const { return step == 0.0; }
};

/// What a recording holds of a teleoperator.
struct Signals {
  std::array<std::optional<Channel>, role_count> channels = {};
  Seconds sample_time{0.0};
  std::size_t samples = 0;
  bool rotary = false;  ///< rad and N m instead of m and N
  /// Of master and slave, where a table has a column of it that goes with the position.
  std::optional<ReportedVelocity> master_velocity = {}, slave_velocity = {};
  /// What a reader of the diagnosis should know of the recording: jitter of its times, columns that were not used.
  std::vector<std::string> notes = {};

  [[nodiscard]] const Channel* find(Role role) const {
    const auto& channel = channels[static_cast<std::size_t>(role)];
    return channel ? &*channel : nullptr;
  }
  /// Its values; none where it was not recorded.
  [[nodiscard]] std::span<const double> values(Role role) const {
    const auto& channel = channels[static_cast<std::size_t>(role)];
    return channel ? std::span<const double>(channel->values) : std::span<const double>();
  }
  [[nodiscard]] double duration_s() const { return static_cast<double>(samples) * sample_time.value; }
};

/// Reads a recording: a table or a MATLAB file as `recording::read` takes it, or a log in MCAP of this project's
/// programs (a `.mcap` file or the folder that holds it), of which the topic with most roles counts, or a ROS 2 bag in
/// MCAP: the joint states of leader and follower, found by topic, and what is named as `TOPIC/JOINT.position`.
///
/// Errors: those of reading; `missing` for no position at all (the message lists the columns and the options), for no
/// sample time; `inconsistent` for columns of different length, a unit that is not one of the role, a recording of
/// fewer than 200 samples or less than half a second, or in which nothing changes. Not real-time safe.
Result<Signals> read_signals(const SignalRoles& roles);

/// The distance between neighbouring values that occur, 0 for a constant: of all distances the tenth percentile, for in
/// fast motion counts are passed over, and a file rounds.
double step_of(std::vector<double> values);

}  // namespace tactus::diagnosis
