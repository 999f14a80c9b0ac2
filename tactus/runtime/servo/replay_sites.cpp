// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/replay_sites.hpp>
#include <tactus/runtime/servo/site_parts.hpp>

#include <set>
#include <sstream>

namespace tactus::runtime {

using control::SiteRole;
using station::DeviceLimits;
using station::DeviceReading;
using telemetry::LogContent;
using telemetry::LogTable;

namespace {

DeviceReading reading_of_axis(const AxisRecord& axis) {
  return {.position_m = axis.position_m, .force_N = axis.read_force_N, .grip = axis.grip};
}

const Words* words_of_device(const LogContent& content, SiteRole role) {
  const auto found = content.summary.metadata.find(std::string("device_of_") + name_of(role));
  return found == content.summary.metadata.end() ? nullptr : &found->second;
}

}  // namespace

DeviceReading reading_of(const SiteLogRecord& row) { return reading_of_axis(row); }

Joints<DeviceReading> reading_of(const JointsRow& row) {
  Joints<DeviceReading> reading(row.joints.size());
  for_each_joint(
      [](DeviceReading& to, const JointLogRecord& from) {
        to = reading_of_axis(from);
        to.age_s = from.position_age_s;
        to.motor_report = {.velocity_m_per_s = from.drive_velocity_m_per_s, .force_N = from.drive_force_N};
      },
      reading, row.joints);
  return reading;
}

bool is_of_joints(const LogContent& content) {
  return std::ranges::any_of(content.tables, [](const LogTable& table) {
    return table.topic.starts_with("/master/joint_") || table.topic.starts_with("/slave/joint_");
  });
}

Result<std::size_t> joints_in(const LogContent& content, const std::string& place) {
  const std::string begin = place + "/joint_";
  std::set<std::string> topics;
  for (const LogTable& table : content.tables) {
    if (table.topic.starts_with(begin)) topics.insert(table.topic);
  }
  if (topics.size() > most_joints) {
    return refuse_replay(ErrorCode::inconsistent, "the log has " + std::to_string(topics.size()) + " topics " + begin +
                                                      "..., and a device has at most " + std::to_string(most_joints) +
                                                      " joints");
  }
  for (std::size_t joint = 1; joint <= topics.size(); ++joint) {
    const std::string topic = begin + std::to_string(joint);
    if (topics.contains(topic)) continue;
    return refuse_replay(ErrorCode::missing, "the log has no topic " + topic + ", and others of " + begin.substr(1));
  }
  return topics.size();
}

std::vector<std::string> names_of_joints(const LogContent& content) {
  std::vector<std::string> names;
  std::istringstream text(about(content, "tactus", "joints"));
  for (std::string name; std::getline(text, name, ',');) names.push_back(name);
  return names;
}

std::optional<SiteRole> only_site(const LogContent& content) {
  const std::string site = about(content, "tactus", "site");
  for (const auto& [role, name] : enumerators(SiteRole{})) {
    if (site == name) return role;
  }
  return std::nullopt;
}

Result<control::Agreement> agreement_in(const LogContent& content) {
  if (const auto agreement = agreement_from(about(content, "tactus", "agreement"))) return *agreement;
  return refuse_replay(ErrorCode::missing,
                       "the log does not state what its site had in common with the other (agreement): it is of an "
                       "earlier version, which did not leave it, so it is not replayed; record it again");
}

Result<DeviceLimits> limits_of(const LogContent& content, SiteRole role, const DeviceLimits&) {
  const Words* const words = words_of_device(content, role);
  return words == nullptr ? DeviceLimits{} : limits_in(*words);
}

Result<Joints<DeviceLimits>> limits_of(const LogContent& content, SiteRole role, const Joints<DeviceLimits>& like) {
  const std::string name = std::string("device_of_") + name_of(role);
  const Words* const words = words_of_device(content, role);
  if (words == nullptr) {
    return refuse_replay(ErrorCode::missing,
                         "the log does not state the limits of the joints (" + name +
                             "): it is of an earlier version, which did not leave them, so it is not replayed; "
                             "record it again");
  }
  auto limits = limits_in(*words, like.size());
  if (!limits) return under(name, limits.error());
  return limits;
}

Result<std::size_t> common_rows(const std::vector<const LogTable*>& tables, bool whole) {
  const auto rows = [](const LogTable* table) { return table->times_ns.size(); };
  const auto [least, most] = std::ranges::minmax_element(tables, {}, rows);
  if (whole && rows(*least) != rows(*most)) {
    return refuse_replay(ErrorCode::inconsistent, "topic " + (*least)->topic + " has " + std::to_string(rows(*least)) +
                                                      " records and topic " + (*most)->topic + " has " +
                                                      std::to_string(rows(*most)) + ": some are missing");
  }
  return rows(*least);
}

Error tick_is_missing(const LogTable& table, std::int64_t tick) {
  return refuse_replay(ErrorCode::inconsistent,
                       "topic " + table.topic + ": control cycle " + std::to_string(tick) + " is missing");
}

}  // namespace tactus::runtime
