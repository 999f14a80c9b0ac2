// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/names.hpp>
#include <tactus/identification/diagnosis/columns.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>

namespace tactus::diagnosis {

namespace {

using identification::KnownUnit;
using recording::Entry;
using Words = std::vector<std::string_view>;

const Words& of_position(Role position) {
  static const Words masters{"master", "leader"}, slaves{"slave", "follower"};
  return position == Role::master_position ? masters : slaves;
}

/// How a column is recognised: first by a name of its own, then by words of which each group has one in it.
struct Recognised {
  Words names;
  std::vector<Words> groups;
  Words unlike;
};

const Recognised& recognised(Role role) {
  static const Words places{"position", "pos", "angle", "theta", "displacement", "_x", "_q", "x_", "q_"};
  static const Words forces{"force", "torque", "effort", "tau", "current", "_f", "f_"};
  static const std::array<Recognised, role_count> all{{
      {{"master_position", "leader_position", "x_m", "xm", "q_m", "theta_m"},
       {of_position(Role::master_position), places},
       {"command", "induced", "intended", "target", "goal", "desired"}},
      {{"slave_position", "follower_position", "x_s", "xs", "q_s", "theta_s"},
       {of_position(Role::slave_position), places},
       {"command", "target", "goal", "desired"}},
      {{"displayed_force", "displayed_torque", "feedback_force", "reflected_force", "master_force", "leader_effort"},
       {{"displayed", "feedback", "reflected", "master", "leader"}, forces},
       {"hand", "operator", "handle", "position", "tip", "contact", "env"}},
      {{"tip_force", "sent_force", "told_force", "contact_force", "environment_force", "f_e", "fe", "tip_torque"},
       {{"tip", "contact", "env", "external", "interaction", "wrench"}, forces},
       {"hand", "operator", "peak", "master", "leader"}},
      {{"hand_force", "operator_force", "human_force", "f_h", "fh", "hand_torque"},
       {{"hand", "operator", "human", "user"}, forces},
       {"handle", "position"}},
      {{"slave_force", "slave_motor_force", "slave_torque", "follower_effort", "slave_drive"},
       {of_position(Role::slave_position),
        {"force", "torque", "effort", "tau", "drive", "motor", "actuator", "current"}},
       {"position", "contact", "env", "tip", "external", "measured", "told", "sent"}},
  }};
  return all[index_of(role)];
}

bool mentions(const std::string& text, const Words& words) {
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return text.find(word) != std::string::npos; });
}

bool is_column(const Entry& entry) { return entry.readable && (entry.columns == 1 || entry.rows == 1); }

/// The name of the one column whose unit fits and whose name has a word of each group and none of the others.
template <typename UnitFits>
std::string the_one_like(const std::vector<Words>& groups, const Words& unlike, const std::vector<Entry>& entries,
                         UnitFits unit_fits) {
  std::string found;
  for (const Entry& entry : entries) {
    const std::string name = lower(entry.name);
    const bool fits =
        is_column(entry) && unit_fits(entry.unit) && !mentions(name, unlike) &&
        std::all_of(groups.begin(), groups.end(), [&](const Words& words) { return mentions(name, words); });
    if (!fits) continue;
    if (!found.empty()) return {};
    found = entry.name;
  }
  return found;
}

}  // namespace

std::string_view words_of(Role role) {
  constexpr std::array<std::string_view, role_count> words{"master position", "slave position", "displayed force",
                                                           "tip force",       "hand force",     "slave force"};
  return words[index_of(role)];
}

std::string option_of(Role role) {
  std::string option = "--" + std::string(words_of(role));
  std::replace(option.begin(), option.end(), ' ', '-');
  return option;
}

double step_of(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
  if (values.size() < 2) return 0.0;
  std::vector<double> steps;
  for (std::size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  const auto small = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 10);
  std::nth_element(steps.begin(), small, steps.end());
  return *small;
}

double resolution_of(Role role, const std::vector<double>& values) {
  constexpr std::size_t switched_levels = 3;
  constexpr double resolved = 1e-3;
  const double step = step_of(values);
  if (is_position(role)) return step;
  std::vector<double> different;
  for (const double value : values) {
    if (std::find(different.begin(), different.end(), value) != different.end()) continue;
    different.push_back(value);
    if (different.size() > switched_levels) return step;
  }
  return resolved * step;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

std::span<const KnownUnit> units_of(Role role) {
  return is_position(role) ? std::span<const KnownUnit>(identification::position_units)
                           : std::span<const KnownUnit>(identification::force_units);
}

std::string find_column(Role role, const std::vector<Entry>& entries) {
  const auto unit_fits = [role](const std::string& unit) {
    return unit.empty() || identification::find_unit(units_of(role), unit) != nullptr;
  };
  const Recognised& how = recognised(role);
  for (const std::string_view name : how.names) {
    for (const Entry& entry : entries) {
      if (entry.readable && lower(entry.name) == name && unit_fits(entry.unit)) return entry.name;
    }
  }
  return the_one_like(how.groups, how.unlike, entries, unit_fits);
}

std::string find_velocity(Role position, const std::vector<Entry>& entries) {
  return the_one_like({of_position(position), {"vel", "speed"}}, {"command", "desired", "target", "goal"}, entries,
                      [](const std::string& unit) { return unit.empty() || unit == "rad/s" || unit == "m/s"; });
}

std::vector<std::string> notes_on_columns(const SignalRoles& roles, const std::vector<Entry>& entries,
                                          const Signals& signals) {
  std::vector<std::string> notes;
  std::vector<Entry> unused;
  for (const Entry& entry : entries) {
    const auto plays = [&](const std::string& name) {
      return name == entry.name || recording::split_unit(name).name == entry.name;
    };
    const auto is_velocity = [&](const std::optional<ReportedVelocity>& told) {
      return told && told->name == entry.name;
    };
    const bool used = std::any_of(roles.names.begin(), roles.names.end(), plays) || plays(roles.time) ||
                      is_velocity(signals.master_velocity) || is_velocity(signals.slave_velocity);
    if (used && entry.columns > 1 &&
        std::find(roles.names.begin(), roles.names.end(), entry.name) != roles.names.end()) {
      notes.push_back("'" + entry.name + "' has " + std::to_string(entry.columns) +
                      " columns, of which the first was taken: name another as " + entry.name + ":2");
    }
    if (used || entry.kind != "column" || recording::sounds_like_time(entry.name)) continue;
    unused.push_back(entry);
    const std::vector<Entry> by_name{Entry{.name = entry.name, .rows = entry.rows, .columns = 1, .readable = true}};
    for (const Role role : all_roles) {
      if (entry.unit.empty() || find_column(role, by_name).empty() ||
          identification::find_unit(units_of(role), entry.unit) != nullptr) {
        continue;
      }
      notes.push_back("'" + entry.name + "' is called like a " + std::string(words_of(role)) + ", but " + entry.unit +
                      " is no unit of one");
    }
  }
  if (!unused.empty()) notes.push_back("columns not used: " + recording::enumerate_signals(unused));
  return notes;
}

}  // namespace tactus::diagnosis
