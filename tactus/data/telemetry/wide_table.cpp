// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/data/telemetry/export_parts.hpp>
#include <tactus/data/telemetry/wide_table.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

namespace tactus::telemetry {

namespace {

/// A quantity of a joint: how its signal is called where it slides, what the table calls it, and whether it is read at
/// the motor.
struct Quantity {
  const char* signal;
  const char* of_force;   ///< name where the joint slides
  const char* of_torque;  ///< and where it turns
  bool measured;
  double factor;
  bool optional;  ///< left out where the log has nothing but zeros
};
constexpr std::array quantities{
    Quantity{"position_m", "position", "position", true, 1.0, false},
    Quantity{"drive_velocity_m_per_s", "velocity", "velocity", true, 1.0, false},
    Quantity{"drive_force_N", "force", "torque", true, 1.0, false},
    Quantity{"motor_force_N", "commanded_force", "commanded_torque", false, 1.0, false},
    Quantity{"received_position_m", "commanded_position", "commanded_position", false, 1.0, true},
    // The message has what pushes the follower back.
    Quantity{"sent_force_N", "external_force", "external_torque", false, -1.0, true},
};
constexpr std::size_t most_rows = std::size_t{1} << 24U;
constexpr const char* age_signal = "position_age_s";

/// Columns that the table of any site or joint needs.
const std::set<std::string>& needed_signals() {
  static const std::set<std::string> all = [] {
    std::set<std::string> names{age_signal, "state", "cause", episode_mark};
    for (const Quantity& quantity : quantities) {
      const Column sliding{.name = quantity.signal, .unit = unit_at_end_of(quantity.signal).symbol};
      names.insert({sliding.name, of_turning_joint(sliding).name});
    }
    return names;
  }();
  return all;
}

bool is_needed_topic(const std::string& topic) {
  constexpr std::array begins{"/master/joint_", "/slave/joint_"};
  constexpr std::array whole{"/master/site", "/slave/site", "/site", episodes_topic};
  return std::ranges::any_of(begins, [&](const char* begin) { return topic.starts_with(begin); }) ||
         std::ranges::any_of(whole, [&](const char* name) { return topic == name; });
}

/// As heads of other programs are written: `external_torque_Nm`.
std::string suffix_of(const std::string& unit) {
  if (unit == "N m") return "_Nm";
  std::string suffix = unit.empty() ? "" : "_" + unit;
  if (const std::size_t slash = suffix.find('/'); slash != std::string::npos) suffix.replace(slash, 1, "_per_");
  return suffix;
}

/// A name that needs no quotes in a table.
std::string plain_name(std::string_view name) {
  std::string plain = report::printable(name);
  std::ranges::replace_if(
      plain, [](char c) { return c == ',' || c == ';' || c == '"' || c == '.'; }, '_');
  return plain;
}

/// Names of the rig's joints as the metadata of the log has them, in the order of their topics.
std::vector<std::string> joints_of_rig(const LogSummary& summary) {
  std::vector<std::string> names;
  const auto about = summary.metadata.find("tactus");
  if (about == summary.metadata.end() || !about->second.contains("joints")) return names;
  std::istringstream text(about->second.at("joints"));
  for (std::string name; std::getline(text, name, ',');) names.push_back(name);
  return names;
}

std::optional<std::size_t> place_of_column(const LogTable& table, std::string_view name) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].name == name) return i;
  }
  return std::nullopt;
}

std::optional<std::size_t> place_of_topic(const LogContent& content, const std::string& topic) {
  for (std::size_t i = 0; i < content.tables.size(); ++i) {
    if (content.tables[i].topic == topic) return i;
  }
  return std::nullopt;
}

bool only_zeros(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double value) { return value == 0.0; });
}

struct CloseTable {
  void operator()(std::FILE* file) const { (void)std::fclose(file); }
};

}  // namespace

Result<WideLog> WideLog::read(const std::filesystem::path& file_or_folder) {
  auto content =
      read_log(file_or_folder, LogSelection{.topic = is_needed_topic, .column = [](const auto&, const auto& column) {
                                              return needed_signals().contains(column);
                                            }});
  if (!content) return content.error();
  if (site_that_follows(*content) == nullptr) {
    return Error{.code = ErrorCode::missing,
                 .parameter = {},
                 .message =
                     "the log has no site of a leader or follower, so there are no episodes: name the log of a "
                     "run with --device or --site, or export its topics with --to",
                 .place = file_or_folder.string()};
  }
  WideLog log(*std::move(content));
  log.add_side("master", "leader");
  log.add_side("slave", "follower");
  return log;
}

void WideLog::add_side(const std::string& role, const std::string& side) {
  const auto about = content_.summary.metadata.find("tactus");
  const auto site = about == content_.summary.metadata.end() ? std::string() : [&] {
    const auto found = about->second.find("site");
    return found == about->second.end() ? std::string() : found->second;
  }();
  auto ticks = place_of_topic(content_, "/" + role + "/site");
  if (!ticks && site == role) ticks = place_of_topic(content_, "/site");
  if (!ticks) return;
  struct Joint {
    std::size_t table;
    std::string name;  ///< empty of a device of one axis
    bool states_unit;
  };
  std::vector<Joint> joints;
  const std::vector<std::string> names = joints_of_rig(content_.summary);
  for (std::size_t number = 1;; ++number) {
    const auto table = place_of_topic(content_, "/" + role + "/joint_" + std::to_string(number));
    if (!table) break;
    const auto& channel = content_.tables[*table].about;
    const auto stated = channel.find("joint");
    std::string name = stated != channel.end()  ? stated->second
                       : number <= names.size() ? names[number - 1]
                                                : "joint_" + std::to_string(number);
    joints.push_back({.table = *table, .name = plain_name(name), .states_unit = stated != channel.end()});
    states_units_ = states_units_ && stated != channel.end();
  }
  if (joints.empty()) joints.push_back({.table = *ticks, .name = {}, .states_unit = true});
  for (const Quantity& quantity : quantities) {
    if (quantity.optional && role == "master") continue;
    const Column sliding{.name = quantity.signal, .unit = unit_at_end_of(quantity.signal).symbol};
    const Column turning = of_turning_joint(sliding);
    std::vector<WideColumn> found;
    bool zeros = true;
    for (const Joint& joint : joints) {
      const LogTable& table = content_.tables[joint.table];
      const auto slides = place_of_column(table, sliding.name), turns = place_of_column(table, turning.name);
      const auto place = turns ? turns : slides;
      if (!place) continue;
      const std::string prefix = side + "." + (joint.name.empty() ? "" : joint.name + ".");
      const std::string unit = joint.states_unit ? suffix_of(table.columns[*place].unit) : std::string();
      found.push_back({.head = prefix + (turns ? quantity.of_torque : quantity.of_force) + unit,
                       .table = joint.table,
                       .signal = *place,
                       .factor = quantity.factor,
                       .measured = quantity.measured});
      zeros = zeros && only_zeros(table.values[*place]);
    }
    if (!quantity.optional || !zeros) columns_.insert(columns_.end(), found.begin(), found.end());
  }
  for (const char* name : {"state", "cause"}) {
    const auto place = place_of_column(content_.tables[*ticks], name);
    if (place) words_.push_back({.head = side + "." + name, .table = *ticks, .signal = *place});
  }
}

std::vector<std::string> WideLog::heads() const {
  std::vector<std::string> all{"time_s"};
  if (content_.start_unix_ns) all.emplace_back("wall_time_s");
  for (const WideColumn& column : columns_) all.push_back(column.head);
  for (const WordColumn& column : words_) all.push_back(column.head);
  return all;
}

std::size_t WideLog::rows(const Episode& episode, double rate_Hz) {
  // A whole number of steps that rounding made a hair less is that number.
  constexpr double hair = 1e-6;
  constexpr double countable = 1e15;
  return 1 + static_cast<std::size_t>(std::min(countable, std::floor(episode.duration_s() * rate_Hz + hair)));
}

/// Rows a little before and behind the episode are taken too, so that its ends lie between two.
std::vector<double> WideLog::values_of(const WideColumn& column, const Episode& episode,
                                       const std::vector<double>& at_s) const {
  constexpr std::uint64_t beside_ns = 50'000'000;
  constexpr double same_s = 1e-6;
  const LogTable& table = content_.tables[column.table];
  const std::vector<double>& signal = table.values[column.signal];
  const std::vector<double>* const age_s = column.measured ? table.find(age_signal) : nullptr;
  const auto& times = table.times_ns;
  const auto first = std::ranges::lower_bound(times, episode.from_ns - std::min(episode.from_ns, beside_ns));
  const auto end = std::ranges::upper_bound(times, episode.to_ns + beside_ns);
  std::vector<double> time_s, value;
  for (auto row = static_cast<std::size_t>(first - times.begin()); row < static_cast<std::size_t>(end - times.begin());
       ++row) {
    const double since_s =
        1e-9 * (static_cast<double>(times[row]) - static_cast<double>(episode.from_ns)) - (age_s ? (*age_s)[row] : 0.0);
    // Also a time that is not a number.
    if (!std::isfinite(since_s) || (!time_s.empty() && !(since_s - time_s.back() > same_s))) continue;
    time_s.push_back(since_s);
    value.push_back(column.factor * signal[row]);
  }
  std::vector<double> found;
  found.reserve(at_s.size());
  std::size_t before = 0;
  for (const double t : at_s) {
    if (time_s.empty()) {
      found.push_back(std::nan(""));
      continue;
    }
    while (before + 2 < time_s.size() && time_s[before + 1] < t) ++before;
    if (time_s.size() == 1) {
      found.push_back(value.front());
      continue;
    }
    const double share = std::clamp((t - time_s[before]) / (time_s[before + 1] - time_s[before]), 0.0, 1.0);
    found.push_back(share == 0.0 ? value[before] : value[before] + share * (value[before + 1] - value[before]));
  }
  return found;
}

std::vector<double> WideLog::column(const std::string& head, const Episode& episode, double rate_Hz) const {
  const auto found = std::ranges::find(columns_, head, &WideColumn::head);
  if (found == columns_.end()) return {};
  std::vector<double> at_s;
  for (std::size_t row = 0; row < rows(episode, rate_Hz); ++row) at_s.push_back(static_cast<double>(row) / rate_Hz);
  return values_of(*found, episode, at_s);
}

Check WideLog::export_csv(const Episode& episode, double rate_Hz, const std::filesystem::path& file) const {
  const std::size_t count = rows(episode, rate_Hz);
  if (count > most_rows) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "rate",
                 .message = "episode " + std::to_string(episode.number) + " would have " + std::to_string(count) +
                            " rows, more than the " + std::to_string(most_rows) + " of a table: lower --rate",
                 .place = file.string()};
  }
  std::vector<std::uint64_t> at_ns;
  std::vector<double> at_s;
  for (std::size_t row = 0; row < count; ++row) {
    at_s.push_back(static_cast<double>(row) / rate_Hz);
    at_ns.push_back(episode.from_ns + static_cast<std::uint64_t>(std::llround(1e9 * at_s.back())));
  }
  std::vector<std::vector<double>> numbers;
  for (const WideColumn& column : columns_) numbers.push_back(values_of(column, episode, at_s));
  std::vector<CodeWords> codes;
  for (const WordColumn& column : words_) {
    codes.push_back(code_words(content_.tables[column.table].columns[column.signal]));
  }
  return report::replace_file(file, [&](const std::string& temporary) {
    constexpr std::size_t piece = std::size_t{1} << 20U;
    std::unique_ptr<std::FILE, CloseTable> stream(std::fopen(temporary.c_str(), "wbe"));
    if (!stream) return false;
    std::string text;
    for (const std::string& head : heads()) text += (text.empty() ? "" : ",") + head;
    text += '\n';
    std::array<char, 40> number{};
    const auto put = [&] {
      const bool whole = std::fwrite(text.data(), 1, text.size(), stream.get()) == text.size();
      text.clear();
      return whole;
    };
    const auto add_time = [&](double value) {
      std::snprintf(number.data(), number.size(), "%.6f", value);
      text += number.data();
    };
    const auto add_value = [&](double value) {
      std::snprintf(number.data(), number.size(), ",%.9g", value);
      text += number.data();
    };
    for (std::size_t row = 0; row < count; ++row) {
      add_time(at_s[row]);
      if (content_.start_unix_ns) {
        text += ',';
        add_time(wall_seconds(*content_.start_unix_ns, at_ns[row]));
      }
      for (const auto& column : numbers) add_value(column[row]);
      for (std::size_t i = 0; i < words_.size(); ++i) {
        const LogTable& table = content_.tables[words_[i].table];
        const auto behind = std::ranges::upper_bound(table.times_ns, at_ns[row]) - table.times_ns.begin();
        const auto place = static_cast<std::size_t>(std::max<std::ptrdiff_t>(1, behind) - 1);
        text.append(",").append(codes[i].of(table.values[words_[i].signal][place]));
      }
      text += '\n';
      if (text.size() >= piece && !put()) return false;
    }
    return put() && std::fclose(stream.release()) == 0;
  });
}

}  // namespace tactus::telemetry
