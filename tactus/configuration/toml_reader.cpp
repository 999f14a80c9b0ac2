#include <tactus/configuration/binding.hpp>
#include <tactus/configuration/text.hpp>
#include <tactus/configuration/toml_reader.hpp>

#include <algorithm>

#include <toml++/toml.h>

namespace tactus::configuration {

namespace {

// A dotted key makes one table in another per dot, and tables are destroyed recursively. With the limit on nested
// values this bounds the depth to 16 times 100 tables, far below what a stack holds.
constexpr std::ptrdiff_t most_dots_in_a_line = 100;

Position position_of(const toml::source_position& position) { return {position.line, position.column}; }

std::string place(const std::string& name, Position position) {
  return name + ":" + std::to_string(position.line) + ":" + std::to_string(position.column);
}

Error syntax_error(std::string message, std::string place_of_it) {
  return {.code = ErrorCode::syntax, .parameter = {}, .message = std::move(message), .place = std::move(place_of_it)};
}

Check check_size(std::string_view text, const std::string& name) {
  if (text.size() > longest_document) {
    return syntax_error("the text is longer than the 1 MiB that a configuration may have", name);
  }
  Position position{.line = 1, .column = 1};
  while (!text.empty()) {
    const std::string_view line = text.substr(0, text.find('\n'));
    if (std::count(line.begin(), line.end(), '.') > most_dots_in_a_line) {
      return syntax_error("the line has more than 100 dots, so it is no configuration", place(name, position));
    }
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    ++position.line;
  }
  return {};
}

Value value_of(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return Table{};
    case toml::node_type::boolean:
      return node.as_boolean()->get();
    case toml::node_type::integer:
      return node.as_integer()->get();
    case toml::node_type::floating_point:
      return node.as_floating_point()->get();
    case toml::node_type::string:
      return node.as_string()->get();
    case toml::node_type::array:
      return Foreign{"an array"};
    case toml::node_type::date:
      return Foreign{"a date"};
    case toml::node_type::time:
      return Foreign{"a time"};
    default:
      return Foreign{"a date with a time"};
  }
}

void append_entries(const toml::table& table, const std::string& section, std::vector<Entry>& entries) {
  for (const auto& [key, node] : table) {
    const std::string name = is_bare_key(key.str()) ? std::string(key.str()) : toml_string(key.str());
    Entry entry{.path = join(section, name),
                .value = value_of(node),
                .key_position = position_of(key.source().begin),
                .value_position = position_of(node.source().begin),
                .assignment = {},
                .typed = {}};
    entries.push_back(entry);
    if (const toml::table* below = node.as_table()) append_entries(*below, entry.path, entries);
  }
}

Error error_of(const toml::parse_error& error, const std::string& name) {
  std::string message = printable(error.description(), 300);
  if (message.find("could not determine value type") != std::string::npos) {
    message += "; a text needs quotes, as in \"off\"";
  }
  return syntax_error("this is not TOML: " + message, place(name, position_of(error.source().begin)));
}

}  // namespace

Result<std::vector<Entry>> read_toml(std::string_view text, const std::string& name) {
  if (Check problem = check_size(text, name)) return *std::move(problem);
  const toml::parse_result parsed = toml::parse(text, name);
  if (!parsed) return error_of(parsed.error(), name);
  std::vector<Entry> entries;
  append_entries(parsed.table(), {}, entries);
  // toml++ keeps its keys in alphabetical order. A section precedes its keys before and after this sort, because its
  // own name is written no later than theirs.
  std::stable_sort(entries.begin(), entries.end(),
                   [](const Entry& a, const Entry& b) { return a.key_position < b.key_position; });
  return entries;
}

}  // namespace tactus::configuration
