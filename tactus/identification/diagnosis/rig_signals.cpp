// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/limits.hpp>
#include <tactus/data/recording/names.hpp>
#include <tactus/data/telemetry/episodes.hpp>
#include <tactus/identification/diagnosis/columns.hpp>
#include <tactus/identification/diagnosis/rig_signals.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

namespace tactus::diagnosis {
namespace {

using telemetry::Episode;
using telemetry::LogContent;
using telemetry::LogTable;

constexpr double shortest_episode_s = 0.5;

/// A signal as it is called where the joint slides and where it turns.
struct SignalNames {
  const char *slides, *turns;
};
constexpr SignalNames rig_position{"position_m", "position_rad"};
constexpr SignalNames rig_reported{"drive_force_N", "drive_torque_N_m"};
constexpr SignalNames rig_commanded{"motor_force_N", "motor_torque_N_m"};
constexpr SignalNames rig_sent{"sent_force_N", "sent_torque_N_m"};

/// A column with its name and unit; null values where the topic has none.
struct FoundSignal {
  const std::vector<double>* values = nullptr;
  std::string name = {}, unit = {};
};

FoundSignal find_signal(const LogTable& table, const SignalNames& names) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    const auto& column = table.columns[i];
    if (column.name == names.slides || column.name == names.turns)
      return {.values = &table.values[i], .name = column.name, .unit = column.unit};
  }
  return {};
}

/// A joint with its topics; null where that side is not in the log.
struct RigLogJoint {
  std::string name;
  const LogTable *leader = nullptr, *follower = nullptr;
};

std::vector<RigLogJoint> joints_of_log(const LogContent& content) {
  std::vector<std::string> names;
  if (const auto about = content.summary.metadata.find("tactus"); about != content.summary.metadata.end()) {
    if (const auto listed = about->second.find("joints"); listed != about->second.end()) {
      std::string rest = listed->second;
      while (!rest.empty()) {
        const std::size_t comma = rest.find(',');
        names.push_back(rest.substr(0, comma));
        rest = comma == std::string::npos ? std::string() : rest.substr(comma + 1);
      }
    }
  }
  std::vector<RigLogJoint> joints;
  for (std::size_t number = 1;; ++number) {
    const std::string place = "joint_" + std::to_string(number);
    RigLogJoint joint{.name = number <= names.size() ? names[number - 1] : place,
                      .leader = content.find("/master/" + place),
                      .follower = content.find("/slave/" + place)};
    if (joint.leader == nullptr && joint.follower == nullptr) return joints;
    joints.push_back(std::move(joint));
  }
}

/// Rows of a table within an episode.
std::pair<std::size_t, std::size_t> rows_in(const LogTable& table, const Episode& episode) {
  const auto& times = table.times_ns;
  return {static_cast<std::size_t>(std::ranges::lower_bound(times, episode.from_ns) - times.begin()),
          static_cast<std::size_t>(std::ranges::upper_bound(times, episode.to_ns) - times.begin())};
}

/// How roughly a side moves: the rms of second differences. 0 where it is not there.
double roughness_of(const LogTable* table, const Episode& episode) {
  if (table == nullptr) return 0.0;
  const FoundSignal found = find_signal(*table, rig_position);
  if (found.values == nullptr) return 0.0;
  const auto [first, end] = rows_in(*table, episode);
  double squares = 0.0;
  for (std::size_t i = first + 2; i < end; ++i) {
    squares += std::pow((*found.values)[i] - 2.0 * (*found.values)[i - 1] + (*found.values)[i - 2], 2);
  }
  return end > first + 2 ? std::sqrt(squares / static_cast<double>(end - first - 2)) : 0.0;
}

double roughness_of(const RigLogJoint& joint, const Episode& episode) {
  const double found = roughness_of(joint.leader, episode) + roughness_of(joint.follower, episode);
  return std::isfinite(found) ? found : 0.0;
}

std::string seconds_text(std::uint64_t time_ns) {
  return recording::significant(1e-9 * static_cast<double>(time_ns), 4);
}

Error refuse_rig(ErrorCode code, const SignalRoles& roles, std::string message) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = roles.file.string()};
}

/// All of the log, where it has no states.
Episode all_of(const RigLogJoint& joint) {
  const LogTable& table = joint.follower != nullptr ? *joint.follower : *joint.leader;
  return {.number = 1, .from_ns = table.times_ns.front(), .to_ns = table.times_ns.back()};
}

bool has_values(const FoundSignal& found) {
  return found.values != nullptr && std::ranges::any_of(*found.values, [](double value) { return value != 0.0; });
}

bool wanted_column(const std::string& name) {
  constexpr std::array all{rig_position, rig_reported, rig_commanded, rig_sent};
  return name == "tick" || name == "state" || name == telemetry::episode_mark ||
         std::ranges::any_of(all,
                             [&](const SignalNames& names) { return name == names.slides || name == names.turns; });
}

}  // namespace

Result<std::optional<RigChannels>> read_rig_channels(const SignalRoles& roles) {
  const auto content = telemetry::read_log(
      roles.file, {.topic =
                       [](const std::string& topic) {
                         return topic.starts_with("/master/") || topic.starts_with("/slave/") ||
                                topic == telemetry::episodes_topic;
                       },
                   .column = [](const std::string&, const std::string& column) { return wanted_column(column); }});
  if (!content) return content.error();
  std::vector<RigLogJoint> joints = joints_of_log(*content);
  std::erase_if(joints, [](const RigLogJoint& joint) {
    return find_signal(joint.leader != nullptr ? *joint.leader : *joint.follower, rig_position).values == nullptr;
  });
  if (joints.empty()) return std::optional<RigChannels>();
  std::string listed;
  for (const RigLogJoint& joint : joints) listed += (listed.empty() ? "" : ", ") + joint.name;
  std::vector<Episode> episodes = telemetry::episodes_of(*content);
  if (telemetry::site_that_follows(*content) == nullptr) episodes = {all_of(joints.front())};
  const std::size_t all_episodes = episodes.size();
  std::erase_if(episodes, [](const Episode& episode) { return episode.duration_s() < shortest_episode_s; });
  if (episodes.empty()) {
    return refuse_rig(ErrorCode::missing, roles,
                      "the follower did not follow for half a second in one go, so there is nothing to diagnose: arm "
                      "the rig, and record its motion");
  }
  if (!roles.joint.empty()) {
    const auto named = std::ranges::find(joints, roles.joint, &RigLogJoint::name);
    if (named == joints.end()) {
      return refuse_rig(ErrorCode::missing, roles, "there is no joint '" + roles.joint + "': the rig has " + listed);
    }
    joints = std::vector<RigLogJoint>{*named};
  }
  const RigLogJoint* joint = &joints.front();
  Episode episode = episodes.front();
  double most = -1.0;
  for (const RigLogJoint& one : joints) {
    for (const Episode& stretch : episodes) {
      const double found = roughness_of(one, stretch);
      if (found <= most) continue;
      most = found, joint = &one, episode = stretch;
    }
  }
  RigChannels made;
  if (joints.size() > 1) {
    made.notes.push_back("joint '" + joint->name + "' moves most roughly and was taken, of " + listed +
                         "; name another with --joint");
  }
  if (all_episodes > 1) {
    made.notes.push_back("the log has " + std::to_string(all_episodes) + " episodes: number " +
                         std::to_string(episode.number) + ", from " + seconds_text(episode.from_ns) + " to " +
                         seconds_text(episode.to_ns) + " s, is the one in which that joint moves most roughly");
  }
  const LogTable& clock = joint->leader != nullptr ? *joint->leader : *joint->follower;
  const auto [first, end] = rows_in(clock, episode);
  for (std::size_t row = first; row < end; ++row) {
    made.time_s.push_back(1e-9 * static_cast<double>(clock.times_ns[row] - clock.times_ns[first]));
  }
  if (made.time_s.size() > 2) {
    const double step_s = made.time_s.back() / static_cast<double>(made.time_s.size() - 1);
    const auto gaps = std::ranges::count_if(made.time_s, [&, before = 0.0](double time_s) mutable {
      return time_s - std::exchange(before, time_s) > 1.5 * step_s;
    });
    if (gaps > 0) {
      made.notes.push_back("control cycles were missed at " + std::to_string(gaps) +
                           " places, and the signals are interpolated there");
    }
  }
  const auto add = [&](Role role, const LogTable* table, const FoundSignal& found, double factor) -> Check {
    if (found.values == nullptr) return std::nullopt;
    const auto [from, to] = rows_in(*table, episode);
    if (to - from != made.time_s.size()) {
      return refuse_rig(ErrorCode::inconsistent, roles,
                        "topic " + table->topic +
                            " lacks records that came faster than they were written: record it "
                            "again on a machine that does nothing else");
    }
    RigChannel channel{.role = role, .name = table->topic.substr(1) + "." + found.name, .unit = found.unit};
    for (std::size_t row = from; row < to; ++row) {
      const double value = (*found.values)[row];
      if (!(std::fabs(value) <= recording::largest_value)) {
        return refuse_rig(ErrorCode::inconsistent, roles,
                          "'" + channel.name + "' is not finite, or is beyond 1e30, which is no measurement, at " +
                              seconds_text(table->times_ns[row]) + " s");
      }
      channel.values.push_back(factor * value);
    }
    made.channels.push_back(std::move(channel));
    return std::nullopt;
  };
  const auto force_of = [](const LogTable& table) {
    const FoundSignal found = find_signal(table, rig_reported);
    return has_values(found) ? found : find_signal(table, rig_commanded);
  };
  Check wrong;
  if (joint->leader != nullptr) {
    wrong = add(Role::master_position, joint->leader, find_signal(*joint->leader, rig_position), 1.0);
    // What pushes the hand back is displayed; the motor's force counts toward the environment.
    if (!wrong) wrong = add(Role::displayed_force, joint->leader, force_of(*joint->leader), -1.0);
  }
  if (joint->follower != nullptr) {
    if (!wrong) wrong = add(Role::slave_position, joint->follower, find_signal(*joint->follower, rig_position), 1.0);
    if (!wrong) wrong = add(Role::slave_force, joint->follower, force_of(*joint->follower), 1.0);
    const FoundSignal tip = find_signal(*joint->follower, rig_sent);
    if (!wrong && has_values(tip)) wrong = add(Role::tip_force, joint->follower, tip, 1.0);
  }
  if (wrong) return *std::move(wrong);
  if (!content->summary.complete) {
    made.notes.emplace_back("the log has no end: what its recorder had not written yet is missing");
  }
  return std::optional(std::move(made));
}

}  // namespace tactus::diagnosis
