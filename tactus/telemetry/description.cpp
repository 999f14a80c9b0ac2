#include <tactus/telemetry/description.hpp>

#include <algorithm>
#include <array>

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
