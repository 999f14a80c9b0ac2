// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/limits.hpp>
#include <tactus/data/recording/names.hpp>
#include <tactus/data/recording/recording.hpp>
#include <tactus/data/recording/resample.hpp>
#include <tactus/data/recording/time_base.hpp>
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/identification/axis/axis_recording.hpp>
#include <tactus/identification/axis/axis_units.hpp>
#include <tactus/identification/diagnosis/bag_signals.hpp>
#include <tactus/identification/diagnosis/columns.hpp>
#include <tactus/identification/diagnosis/rig_signals.hpp>
#include <tactus/identification/diagnosis/signals.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <span>
#include <utility>

namespace tactus::diagnosis {

namespace {

using identification::KnownUnit;
using recording::Entry;

/// Columns that are not named are looked for; a column plays one role.
void fill_in(SignalRoles& roles, const std::vector<Entry>& entries) {
  if (identification::is_teleoperator_scope(entries)) {
    constexpr std::array<const char*, role_count> names{"scope.signals(1).values:1", "scope.signals(1).values:2",
                                                        "scope.signals(3).values:1", "scope.signals(2).values:2",
                                                        "scope.signals(2).values:1", "scope.signals(3).values:2"};
    for (std::size_t i = 0; i < role_count; ++i) {
      if (roles.names[i].empty()) roles.names[i] = names[i];
    }
    return;
  }
  for (const Role role : all_roles) {
    std::string& name = roles.names[index_of(role)];
    if (!name.empty()) continue;
    std::string found = find_column(role, entries);
    if (std::find(roles.names.begin(), roles.names.end(), found) == roles.names.end()) name = std::move(found);
  }
}

Error refuse(ErrorCode code, const SignalRoles& roles, std::string message) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = roles.file.string()};
}

/// The values of a column in m and N, or rad and N m; says whether the axis is rotary where the unit tells.
Result<std::optional<bool>> convert(const SignalRoles& roles, Role role, const std::string& unit_name,
                                    std::vector<double>& values) {
  double factor = roles.signs[index_of(role)];
  std::optional<bool> rotary;
  if (!unit_name.empty()) {
    const KnownUnit* unit = identification::find_unit(units_of(role), unit_name);
    if (unit == nullptr) {
      std::string list;
      for (const KnownUnit& u : units_of(role)) list += (list.empty() ? "" : ", ") + std::string(u.symbol);
      return refuse(ErrorCode::inconsistent, roles,
                    "the column '" + roles.names[index_of(role)] + "' is in " + unit_name + ", which is no unit of a " +
                        std::string(words_of(role)) + ": it must be one of " + list);
    }
    factor *= unit->factor;
    rotary = unit->rotary;
  }
  for (double& value : values) value *= factor;
  return rotary;
}

Error no_position(const SignalRoles& roles, const std::vector<Entry>& entries) {
  return refuse(ErrorCode::missing, roles,
                "no column is recognised as a position of master or slave: name one with --master-position or "
                "--slave-position; the file has: " +
                    recording::enumerate_signals(entries) + " (a column of a matrix is named as NAME:COLUMN)");
}

bool names_a_position(const SignalRoles& roles) {
  return !roles.names[index_of(Role::master_position)].empty() || !roles.names[index_of(Role::slave_position)].empty();
}

/// `NAME` or `NAME:COLUMN`.
recording::Source source_of(const SignalRoles& roles, const std::string& name) {
  recording::Source source{.file = roles.file,
                           .variable = name,
                           .time = roles.time,
                           .time_unit = roles.time_unit,
                           .sample_time_s = roles.sample_time_s};
  if (const auto colon = name.rfind(':'); colon != std::string::npos) {
    std::int64_t column = 0;
    const char* const end = name.data() + name.size();
    const auto read = std::from_chars(name.data() + colon + 1, end, column);
    if (read.ec == std::errc{} && read.ptr == end) {
      source.variable = name.substr(0, colon);
      source.column = column;
    }
  }
  return source;
}

/// Channels with what is known of their time.
struct Found {
  Signals signals;
  std::optional<double> sample_time_s;
  std::optional<double> jitter_s;
  bool time_unit_stated = true;
  std::optional<bool> rotary;
};

Check take(Found& found, const SignalRoles& roles, Role role, std::string name, const std::string& unit,
           std::vector<double> values) {
  const auto rotary = convert(roles, role, unit, values);
  if (!rotary) return rotary.error();
  if (*rotary) {
    if (found.rotary && *found.rotary != **rotary) {
      return refuse(ErrorCode::inconsistent, roles,
                    "'" + name +
                        "' does not belong to the other columns: some are of a linear axis and some of a "
                        "rotary one; name columns of one kind");
    }
    found.rotary = **rotary;
  }
  if (found.signals.samples != 0 && found.signals.samples != values.size()) {
    return refuse(ErrorCode::inconsistent, roles,
                  "'" + name + "' has " + std::to_string(values.size()) + " samples where the columns before have " +
                      std::to_string(found.signals.samples) + "; name columns of one length");
  }
  found.signals.samples = values.size();
  const double step = resolution_of(role, values);
  found.signals.channels[index_of(role)] = Channel{.name = std::move(name), .values = std::move(values), .step = step};
  return std::nullopt;
}

Result<Found> read_columns(SignalRoles roles) {
  const auto entries = recording::contents(roles.file);
  if (!entries) return entries.error();
  fill_in(roles, *entries);
  if (!names_a_position(roles)) return no_position(roles, *entries);
  Found found;
  for (const Role role : all_roles) {
    const std::string& name = roles.names[index_of(role)];
    if (name.empty()) continue;
    auto signal = recording::read(source_of(roles, name));
    if (!signal) {
      Error error = signal.error();
      if (error.parameter == "variable") error.parameter = option_of(role);
      return error;
    }
    found.sample_time_s = signal->sample_time_s;
    found.jitter_s = signal->jitter_s;
    found.time_unit_stated = signal->time_unit_stated;
    if (auto error = take(found, roles, role, name, signal->unit, std::move(signal->values))) return *std::move(error);
  }
  if (identification::is_teleoperator_scope(*entries)) found.rotary = true;
  for (const Role role : {Role::master_position, Role::slave_position}) {
    const Channel* position = found.signals.find(role);
    const std::string name = find_velocity(role, *entries);
    if (position == nullptr || name.empty() || !found.sample_time_s) continue;
    const auto velocity = recording::read(source_of(roles, name));
    if (!velocity) return velocity.error();
    if (const auto factor = recording::step_is_too_long_by(position->values, velocity->values, *found.sample_time_s)) {
      return recording::contradicted_by_velocity(name, *factor, *found.sample_time_s);
    }
    const auto scale = reported_scale(position->values, velocity->values, Seconds{*found.sample_time_s});
    if (!scale) continue;
    auto& told = role == Role::master_position ? found.signals.master_velocity : found.signals.slave_velocity;
    told = ReportedVelocity{.name = name, .scale = *scale};
  }
  found.signals.notes = notes_on_columns(roles, *entries, found.signals);
  return found;
}

/// The columns of a topic as entries, their names without the unit.
std::vector<Entry> entries_of(const telemetry::LogTable& table) {
  std::vector<Entry> entries;
  for (const auto& column : table.columns) {
    auto head = recording::split_unit(column.name);
    entries.push_back({.name = head.unit == column.unit ? head.name : column.name,
                       .unit = column.unit,
                       .kind = "column",
                       .rows = static_cast<std::int64_t>(table.times_ns.size()),
                       .columns = 1,
                       .readable = table.times_ns.size() > 1});
  }
  return entries;
}

/// A bag of other ROS 2 programs.
Result<Found> read_bag(const SignalRoles& roles) {
  auto bag = read_bag_channels(roles);
  if (!bag) return bag.error();
  Found found;
  found.sample_time_s = bag->sample_time_s;
  found.jitter_s = bag->jitter_s;
  for (BagChannel& channel : bag->channels) {
    if (!channel.velocity.empty()) {
      const auto scale = reported_scale(channel.values, channel.velocity, Seconds{bag->sample_time_s});
      auto& told = channel.role == Role::master_position ? found.signals.master_velocity : found.signals.slave_velocity;
      if (scale) told = ReportedVelocity{.name = channel.velocity_name, .scale = *scale};
    }
    // ROS leaves open whether a joint turns or slides: a force in N shows that it slides.
    const std::string unit = channel.unit == "N" ? "N" : "";
    if (auto error = take(found, roles, channel.role, channel.name, unit, std::move(channel.values))) {
      return *std::move(error);
    }
    found.signals.channels[index_of(channel.role)]->step = channel.step;
  }
  if (!found.rotary) found.rotary = true;
  found.signals.notes = std::move(bag->notes);
  return found;
}

/// Times of messages as steps: their mean, and how far they lie from it where the steps are not equal, in which case
/// the channels are resampled. Errors: times that do not rise, or have gaps that are not to be bridged.
Check take_times(Found& found, const std::vector<double>& times_s, const std::string& file, const std::string& topic,
                 bool bridges_gaps = false) {
  if (times_s.size() < 2) return std::nullopt;
  auto sample_time_s = recording::uniform_sample_time(
      times_s, [&](std::size_t row) { return file + ", message " + std::to_string(row + 1) + " of " + topic; });
  if (!sample_time_s) {
    found.jitter_s = recording::jitter_of(times_s);
    if (!found.jitter_s && !bridges_gaps) return sample_time_s.error();
    sample_time_s = (times_s.back() - times_s.front()) / static_cast<double>(times_s.size() - 1);
    for (auto& channel : found.signals.channels) {
      if (channel) channel->values = recording::at_equal_steps(times_s, channel->values);
    }
  }
  found.sample_time_s = *sample_time_s;
  return std::nullopt;
}

/// The log of a rig of several joints; none where it is another log.
Result<std::optional<Found>> read_rig(const SignalRoles& roles) {
  auto rig = read_rig_channels(roles);
  if (!rig) return rig.error();
  if (!*rig) return std::optional<Found>();
  Found found;
  for (RigChannel& channel : (*rig)->channels) {
    if (auto error = take(found, roles, channel.role, channel.name, channel.unit, std::move(channel.values))) {
      return *std::move(error);
    }
  }
  if (auto error = take_times(found, (*rig)->time_s, roles.file.string(), "its sites", true)) return *std::move(error);
  found.signals.notes = std::move((*rig)->notes);
  return std::optional(std::move(found));
}

Result<Found> read_log(const SignalRoles& wanted) {
  const bool names_a_column = std::ranges::any_of(wanted.names, [](const std::string& name) { return !name.empty(); });
  if (!names_a_column) {
    auto rig = read_rig(wanted);
    if (rig && *rig) return **std::move(rig);
    if (!rig && rig.error().code != ErrorCode::wrong_type) return rig.error();
  }
  const auto content = telemetry::read_log(wanted.file);
  if (!content) {
    Error error = content.error();
    if (error.code == ErrorCode::wrong_type) return read_bag(wanted);
    return error;
  }
  const telemetry::LogTable* best = nullptr;
  SignalRoles roles;
  std::ptrdiff_t most = 0;
  for (const auto& table : content->tables) {
    SignalRoles filled = wanted;
    fill_in(filled, entries_of(table));
    const auto named =
        static_cast<std::ptrdiff_t>(role_count) - std::count(filled.names.begin(), filled.names.end(), std::string());
    if (!names_a_position(filled) || named <= most) continue;
    most = named, best = &table, roles = filled;
  }
  if (best == nullptr) {
    std::vector<Entry> all;
    for (const auto& table : content->tables) {
      for (Entry& entry : entries_of(table)) all.push_back(std::move(entry));
    }
    return no_position(wanted, all);
  }
  Found found;
  if (!content->summary.complete) {
    found.signals.notes.push_back("the log has no end: what its recorder had not written yet is missing");
  }
  if (content->summary.damaged_chunks > 0) {
    found.signals.notes.push_back(std::to_string(content->summary.damaged_chunks) +
                                  " damaged chunks of the log were left out");
  }
  const std::vector<Entry> entries = entries_of(*best);
  for (const Role role : all_roles) {
    const std::string& name = roles.names[index_of(role)];
    if (name.empty()) continue;
    const auto entry = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.name == name; });
    if (entry == entries.end()) return recording::no_such_variable(name, wanted.file, entries);
    std::vector<double> values = best->values[static_cast<std::size_t>(entry - entries.begin())];
    for (std::size_t row = 0; row < values.size(); ++row) {
      if (std::fabs(values[row]) <= recording::largest_value) continue;
      const char* what = std::isfinite(values[row]) ? "' is beyond 1e30, which is no measurement, in message "
                                                    : "' is not a finite number in message ";
      return refuse(ErrorCode::inconsistent, wanted,
                    "'" + name + what + std::to_string(row + 1) + " of " + best->topic +
                        "; export the log and correct these samples");
    }
    if (auto error = take(found, roles, role, name, entry->unit, std::move(values))) return *std::move(error);
  }
  std::vector<double> times_s;
  const auto own =
      std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.name == "time" && e.unit == "s"; });
  for (std::size_t i = 0; i < best->times_ns.size(); ++i) {
    times_s.push_back(own != entries.end() ? best->values[static_cast<std::size_t>(own - entries.begin())][i]
                                           : 1e-9 * static_cast<double>(best->times_ns[i] - best->times_ns[0]));
  }
  if (auto error = take_times(found, times_s, wanted.file.string(), best->topic)) return *std::move(error);
  return found;
}

/// A displayed force that goes against the tip force has the other sign.
Check doubt_sign(const SignalRoles& roles, const Signals& signals) {
  const Channel* displayed = signals.find(Role::displayed_force);
  const Channel* tip = signals.find(Role::tip_force);
  if (displayed == nullptr || tip == nullptr || displayed->constant() || tip->constant()) return std::nullopt;
  double d = 0, t = 0, dd = 0, tt = 0, dt = 0;
  const auto n = static_cast<double>(signals.samples);
  for (std::size_t i = 0; i < signals.samples; ++i) {
    const double x = displayed->values[i], y = tip->values[i];
    d += x, t += y, dd += x * x, tt += y * y, dt += x * y;
  }
  const double correlation = (dt - d * t / n) / std::sqrt((dd - d * d / n) * (tt - t * t / n));
  constexpr double surely_turned = -0.7;
  if (!(correlation < surely_turned)) return std::nullopt;
  return refuse(ErrorCode::inconsistent, roles,
                "displayed force and tip force go against one another (correlation " + rounded_number(correlation) +
                    "): both are positive when they push back; turn one round with --displayed-force-sign -1 or "
                    "--tip-force-sign -1");
}

}  // namespace

Result<Signals> read_signals(const SignalRoles& roles) {
  constexpr std::size_t fewest_samples = 200;
  constexpr double shortest_recording_s = 0.5;
  std::error_code ignored;
  const bool log =
      std::filesystem::is_directory(roles.file, ignored) || lower(roles.file.extension().string()) == ".mcap";
  constexpr std::array<std::string_view, 4> tables{".csv", ".tsv", ".txt", ".mat"};
  if (!log && std::filesystem::is_regular_file(roles.file, ignored) &&
      std::find(tables.begin(), tables.end(), lower(roles.file.extension().string())) == tables.end()) {
    return refuse(ErrorCode::wrong_type, roles,
                  "the file is of no format that is read: its name must end in .csv, .tsv, .txt (a table), .mat "
                  "(MATLAB) or .mcap (a log, or a ROS 2 bag)");
  }
  auto found = log ? read_log(roles) : read_columns(roles);
  if (!found) return found.error();
  Signals signals = std::move(found->signals);
  if (!found->sample_time_s) {
    return refuse(ErrorCode::missing, roles,
                  "the recording has no times: state the time between samples with --sample-time-s, or name the column "
                  "of times with --time");
  }
  if (Check wrong = recording::check_step(*found->sample_time_s, found->time_unit_stated)) {
    return refuse(wrong->code, roles, wrong->message);
  }
  signals.sample_time = Seconds{*found->sample_time_s};
  if (std::string note = recording::jitter_note(found->jitter_s, *found->sample_time_s); !note.empty()) {
    signals.notes.insert(signals.notes.begin(), std::move(note));
  }
  signals.rotary = found->rotary.value_or(false);
  if (signals.samples < fewest_samples || signals.duration_s() < shortest_recording_s) {
    return refuse(ErrorCode::inconsistent, roles,
                  "the recording has " + std::to_string(signals.samples) + " samples in " +
                      rounded_number(signals.duration_s()) +
                      " s, too few to judge: record at least 200 samples and half a second, better 5 s");
  }
  const bool changes = std::any_of(all_roles.begin(), all_roles.end(), [&](Role role) {
    return is_position(role) && signals.find(role) != nullptr && !signals.find(role)->constant();
  });
  if (!changes) {
    return refuse(ErrorCode::inconsistent, roles,
                  "no position changes: is it the right column, and was the device on? Name columns with "
                  "--master-position and --slave-position");
  }
  if (auto error = doubt_sign(roles, signals)) return *std::move(error);
  return signals;
}

}  // namespace tactus::diagnosis
