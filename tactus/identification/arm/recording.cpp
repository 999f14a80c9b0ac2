// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/limits.hpp>
#include <tactus/data/recording/recording.hpp>
#include <tactus/data/recording/time_base.hpp>
#include <tactus/identification/arm/recording.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>
#include <utility>

namespace tactus::arm_identification {
namespace {

using identification::inconsistent;

using recording::Column;

constexpr double longest_pause_steps = 10.0;

struct ArmUnit {
  std::string_view symbol;
  double factor;
};
constexpr double degree = std::numbers::pi / 180.0;
constexpr std::array arm_position_units{ArmUnit{"", 1.0},     ArmUnit{"rad", 1.0}, ArmUnit{"deg", degree},
                                        ArmUnit{"m", 1.0},    ArmUnit{"cm", 1e-2}, ArmUnit{"mm", 1e-3},
                                        ArmUnit{"mrad", 1e-3}};
constexpr std::array arm_velocity_units{ArmUnit{"", 1.0},    ArmUnit{"rad/s", 1.0}, ArmUnit{"deg/s", degree},
                                        ArmUnit{"m/s", 1.0}, ArmUnit{"cm/s", 1e-2}, ArmUnit{"mm/s", 1e-3}};

constexpr std::array arm_torque_units{ArmUnit{"N m", 1.0},   ArmUnit{"mN m", 1e-3}, ArmUnit{"kN m", 1e3},
                                      ArmUnit{"N cm", 1e-2}, ArmUnit{"N", 1.0},     ArmUnit{"mN", 1e-3},
                                      ArmUnit{"kN", 1e3}};

Error at_file(Error error, const std::filesystem::path& file) {
  if (error.place.empty()) error.place = file.string();
  return error;
}

/// Multiplies each column by what its unit is worth.
template <std::size_t size>
Check into_si(std::vector<Column>& columns, const std::array<ArmUnit, size>& units, const char* role) {
  for (Column& column : columns) {
    const auto unit =
        std::find_if(units.begin(), units.end(), [&](const ArmUnit& u) { return u.symbol == column.unit; });
    if (unit == units.end()) {
      return Error{.code = ErrorCode::wrong_type,
                   .parameter = role,
                   .message = "column '" + column.name + "' is in " + column.unit + ", which is no unit of a " + role +
                              "; use rad or deg (m or mm), a velocity per s",
                   .place = {}};
    }
    for (double& value : column.values) value *= unit->factor;
  }
  return {};
}

/// Torques into N m, or N of a joint that slides; what is no torque, or has no unit, stays as it is. The unit of all of
/// them: none where some are torques and others are not.
std::string unify_efforts(std::vector<Column>& columns) {
  std::string all = columns.front().unit;
  for (Column& column : columns) {
    const auto unit = std::find_if(arm_torque_units.begin(), arm_torque_units.end(),
                                   [&](const ArmUnit& u) { return u.symbol == column.unit; });
    if (unit != arm_torque_units.end()) {
      for (double& value : column.values) value *= unit->factor;
      column.unit = "N m";
    }
    if (&column == &columns.front()) all = column.unit;
    if (column.unit != all) all.clear();
  }
  return all;
}

Check check_count(const std::vector<Column>& columns, std::size_t joints, const std::string& role) {
  if (columns.size() == joints) return {};
  return inconsistent(role, "--" + role + " names " + std::to_string(columns.size()) + " columns, but the arm has " +
                                std::to_string(joints) + " joints that move; name one for each, the first joint first");
}

/// Times in seconds, from the first sample on.
Check check_times(const std::vector<double>& time_s) {
  std::vector<double> steps(time_s.size() - 1);
  for (std::size_t i = 0; i < steps.size(); ++i) {
    steps[i] = time_s[i + 1] - time_s[i];
    if (steps[i] > 0.0) continue;
    return inconsistent("time", "times do not increase: " + format_number(time_s[i]) + " s of sample " +
                                    std::to_string(i + 1) + " is followed by " + format_number(time_s[i + 1]) +
                                    " s; is this the column of times? Remove doubled samples");
  }
  std::vector<double> sorted = steps;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  const double longest = std::max(longest_pause_steps * *middle, longest_pause_s);
  const auto pause = std::max_element(steps.begin(), steps.end());
  if (*pause <= longest) return {};
  const auto at = static_cast<std::size_t>(pause - steps.begin());
  return inconsistent("time", "nothing was recorded for " + format_number(*pause) + " s after sample " +
                                  std::to_string(at + 1) + " (" + format_number(time_s[at]) + " s), more than the " +
                                  format_number(longest) +
                                  " s that are bridged; cut the file there and name both parts");
}

/// Equal steps.
struct Steps {
  double first_s = 0.0, step_s = 0.0;
  std::size_t count = 0;
};

/// The values at these, on straight lines between samples.
std::vector<double> at_equal_steps(const std::vector<double>& time_s, const std::vector<double>& values,
                                   const Steps& steps) {
  std::vector<double> result(steps.count);
  std::size_t before = 0;
  for (std::size_t i = 0; i < result.size(); ++i) {
    const double t = steps.first_s + static_cast<double>(i) * steps.step_s;
    while (before + 2 < time_s.size() && time_s[before + 1] < t) ++before;
    const double share = std::clamp((t - time_s[before]) / (time_s[before + 1] - time_s[before]), 0.0, 1.0);
    result[i] = values[before] + share * (values[before + 1] - values[before]);
  }
  return result;
}

std::vector<std::string> names_of(const std::vector<Column>& columns) {
  std::vector<std::string> names;
  for (const Column& column : columns) names.push_back(column.name);
  return names;
}

}  // namespace

Result<ArmRecording> read_arm(const std::filesystem::path& file, const ArmColumns& columns,
                              const std::vector<std::string>& joints) {
  auto times = recording::read_times(file, columns.time, columns.time_unit);
  if (!times) return at_file(times.error(), file);
  std::vector<std::string> choices{columns.position, columns.effort};
  if (!columns.velocity.empty()) choices.push_back(columns.velocity);
  auto lists = recording::read_columns(file, choices);
  if (!lists) return at_file(lists.error(), file);
  std::vector<Column>& positions = (*lists)[0];
  std::vector<Column>& efforts = (*lists)[1];
  Check wrong = check_count(positions, joints.size(), "position");
  if (!wrong) wrong = check_count(efforts, joints.size(), "effort");
  if (!wrong && !columns.velocity.empty()) wrong = check_count((*lists)[2], joints.size(), "velocity");
  const std::vector<double>& time_s = times->since_first_s;
  for (const auto& list : *lists) {
    for (const Column& column : list) {
      if (wrong || column.values.size() == time_s.size()) continue;
      wrong = inconsistent("'" + column.name + "' has " + std::to_string(column.values.size()) +
                           " samples where the times are " + std::to_string(time_s.size()));
    }
  }
  if (!wrong) wrong = into_si(positions, arm_position_units, "position");
  if (!wrong && !columns.velocity.empty()) wrong = into_si((*lists)[2], arm_velocity_units, "velocity");
  if (wrong) return at_file(*std::move(wrong), file);
  if (Check bad = check_times(time_s)) return at_file(*std::move(bad), file);
  const double step_s = time_s.back() / static_cast<double>(time_s.size() - 1);
  if (Check bad = recording::check_step(step_s, times->unit_stated)) return at_file(*std::move(bad), file);
  for (std::size_t i = 0; lists->size() > 2 && i < positions.size(); ++i) {
    const Column& velocity = (*lists)[2][i];
    if (const auto factor = recording::step_is_too_long_by(positions[i].values, velocity.values, step_s)) {
      return at_file(recording::contradicted_by_velocity(velocity.name, *factor, step_s), file);
    }
  }
  std::string effort_unit = unify_efforts(efforts);
  ArmRecording result{.file = file,
                      .position_names = names_of(positions),
                      .effort_names = names_of(efforts),
                      .effort_unit = std::move(effort_unit),
                      .start_s = times->first_s,
                      .sample_time = Seconds{step_s}};
  const Steps steps{.first_s = time_s.front(), .step_s = step_s, .count = time_s.size()};
  for (const Column& c : positions) result.position.push_back(at_equal_steps(time_s, c.values, steps));
  for (const Column& c : efforts) result.effort.push_back(at_equal_steps(time_s, c.values, steps));
  if (!columns.velocity.empty()) {
    for (const Column& c : (*lists)[2]) result.velocity.push_back(at_equal_steps(time_s, c.values, steps));
  }
  return result;
}

namespace {

/// Whether all of it can have been measured.
bool is_measured(const ToldJoint& joint) {
  const auto measured = [](double value) { return std::fabs(value) <= recording::largest_value; };
  return std::ranges::all_of(joint.position, measured) && std::ranges::all_of(joint.velocity, measured) &&
         std::ranges::all_of(joint.effort, measured);
}

}  // namespace

Result<ArmRecording> recording_of(const std::filesystem::path& file, const std::vector<ToldJoint>& joints,
                                  const std::vector<std::string>& names, Seconds sample_time) {
  double first_s = -std::numeric_limits<double>::infinity(), last_s = std::numeric_limits<double>::infinity();
  for (const ToldJoint& joint : joints) {
    if (joint.time_s.size() < 2) {
      return at_file(inconsistent("joint '" + names[static_cast<std::size_t>(&joint - joints.data())] +
                                  "' has fewer than two positions"),
                     file);
    }
    if (Check wrong = check_times(joint.time_s)) return at_file(*std::move(wrong), file);
    if (!is_measured(joint)) {
      return at_file(inconsistent("joint '" + names[static_cast<std::size_t>(&joint - joints.data())] +
                                  "' has a value that is not finite, or is beyond 1e30, which is no measurement: cut "
                                  "the recording there, or record again"),
                     file);
    }
    first_s = std::max(first_s, joint.time_s.front());
    last_s = std::min(last_s, joint.time_s.back());
  }
  Steps steps{.first_s = first_s, .step_s = sample_time.value, .count = 0};
  if (last_s > first_s) steps.count = 1 + static_cast<std::size_t>((last_s - first_s) / steps.step_s);
  if (steps.count < 2) return at_file(inconsistent("no time has values of all joints"), file);
  ArmRecording result{.file = file,
                      .position_names = names,
                      .effort_names = names,
                      .effort_unit = "N m",
                      .start_s = first_s,
                      .sample_time = sample_time};
  for (const ToldJoint& joint : joints) {
    result.position.push_back(at_equal_steps(joint.time_s, joint.position, steps));
    result.velocity.push_back(at_equal_steps(joint.time_s, joint.velocity, steps));
    result.effort.push_back(at_equal_steps(joint.time_s, joint.effort, steps));
  }
  return result;
}

}  // namespace tactus::arm_identification
