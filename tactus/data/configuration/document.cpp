// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/assign.hpp>
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/configuration/text.hpp>
#include <tactus/data/configuration/toml_reader.hpp>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <system_error>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace tactus::configuration {

namespace {

Error unreadable(const std::string& name, std::string message) {
  return {.code = ErrorCode::missing, .parameter = {}, .message = std::move(message), .place = name};
}

Result<std::string> read_file(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code problem;
  const auto status = std::filesystem::status(file, problem);
  if (status.type() == std::filesystem::file_type::not_found) {
    return unreadable(name, "there is no such file: check the path, which counts from the current folder");
  }
  if (std::filesystem::is_directory(status)) return unreadable(name, "this is a folder: give a TOML file in it");

  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text(longest_document + 1, '\0');
  if (stream) stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream && !stream.eof()) {
    return unreadable(name, concat({"the file cannot be read (", std::generic_category().message(errno),
                                    "): check its permissions and the disk"}));
  }
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > longest_document) {
    return unreadable(name, "the file is longer than the 1 MiB that a configuration may have");
  }
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    return unreadable(name, "the file is empty: write at least one key");
  }
  return text;
}

/// The right side of an assignment: a TOML value, else the text itself.
Result<Value> value_from(std::string_view typed) {
  const auto entries = read_toml(concat({"value = ", typed}), {});
  if (entries && (entries->size() == 1 || std::holds_alternative<Table>(entries->front().value))) {
    return entries->front().value;
  }
  // Reading it back as TOML tells whether it is UTF-8.
  const auto text = read_toml(concat({"value = ", toml_string(typed)}), {});
  if (!text) return text.error();
  return text->front().value;
}

/// True for bare keys with dots between them. The limit keeps absurd input from making as many sections as it has dots.
bool is_path(std::string_view path) {
  constexpr std::size_t longest = 200;
  const std::size_t dot = path.find('.');
  if (path.size() > longest) return false;
  if (dot == std::string_view::npos) return is_bare_key(path);
  return is_bare_key(path.substr(0, dot)) && is_path(path.substr(dot + 1));
}

Error refusal(ErrorCode code, std::string_view key, std::string message) {
  return {.code = code, .parameter = std::string(key), .message = std::move(message), .place = {}};
}

/// `control.force_gain=3` as an entry, not yet compared with what the document holds.
Result<Entry> read_assignment(std::string_view assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos) {
    return refusal(ErrorCode::syntax, {}, "there is no = in it: write key=value, as in control.force_gain=3");
  }
  const std::string_view key = trimmed(assignment.substr(0, equals));
  if (!is_path(key)) {
    return refusal(ErrorCode::syntax, {},
                   concat({"\"", printable(key),
                           "\" is no key: write letters, digits and _, with a dot between a section and its key, as in "
                           "control.force_gain=3"}));
  }
  const std::string_view typed = trimmed(assignment.substr(equals + 1));
  Result<Value> value = value_from(typed);
  if (!value) return refusal(ErrorCode::syntax, key, value.error().message);
  if (std::holds_alternative<Table>(*value)) {
    return refusal(ErrorCode::wrong_type, key,
                   concat({"a section cannot be set at once: set each of its keys, as in ", key, ".some_key=3"}));
  }
  return Entry{.path = std::string(key),
               .value = *std::move(value),
               .key_position = {},
               .value_position = {},
               .assignment = std::string(assignment),
               .typed = std::string(typed),
               .file = {}};
}

}  // namespace

Result<Document> Document::load(const std::filesystem::path& file) {
  const Result<std::string> text = read_file(file);
  if (!text) return text.error();
  return parse(*text, file.string());
}

Result<Document> Document::parse(std::string_view text, std::string name) {
  Result<std::vector<Entry>> entries = read_toml(text, name);
  if (!entries) return entries.error();
  Document document;
  document.name_ = std::move(name);
  document.entries_ = *std::move(entries);
  return document;
}

Check Document::set(std::string_view assignment) {
  assignment = trimmed(assignment);
  const auto placed = [&](Error error) {
    error.place = concat({"--set ", printable(assignment)});
    return error;
  };
  const Result<Entry> fresh = read_assignment(assignment);
  if (!fresh) return placed(fresh.error());
  const std::string_view key = fresh->path;
  if (const Entry* present = find(key); present != nullptr && std::holds_alternative<Table>(present->value)) {
    return placed(refusal(ErrorCode::wrong_type, key,
                          concat({"this is a section: set one of its keys, as in ", key, ".some_key=3"})));
  }
  std::vector<Entry> missing_sections;
  for (std::string_view section = section_of(key); !section.empty(); section = section_of(section)) {
    const Entry* above = find(section);
    if (above == nullptr) {
      missing_sections.push_back(*fresh);
      missing_sections.back().path = section;
      missing_sections.back().value = Table{};
    } else if (!std::holds_alternative<Table>(above->value)) {
      return placed(refusal(ErrorCode::wrong_type, key, concat({section, " is a value, so no key can lie below it"})));
    }
  }
  std::erase_if(entries_, [&](const Entry& entry) { return entry.path == key; });
  entries_.insert(entries_.end(), missing_sections.rbegin(), missing_sections.rend());
  entries_.push_back(*fresh);
  return {};
}

Check Document::merge(const Document& other) {
  std::unordered_map<std::string_view, const Entry*> mine;
  for (const Entry& entry : entries_) mine.emplace(entry.path, &entry);
  std::unordered_set<std::string_view> replaced;
  std::vector<Entry> fresh;
  for (const Entry& entry : other.entries_) {
    const bool section = std::holds_alternative<Table>(entry.value);
    if (const auto present = mine.find(entry.path); present != mine.end()) {
      if (section != std::holds_alternative<Table>(present->second->value)) {
        Error problem = refusal(ErrorCode::wrong_type, entry.path,
                                concat({"this is a ", section ? "section here and a value" : "value here and a section",
                                        " in ", name_, ": write it alike in both"}));
        problem.place = other.place_of(entry, entry.key_position);
        return problem;
      }
      if (section) continue;
      replaced.insert(entry.path);
    }
    fresh.push_back(entry);
    if (entry.file.empty()) fresh.back().file = other.name_;
  }
  std::erase_if(entries_, [&](const Entry& entry) { return replaced.contains(entry.path); });
  entries_.insert(entries_.end(), fresh.begin(), fresh.end());
  return {};
}

Check Document::read(std::span<const Binding> bindings) const {
  std::unordered_map<std::string_view, const Binding*> known;
  for (const Binding& binding : bindings) known.emplace(binding.path, &binding);
  for (const Entry& entry : entries_) {
    const auto match = known.find(entry.path);
    if (match == known.end()) {
      Error problem = unknown_key(entry, bindings);
      problem.place = place_of(entry, entry.key_position);
      return problem;
    }
    if (Check problem = assign(entry, *match->second)) {
      problem->place = place_of(entry, entry.value_position);
      return problem;
    }
  }
  return {};
}

std::vector<std::string> Document::keys() const {
  std::vector<std::string> found;
  for (const Entry& entry : entries_) {
    if (!std::holds_alternative<Table>(entry.value)) found.push_back(entry.path);
  }
  return found;
}

Result<std::string> Document::text_at(std::string_view path) const {
  const Entry* entry = find(path);
  if (entry == nullptr) {
    const std::string_view section = section_of(path);
    return Error{.code = ErrorCode::missing,
                 .parameter = std::string(path),
                 .message = concat({"this key is needed: write ", key_of(path), " = \"...\"",
                                    section.empty() ? "" : concat({" under [", section, "]"})}),
                 .place = name_};
  }
  std::string text;
  const Binding binding{entry->path, units::none, any_finite, {}, &text};
  if (Check problem = assign(*entry, binding)) {
    problem->place = place_of(*entry, entry->value_position);
    return *std::move(problem);
  }
  return text;
}

Error Document::locate(Error error) const {
  if (!error.place.empty()) return error;
  error.place = name_;
  for (std::string_view path = error.parameter; !path.empty(); path = section_of(path)) {
    const Entry* entry = find(path);
    const bool itself = path.size() == error.parameter.size();
    // A section that only an override mentions says nothing about its other keys.
    if (entry == nullptr || (!itself && !entry->assignment.empty())) continue;
    error.place = place_of(*entry, itself ? entry->value_position : entry->key_position);
    break;
  }
  return error;
}

const Entry* Document::find(std::string_view path) const {
  const auto match = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.path == path; });
  return match == entries_.end() ? nullptr : &*match;
}

std::string Document::place_of(const Entry& entry, Position position) const {
  if (!entry.assignment.empty()) return concat({"--set ", printable(entry.assignment)});
  return (entry.file.empty() ? name_ : entry.file) + ":" + std::to_string(position.line) + ":" +
         std::to_string(position.column);
}

}  // namespace tactus::configuration
