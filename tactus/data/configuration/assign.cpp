// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/assign.hpp>
#include <tactus/data/configuration/nearest.hpp>
#include <tactus/data/configuration/renamed.hpp>
#include <tactus/data/configuration/text.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/kernel/core/spelling.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

namespace tactus::configuration {

namespace {

template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

/// `"heavy" is a text`, `3.5 is a decimal number`, `this is a section`.
std::string describe_value(const Value& value) {
  return std::visit(Overloaded{[](Table) -> std::string { return "this is a section"; },
                               [](bool b) -> std::string { return b ? "true is a boolean" : "false is a boolean"; },
                               [](std::int64_t i) { return std::to_string(i) + " is a whole number"; },
                               [](double d) { return toml_float(d) + " is a decimal number"; },
                               [](const std::string& text) {
                                 return concat({"\"", printable(text), "\" is a text"});
                               },
                               [](Foreign other) {
                                 return concat({"this is ", other.kind});
                               }},
                    value);
}

/// The value alone; empty for a section, an array and the like.
std::string written_value(const Value& value) {
  return std::visit(
      Overloaded{[](Table) -> std::string { return {}; }, [](bool b) -> std::string { return b ? "true" : "false"; },
                 [](std::int64_t i) { return std::to_string(i); }, [](double d) { return toml_float(d); },
                 [](const std::string& text) { return printable(text); }, [](Foreign) -> std::string { return {}; }},
      value);
}

std::string list_of(std::span<const std::string_view> words) {
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) list += i + 1 == words.size() ? " or " : ", ";
    list += concat({"\"", words[i], "\""});
  }
  return list;
}

std::string describe_wanted(const Binding& binding) {
  const std::string_view symbol = binding.unit.symbol;
  return std::visit(Overloaded{[](Section) -> std::string { return "a section"; },
                               [&](const double*) {
                                 return concat({"a number", symbol.empty() ? "" : " in ", symbol});
                               },
                               [](const std::int64_t*) -> std::string { return "a whole number"; },
                               [](const bool*) -> std::string { return "true or false"; },
                               [](const std::string*) -> std::string { return "a text in quotes"; },
                               [](const Choice& choice) { return list_of(choice.words); }},
                    binding.target);
}

Error wrong_type(const Entry& entry, const Binding& binding) {
  const bool bounded = std::isfinite(binding.bounds.lower) || std::isfinite(binding.bounds.upper);
  const std::string remedy = binding.is_section()
                                 ? concat({"write [", binding.path, "] with its keys below it"})
                                 : concat({"write for instance ", key_of(binding.path), " = ", toml_value(binding)});
  return {.code = ErrorCode::wrong_type,
          .parameter = binding.path,
          .message = concat({describe_value(entry.value), ", but ", describe_wanted(binding), " is asked for",
                             bounded ? ", and it " : "",
                             bounded ? describe_bounds(binding.bounds, binding.unit) : std::string(), ": ", remedy}),
          .place = {},
          .value = written_value(entry.value),
          .bounds = bounded ? describe_bounds(binding.bounds, binding.unit) : std::string()};
}

/// What a text parameter gets: the text, or whatever was typed in an override, where quotes are the shell's.
const std::string* text_of(const Entry& entry) {
  if (const auto* text = std::get_if<std::string>(&entry.value)) return text;
  return entry.assignment.empty() ? nullptr : &entry.typed;
}

Check assign_number(const Entry& entry, const Binding& binding, double& target) {
  const auto* whole = std::get_if<std::int64_t>(&entry.value);
  const auto* decimal = std::get_if<double>(&entry.value);
  if (whole == nullptr && decimal == nullptr) return wrong_type(entry, binding);
  const double number = whole != nullptr ? static_cast<double>(*whole) : *decimal;
  if (!binding.bounds.contain(number)) return out_of_bounds(binding.path, number, binding.bounds, binding.unit);
  target = number;
  return {};
}

Check assign_whole(const Entry& entry, const Binding& binding, std::int64_t& target) {
  const auto* whole = std::get_if<std::int64_t>(&entry.value);
  if (whole == nullptr) return wrong_type(entry, binding);
  const auto number = static_cast<double>(*whole);
  if (!binding.bounds.contain(number)) return out_of_bounds(binding.path, number, binding.bounds, binding.unit);
  target = *whole;
  return {};
}

Check assign_choice(const Entry& entry, const Binding& binding, const Choice& choice) {
  const std::string* word = text_of(entry);
  if (word == nullptr) return wrong_type(entry, binding);
  const auto match = std::find(choice.words.begin(), choice.words.end(), *word);
  if (match == choice.words.end()) {
    const std::string_view meant = nearest_word(*word, choice.words);
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = binding.path,
                 .message = concat({"\"", printable(*word), "\" is no choice here: it must be ", list_of(choice.words),
                                    meant.empty() ? "" : concat({"; did you mean \"", meant, "\"?"})}),
                 .place = {},
                 .value = printable(*word),
                 .bounds = concat({"must be ", list_of(choice.words)})};
  }
  choice.assign(choice.member, static_cast<std::size_t>(match - choice.words.begin()));
  return {};
}

template <class T>
Check assign_as_is(const T* written, const Entry& entry, const Binding& binding, T& target) {
  if (written == nullptr) return wrong_type(entry, binding);
  target = *written;
  return {};
}

/// `a`, `b` and `c` of a section, cut where the list gets long.
std::string keys_of(std::string_view section, std::span<const Binding> bindings) {
  constexpr std::size_t most = 12;
  std::string list;
  std::size_t count = 0;
  for (const Binding& binding : bindings) {
    if (section_of(binding.path) != section) continue;
    if (++count > most) return list + ", ...";
    list += concat({list.empty() ? "" : ", ", key_of(binding.path)});
  }
  return list;
}

}  // namespace

Check assign(const Entry& entry, const Binding& binding) {
  return std::visit(
      Overloaded{
          [&](Section) { return std::holds_alternative<Table>(entry.value) ? Check{} : wrong_type(entry, binding); },
          [&](double* target) { return assign_number(entry, binding, *target); },
          [&](std::int64_t* target) { return assign_whole(entry, binding, *target); },
          [&](bool* target) { return assign_as_is(std::get_if<bool>(&entry.value), entry, binding, *target); },
          [&](std::string* target) { return assign_as_is(text_of(entry), entry, binding, *target); },
          [&](const Choice& choice) { return assign_choice(entry, binding, choice); }},
      binding.target);
}

Error unknown_key(const Entry& entry, std::span<const Binding> bindings) {
  const bool is_section = std::holds_alternative<Table>(entry.value);
  const std::string_view section = section_of(entry.path);
  std::string message = is_section ? "unknown section" : "unknown key";
  const std::string_view renamed = new_name_of(key_of(entry.path));
  const bool is_renamed =
      !renamed.empty() && std::any_of(bindings.begin(), bindings.end(), [&](const Binding& binding) {
        return section_of(binding.path) == section && key_of(binding.path) == renamed;
      });
  const std::string_view meant = nearest_path(entry.path, is_section, bindings);
  if (is_renamed) {
    message = concat({"this key is now called ", renamed});
  } else if (!meant.empty()) {
    const bool same_section = section_of(meant) == section;
    message += concat({": did you mean ", same_section ? key_of(meant) : meant, "?"});
  } else if (const std::string keys = keys_of(section, bindings); !keys.empty()) {
    message += concat({": ", section.empty() ? "the file" : concat({"[", section, "]"}), " can have ", keys});
  } else {
    message += ": remove it";
  }
  return {.code = ErrorCode::unknown_key, .parameter = printable(entry.path), .message = message, .place = {}};
}

}  // namespace tactus::configuration
