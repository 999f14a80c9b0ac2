// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/names.hpp>
#include <tactus/data/recording/recording.hpp>
#include <tactus/data/recording/time_base.hpp>
#include <tactus/identification/axis/axis_recording.hpp>
#include <tactus/identification/axis/axis_units.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <functional>
#include <span>
#include <string_view>
#include <utility>

namespace tactus::identification {
namespace {

using recording::Entry;

constexpr std::array<std::string_view, 13> position_names{"position",
                                                          "pos",
                                                          "x",
                                                          "q",
                                                          "theta",
                                                          "angle",
                                                          "displacement",
                                                          "y",
                                                          "phi",
                                                          "joint_position",
                                                          "motor_position",
                                                          "slave_position",
                                                          "encoder"};
constexpr std::array<std::string_view, 12> force_names{
    "force",          "torque",          "tau",    "f", "u", "effort", "command", "motor_torque", "motor_force",
    "actuator_force", "actuator_torque", "t_motor"};
constexpr std::array<std::string_view, 8> actuator_words{"motor", "actuator", "command", "drive",
                                                         "tau_s", "control",  "effort",  "input"};
constexpr std::array<std::string_view, 8> contact_words{"env",    "measured", "contact", "interaction",
                                                        "sensor", "external", "f_e",     "load"};

constexpr std::array<std::string_view, 7> hand_words{"hand", "operator", "human", "user", "person", "grip", "f_h"};
constexpr std::array<std::string_view, 3> master_words{"master", "handle", "hand"};
constexpr std::array<std::string_view, 3> slave_words{"slave", "env", "remote"};

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

bool mentions(std::string_view name, std::span<const std::string_view> words) {
  const std::string text = lower(name);
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return text.find(word) != std::string::npos; });
}

/// The entries that may play a role: those with a fitting unit, or where there are none, those without a unit whose
/// name fits.
std::vector<const Entry*> candidates(const std::vector<Entry>& entries, std::span<const KnownUnit> units,
                                     std::span<const std::string_view> names) {
  std::vector<const Entry*> result;
  for (const Entry& entry : entries) {
    if (entry.readable && find_unit(units, entry.unit) != nullptr) result.push_back(&entry);
  }
  if (!result.empty()) return result;
  for (const Entry& entry : entries) {
    const std::string name = lower(entry.name.substr(entry.name.rfind('.') + 1));
    const bool one = entry.columns == 1 || entry.rows == 1;
    if (entry.readable && one && std::find(names.begin(), names.end(), name) != names.end()) result.push_back(&entry);
  }
  return result;
}

Error cannot_choose(const AxisRoles& roles, const std::vector<Entry>& entries, const std::string& role,
                    const std::vector<const Entry*>& found) {
  std::string why =
      found.empty() ? "no column is recognised as the " + role : "more than one column may be the " + role;
  return {.code = ErrorCode::missing,
          .parameter = role,
          .message = why + ": name it with --" + role + "; the file has: " + recording::enumerate_signals(entries) +
                     " (a column of a matrix is named as NAME:COLUMN)",
          .place = roles.file.string()};
}

/// Of several forces the one whose name says so.
std::vector<const Entry*> told_by_name(std::vector<const Entry*> found, std::span<const std::string_view> wanted,
                                       std::span<const std::string_view> unwanted) {
  if (found.size() < 2) return found;
  auto kept = found;
  std::erase_if(kept, [&](const Entry* e) { return !mentions(e->name, wanted) || mentions(e->name, unwanted); });
  if (kept.empty()) {
    kept = found;
    std::erase_if(kept, [&](const Entry* e) { return mentions(e->name, unwanted); });
  }
  return kept.empty() ? found : kept;
}

Check find_columns(AxisRoles& roles, const std::vector<Entry>& entries, bool needs_measured) {
  if (is_teleoperator_scope(entries)) {
    if (roles.of_the_hand && roles.position.empty()) roles.position = "scope.signals(1).values:1";
    if (roles.of_the_hand && roles.force.empty()) roles.force = "scope.signals(2).values:1";
    if (roles.position.empty()) roles.position = "scope.signals(1).values:2";
    if (roles.force.empty()) roles.force = "scope.signals(3).values:2";
    if (roles.measured.empty() && needs_measured) {
      roles.measured = "scope.signals(2).values:2";
      if (!roles.measured_sign) roles.measured_sign = -1.0;
    }
    return std::nullopt;
  }
  if (roles.position.empty()) {
    auto found = candidates(entries, position_units, position_names);
    if (roles.of_the_hand) found = told_by_name(found, master_words, slave_words);
    if (found.size() != 1) return cannot_choose(roles, entries, "position", found);
    roles.position = found.front()->name;
  }
  auto forces = candidates(entries, force_units, force_names);
  std::erase_if(forces, [&](const Entry* e) { return e->name == roles.position; });
  if (roles.force.empty()) {
    auto left = forces;
    std::erase_if(left, [&](const Entry* e) { return e->name == roles.measured; });
    left = roles.of_the_hand ? told_by_name(left, hand_words, actuator_words)
                             : told_by_name(left, actuator_words, contact_words);
    if (left.size() != 1) return cannot_choose(roles, entries, "force", left);
    roles.force = left.front()->name;
  }
  if (roles.measured.empty() && needs_measured) {
    std::erase_if(forces, [&](const Entry* e) { return e->name == roles.force || !mentions(e->name, contact_words); });
    if (forces.size() == 1) roles.measured = forces.front()->name;
  }
  return std::nullopt;
}

struct ReadColumn {
  AxisColumn column;
  std::optional<bool> rotary;
  std::optional<double> sample_time_s;
  std::optional<double> jitter_s;
  bool time_unit_stated;
};

Result<ReadColumn> read_column(const AxisRoles& roles, const std::string& name, std::span<const KnownUnit> units,
                               const char* role, double sign) {
  recording::Source source{.file = roles.file,
                           .variable = name,
                           .time = roles.time,
                           .time_unit = roles.time_unit,
                           .sample_time_s = roles.sample_time_s};
  if (const auto colon = name.rfind(':'); colon != std::string::npos) {
    std::int64_t column = 0;
    const auto* end = name.data() + name.size();
    const auto read = std::from_chars(name.data() + colon + 1, end, column);
    if (read.ec == std::errc{} && read.ptr == end) {
      source.variable = name.substr(0, colon);
      source.column = column;
    }
  }
  auto signal = recording::read(source);
  if (!signal) return signal.error();
  ReadColumn result{.column = {.name = name, .factor = sign, .values = std::move(signal->values)},
                    .rotary = {},
                    .sample_time_s = signal->sample_time_s,
                    .jitter_s = signal->jitter_s,
                    .time_unit_stated = signal->time_unit_stated};
  if (!signal->unit.empty()) {
    const KnownUnit* unit = find_unit(units, signal->unit);
    if (unit == nullptr) {
      std::string list;
      for (const KnownUnit& u : units) list += (list.empty() ? "" : ", ") + std::string(u.symbol);
      return Error{ErrorCode::inconsistent, role,
                   "the column '" + name + "' is in " + signal->unit + ", which is no unit of a " + role +
                       ": it must be one of " + list,
                   roles.file.string()};
    }
    result.column.factor *= unit->factor;
    result.rotary = unit->rotary;
  }
  for (double& value : result.column.values) value *= result.column.factor;
  return result;
}

/// The columns of a table that have no role, in a sentence; empty where there are none.
std::string unused_columns(const AxisRoles& roles, const std::vector<Entry>& entries) {
  std::vector<Entry> unused;
  for (const Entry& entry : entries) {
    const auto plays = [&](const std::string& name) {
      return !name.empty() && (name == entry.name || recording::split_unit(name).name == entry.name);
    };
    if (entry.kind != "column" || recording::sounds_like_time(entry.name) || plays(roles.time)) continue;
    if (plays(roles.position) || plays(roles.force) || plays(roles.external) || plays(roles.measured)) continue;
    unused.push_back(entry);
  }
  return unused.empty() ? std::string() : "columns not used: " + recording::enumerate_signals(unused);
}

}  // namespace

bool is_teleoperator_scope(const std::vector<Entry>& entries) {
  int found = 0;
  for (const Entry& entry : entries) {
    for (const char* name : {"scope.signals(1).values", "scope.signals(2).values", "scope.signals(3).values"}) {
      if (entry.readable && entry.name == name && entry.columns == 2 && entry.rows > 2) ++found;
    }
  }
  return found == 3;
}

Result<AxisRecording> read_axis(const AxisRoles& wanted, bool needs_measured) {
  AxisRoles roles = wanted;
  const auto entries = recording::contents(roles.file);
  if (!entries) return entries.error();
  if (auto error = find_columns(roles, *entries, needs_measured)) return *std::move(error);
  auto position = read_column(roles, roles.position, position_units, "position", roles.position_sign.value_or(1.0));
  if (!position) return position.error();
  const double force_sign = roles.force_sign.value_or(1.0);
  auto force = read_column(roles, roles.force, force_units, "force", force_sign);
  if (!force) return force.error();
  if (position->rotary && force->rotary && *position->rotary != *force->rotary) {
    return Error{ErrorCode::inconsistent,
                 {},
                 "'" + roles.position + "' and '" + roles.force +
                     "' do not belong together: one is of a linear axis and the other of a rotary one",
                 roles.file.string()};
  }
  if (!position->sample_time_s) {
    return Error{ErrorCode::missing, "sample_time_s",
                 "the recording has no times: state the time between samples with --sample-time-s, or name the column "
                 "of times with --time",
                 roles.file.string()};
  }
  if (Check wrong = recording::check_step(*position->sample_time_s, position->time_unit_stated)) {
    wrong->place = roles.file.string();
    return *std::move(wrong);
  }
  AxisRecording result{.position = std::move(position->column),
                       .force = std::move(force->column),
                       .measured = {},
                       .sample_time = Seconds{*position->sample_time_s}};
  const std::string names = lower(roles.position + " " + roles.force);
  const bool sounds_rotary = is_teleoperator_scope(*entries) || names.find("torque") != std::string::npos ||
                             names.find("theta") != std::string::npos || names.find("angle") != std::string::npos ||
                             names.find("tau") != std::string::npos;
  result.rotary = position->rotary ? *position->rotary : force->rotary.value_or(sounds_rotary);
  if (!roles.measured.empty()) {
    auto measured =
        read_column(roles, roles.measured, force_units, "measured force", roles.measured_sign.value_or(1.0));
    if (!measured) return measured.error();
    result.measured = std::move(measured->column);
  }
  const std::size_t count = result.position.values.size();
  if (!roles.external.empty()) {
    const auto external = read_column(roles, roles.external, force_units, "external force", force_sign);
    if (!external) return external.error();
    if (external->column.values.size() == result.force.values.size()) {
      std::transform(result.force.values.begin(), result.force.values.end(), external->column.values.begin(),
                     result.force.values.begin(), std::plus<>());
    } else {
      result.force.values.clear();
    }
  }
  if (result.force.values.size() != count || (result.measured && result.measured->values.size() != count)) {
    return Error{
        ErrorCode::inconsistent, {}, "the named columns have different numbers of samples", roles.file.string()};
  }
  if (std::string note = recording::jitter_note(position->jitter_s, *position->sample_time_s); !note.empty()) {
    result.notes.push_back(std::move(note));
  }
  if (std::string note = unused_columns(roles, *entries); !note.empty()) result.notes.push_back(std::move(note));
  return result;
}

}  // namespace tactus::identification
