// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/description.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

namespace tactus::telemetry {

namespace {

/// What the metadata of a channel tells of each member, under the member's name and one of these ends.
struct Property {
  const char* key;
  std::string Column::*text;
};
constexpr std::array properties{Property{".name", &Column::name}, Property{".unit", &Column::unit},
                                Property{".site", &Column::site}, Property{".frame", &Column::frame},
                                Property{".sign", &Column::sign}, Property{".doc", &Column::doc}};

constexpr std::size_t most_columns = 4096;

/// A unit of a joint that slides and the one of a joint that turns, with the ends of names that state them.
struct UnitOfJoint {
  Unit slides, turns;
};
constexpr std::array joint_units{
    UnitOfJoint{units::metre, {"rad", "_rad"}},
    UnitOfJoint{units::metre_per_second, {"rad/s", "_rad_per_s"}},
    UnitOfJoint{units::newton, {"N m", "_N_m"}},
    UnitOfJoint{units::newton_per_metre, {"N m/rad", "_N_m_per_rad"}},
    UnitOfJoint{units::newton_second_per_metre, {"N m s/rad", "_N_m_s_per_rad"}},
};

const char* word_of(SignalType type) {
  switch (type) {
    case SignalType::int64:
      return "int64";
    case SignalType::boolean:
      return "bool";
    case SignalType::float64:
      break;
  }
  return "float64";
}

std::string_view next_word(std::string_view& line) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!line.empty() && is_blank(line.front())) line.remove_prefix(1);
  std::size_t end = 0;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view word = line.substr(0, end);
  line.remove_prefix(end);
  return word;
}

Error broken(std::string message) {
  return Error{.code = ErrorCode::syntax, .parameter = {}, .message = std::move(message), .place = {}};
}

}  // namespace

std::string ros_name(std::string_view name) {
  std::string lower(name);
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return lower;
}

Column of_turning_joint(Column column) {
  const auto found = std::find_if(joint_units.begin(), joint_units.end(),
                                  [&](const UnitOfJoint& unit) { return column.unit == unit.slides.symbol; });
  if (found == joint_units.end()) return column;
  column.unit = found->turns.symbol;
  const std::string_view suffix = found->slides.suffix;
  if (!column.name.ends_with(suffix)) return column;
  column.name.resize(column.name.size() - suffix.size());
  constexpr std::string_view force = "force";
  if (found->slides.symbol == std::string_view(units::newton.symbol) && column.name.ends_with(force)) {
    column.name.replace(column.name.size() - force.size(), force.size(), "torque");
  }
  column.name += found->turns.suffix;
  return column;
}

std::string name_without_unit(const Column& column) {
  const auto without = [&column](std::string_view suffix) {
    return column.name.substr(0, column.name.size() - suffix.size());
  };
  for (const UnitOfJoint& unit : joint_units) {
    if (column.unit == unit.turns.symbol && column.name.ends_with(unit.turns.suffix)) return without(unit.turns.suffix);
  }
  const Unit unit = unit_at_end_of(column.name);
  return unit.symbol == column.unit ? without(unit.suffix) : column.name;
}

std::string_view CodeWords::of(double value) const {
  const double place = value - static_cast<double>(first);
  if (!(place >= 0.0 && place < static_cast<double>(words.size())) || place != std::floor(place)) return {};
  return words[static_cast<std::size_t>(place)];
}

CodeWords code_words(const Column& column) {
  std::string_view text = column.doc;
  if (column.type != SignalType::int64 || !text.ends_with('.')) return {};
  text.remove_suffix(1);
  if (const std::size_t colon = text.rfind(": "); colon != std::string_view::npos) text.remove_prefix(colon + 2);
  CodeWords found;
  for (bool more = true; more;) {
    const std::size_t comma = text.find(", ");
    more = comma != std::string_view::npos;
    const std::string_view entry = text.substr(0, comma);
    text.remove_prefix(more ? comma + 2 : text.size());
    std::int64_t number = 0;
    const auto [end, failure] = std::from_chars(entry.data(), entry.data() + entry.size(), number);
    const auto digits = static_cast<std::size_t>(end - entry.data());
    const bool well = failure == std::errc{} && digits + 1 < entry.size() && entry[digits] == ' ';
    if (found.words.empty()) found.first = number;
    // Numbers of which each is the double of the one before are added up, and stand for no one thing.
    if (!well || number != found.first + static_cast<std::int64_t>(found.words.size())) return {};
    found.words.emplace_back(entry.substr(digits + 1));
  }
  return found.words.size() > 1 ? found : CodeWords{};
}

std::string ros2msg(const std::vector<Column>& columns) {
  std::string text;
  for (const Column& column : columns) {
    text += "# " + column.doc;
    if (!column.unit.empty()) text += " Unit: " + column.unit + ".";
    if (!column.site.empty()) text += " Site: " + column.site + ".";
    if (!column.frame.empty()) text += " Frame: " + column.frame + ".";
    if (!column.sign.empty()) text += " Positive: " + column.sign + ".";
    text += std::string("\n") + word_of(column.type) + " " + ros_name(column.name) + "\n";
  }
  return text;
}

std::map<std::string, std::string> column_metadata(const std::vector<Column>& columns) {
  std::map<std::string, std::string> metadata;
  for (const Column& column : columns) {
    const std::string key = ros_name(column.name);
    for (const auto& [end, text] : properties) {
      if (!(column.*text).empty()) metadata[key + end] = column.*text;
    }
  }
  return metadata;
}

Result<std::vector<Column>> columns_of(std::string_view definition,
                                       const std::map<std::string, std::string>& metadata) {
  std::vector<Column> columns;
  while (!definition.empty()) {
    std::string_view line = definition.substr(0, definition.find('\n'));
    definition.remove_prefix(std::min(definition.size(), line.size() + 1));
    line = line.substr(0, line.find('#'));
    const std::string_view type = next_word(line);
    if (type.empty()) continue;
    if (columns.size() == most_columns)
      return broken("a message has more than " + std::to_string(most_columns) + " members");
    const std::string key(next_word(line));
    Column column;
    if (type == "bool") {
      column.type = SignalType::boolean;
    } else if (type == "int64") {
      column.type = SignalType::int64;
    } else if (type != "float64") {
      return broken("a member of type '" + std::string(type.substr(0, 64)) +
                    "' cannot be read: only float64, int64 and bool can");
    }
    if (key.empty() || !next_word(line).empty()) return broken("a line of the message definition is not 'type name'");
    column.name = key;
    column.unit = unit_at_end_of(key).symbol;
    for (const auto& [end, text] : properties) {
      if (const auto found = metadata.find(key + end); found != metadata.end()) column.*text = found->second;
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace tactus::telemetry
