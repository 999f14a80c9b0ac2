// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>
#include <tactus/data/telemetry/export.hpp>
#include <tactus/data/telemetry/export_parts.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <set>
#include <string>
#include <utility>

namespace tactus::telemetry {

namespace {

/// The unit between the only brackets of the head, which is how a reader finds it.
std::string with_unit(const std::string& name, std::string unit) {
  std::replace(unit.begin(), unit.end(), '[', '(');
  std::replace(unit.begin(), unit.end(), ']', ')');
  return name + " [" + unit + "]";
}

/// `displayed_force [N]` for `displayed_force_N`.
std::string head_of(const Column& column) {
  return column.unit.empty() ? column.name : with_unit(name_without_unit(column), column.unit);
}

/// A field as it stands in a line: in quotes where it would be taken for more than one.
std::string field_of(const std::string& text) {
  if (text.find_first_of(",;\"") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted.append(c == '"' ? 2 : 1, c);
  return quoted + '"';
}

/// The line of heads. Where two would be equal without the end of the name that says the unit, it stays.
std::string heads_of(const ExportColumns& table) {
  std::set<std::string> given;
  std::string line;
  for (const Column& column : table.columns) {
    std::string head = head_of(column);
    if (!given.insert(head).second) head = with_unit(column.name, column.unit);
    line += (line.empty() ? "" : ",") + field_of(head);
  }
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (!table.codes[i].words.empty()) line += "," + field_of(table.columns[i].name + "_text");
  }
  return line + '\n';
}

struct CloseStream {
  void operator()(std::FILE* file) const { (void)std::fclose(file); }
};

bool put(std::FILE* file, std::string& text) {
  const bool whole = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  text.clear();
  return whole;
}

}  // namespace

Check export_csv(const LogContent& content, const std::filesystem::path& file) {
  if (auto error = refuse_empty(content, file)) return error;
  const LogTable& original = content.tables.front();
  const ExportColumns table(original, content.start_unix_ns);
  return report::replace_file(file, [&](const std::string& temporary) {
    constexpr std::size_t piece = std::size_t{1} << 20U;
    std::unique_ptr<std::FILE, CloseStream> stream(std::fopen(temporary.c_str(), "wbe"));
    if (!stream) return false;
    std::string text;
    if (const auto condition = condition_of(content.summary, original.topic)) {
      text += "# " + condition->label + "\n";
      for (const auto& [key, value] : condition->set) text += "# " + key + "=" + value + "\n";
    }
    for (const auto& [key, value] : about_channel(original)) text += "# " + key + "=" + value + "\n";
    text += heads_of(table);
    for (std::size_t row = 0; row < original.times_ns.size(); ++row) {
      for (std::size_t i = 0; i < table.values.size(); ++i) {
        if (i != 0) text += ',';
        text += format_number(table.values[i][row]);
      }
      for (std::size_t i = 0; i < table.values.size(); ++i) {
        const CodeWords& codes = table.codes[i];
        if (!codes.words.empty()) text += "," + field_of(std::string(codes.of(table.values[i][row])));
      }
      text += '\n';
      if (text.size() >= piece && !put(stream.get(), text)) return false;
    }
    return put(stream.get(), text) && std::fclose(stream.release()) == 0;
  });
}

}  // namespace tactus::telemetry
