// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/identification/arm/bag_recording.hpp>
#include <tactus/identification/arm/rig_log.hpp>
#include <tactus/kernel/control/packet.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>
#include <utility>

namespace tactus::arm_identification {

namespace {

using telemetry::LogTable;

constexpr double shortest_stretch_s = 1.0;

Error wrong(ErrorCode code, std::string message, const std::string& file) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = file};
}

struct Interval {
  double from_s, to_s;
};

const std::vector<double>* column(const LogTable& table, std::string_view name) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].name == name) return &table.values[i];
  }
  return nullptr;
}

double seconds(std::uint64_t time_ns) { return 1e-9 * static_cast<double>(time_ns); }

/// Of times that rise, those stretches in which none is long after the one before and `counts` says so of each.
template <class Counts>
std::vector<Interval> stretches_of(const std::vector<double>& time_s, const Counts& counts) {
  std::vector<Interval> found;
  bool open = false;
  for (std::size_t i = 0; i < time_s.size(); ++i) {
    open = open && time_s[i] - found.back().to_s <= longest_pause_s;
    const bool counted = counts(i);
    if (counted && open) {
      found.back().to_s = time_s[i];
    } else if (counted) {
      found.push_back({time_s[i], time_s[i]});
    }
    open = counted;
  }
  return found;
}

/// Where both were.
std::vector<Interval> common(const std::vector<Interval>& one, const std::vector<Interval>& other) {
  std::vector<Interval> both;
  for (const Interval& a : one) {
    for (const Interval& b : other) {
      const Interval here{std::max(a.from_s, b.from_s), std::min(a.to_s, b.to_s)};
      if (here.to_s - here.from_s >= shortest_stretch_s) both.push_back(here);
    }
  }
  return both;
}

/// What one drive told, each answer once, at its own time. A drive answers when it hears a command. Where it pulled to
/// the place of the command before, like a spring, its torque has fallen since then by that stiffness times the way, so
/// what it tells is its least; what moved the arm is the mean, which is more by half of that. (Untold, 144 N m/rad
/// and 3 ms hide 0.23 N m s/rad of viscous friction.)
Result<ToldJoint> told_in(const LogTable& table, const std::string& file) {
  struct Names {
    const char *slides, *turns;
  };
  // Logs of earlier versions call the signals of every joint as if it slid.
  constexpr std::array names{Names{"position_m", "position_rad"}, Names{"position_age_s", "position_age_s"},
                             Names{"drive_velocity_m_per_s", "drive_velocity_rad_per_s"},
                             Names{"drive_force_N", "drive_torque_N_m"},
                             Names{"drive_stiffness_N_per_m", "drive_stiffness_N_m_per_rad"}};
  std::array<const std::vector<double>*, names.size()> found{};
  for (std::size_t i = 0; i < names.size(); ++i) {
    found[i] = column(table, names[i].turns);
    if (found[i] == nullptr) found[i] = column(table, names[i].slides);
    if (found[i] != nullptr) continue;
    return wrong(
        ErrorCode::missing,
        "topic " + table.topic + " has no " + names[i].turns +
            ": the log is not of a rig's joints, or of an earlier version, which did not leave it; record it again",
        file);
  }
  const auto& [position, age_s, velocity, force, stiffness] = found;
  ToldJoint told;
  constexpr double same_answer_s = 1e-6;
  double last_s = -std::numeric_limits<double>::infinity();
  for (std::size_t row = 0; row < table.times_ns.size(); ++row) {
    const double at_s = seconds(table.times_ns[row]) - (*age_s)[row];
    // Also a time that is not a number.
    if (!std::isfinite(at_s) || at_s - last_s < same_answer_s) continue;
    const double since_s = at_s - std::exchange(last_s, at_s);
    const double way = since_s < longest_pause_s ? since_s * (*velocity)[row] : 0.0;
    told.time_s.push_back(at_s);
    told.position.push_back((*position)[row]);
    told.velocity.push_back((*velocity)[row]);
    told.effort.push_back((*force)[row] + 0.5 * (*stiffness)[row] * way);
  }
  return told;
}

ToldJoint within(const ToldJoint& all, const Interval& stretch) {
  const auto from = std::ranges::lower_bound(all.time_s, stretch.from_s) - all.time_s.begin();
  const auto to = std::ranges::upper_bound(all.time_s, stretch.to_s) - all.time_s.begin();
  const auto part = [from, to](const std::vector<double>& values) {
    return std::vector<double>(values.begin() + from, values.begin() + to);
  };
  return {part(all.time_s), part(all.position), part(all.velocity), part(all.effort)};
}

/// The names of the rig's joints, in the order of their topics; empty where the log does not tell.
std::vector<std::string> rig_joints(const telemetry::LogSummary& summary) {
  std::vector<std::string> names;
  const auto about = summary.metadata.find("tactus");
  if (about == summary.metadata.end() || !about->second.contains("joints")) return names;
  std::istringstream text(about->second.at("joints"));
  for (std::string name; std::getline(text, name, ',');) names.push_back(name);
  return names;
}

}  // namespace

bool is_log(const std::string& file) {
  std::error_code ignored;
  return file.ends_with(".mcap") || std::filesystem::is_directory(file, ignored);
}

Result<std::vector<ArmRecording>> read_rig_log(const std::string& file, const std::vector<std::string>& joints) {
  const auto site = telemetry::read_log(file, "/slave/site");
  if (!site) return site.error();
  const std::vector<std::string> of_rig = rig_joints(site->summary);
  const auto* state = site->tables.empty() ? nullptr : column(site->tables.front(), "state");
  if (of_rig.empty() && site->tables.empty()) {
    auto of_bag = read_bag_arm(file, joints);
    if (of_bag) return std::vector{*std::move(of_bag)};
    if (of_bag.error().code != ErrorCode::missing) return of_bag.error();
  }
  if (of_rig.empty() || state == nullptr) {
    return wrong(ErrorCode::missing,
                 "this is no ROS 2 bag with joint states, and no log of a rig whose joints have names: leave one with "
                 "'tactus run ... --realtime --device "
                 "RIG.toml --out DIR'",
                 file);
  }
  std::vector<double> tick_s;
  for (const std::uint64_t time_ns : site->tables.front().times_ns) tick_s.push_back(seconds(time_ns));
  constexpr auto active = static_cast<double>(control::SiteState::active);
  auto stretches = stretches_of(tick_s, [state](std::size_t row) { return (*state)[row] == active; });

  std::vector<ToldJoint> told;
  for (const std::string& joint : joints) {
    const auto found = std::ranges::find(of_rig, joint);
    if (found == of_rig.end()) {
      std::string all;
      for (const std::string& name : of_rig) all += (all.empty() ? "" : ", ") + name;
      return wrong(ErrorCode::inconsistent,
                   "the arm's joint '" + joint + "' is not a joint of the rig, whose joints are " + all +
                       ": call those of the rig file as the URDF does, and record it again",
                   file);
    }
    const auto number = std::to_string(found - of_rig.begin() + 1);
    const auto content = telemetry::read_log(file, "/slave/joint_" + number);
    if (!content) return content.error();
    if (content->tables.empty()) {
      return wrong(ErrorCode::missing, "the log has nothing of the follower's " + joint, file);
    }
    auto one = told_in(content->tables.front(), file);
    if (!one) return one.error();
    stretches = common(stretches, stretches_of(one->time_s, [](std::size_t) { return true; }));
    told.push_back(*std::move(one));
  }
  if (stretches.empty()) {
    return wrong(ErrorCode::missing,
                 "the follower did not follow for " + rounded_number(shortest_stretch_s) +
                     " s with a reply of each drive every " + rounded_number(longest_pause_s) +
                     " s: record it on a machine that does nothing else",
                 file);
  }
  const Seconds tick{(tick_s.back() - tick_s.front()) / static_cast<double>(tick_s.size() - 1)};
  std::vector<ArmRecording> recordings;
  for (const Interval& stretch : stretches) {
    std::vector<ToldJoint> here;
    for (const ToldJoint& joint : told) here.push_back(within(joint, stretch));
    auto recording = recording_of(file, here, joints, tick);
    if (!recording) return recording.error();
    recordings.push_back(*std::move(recording));
  }
  return recordings;
}

}  // namespace tactus::arm_identification
