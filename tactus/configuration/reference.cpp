#include <tactus/configuration/reference.hpp>
#include <tactus/configuration/text.hpp>
#include <tactus/configuration/toml_writer.hpp>

#include <cmath>
#include <variant>

namespace tactus::configuration {

namespace {

std::string in_cell(std::string_view text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|') cell += '\\';
    cell += c == '\n' ? ' ' : c;
  }
  return cell;
}

std::string admitted(const Binding& binding) {
  if (const auto* choice = std::get_if<Choice>(&binding.target)) {
    std::string words;
    for (const std::string_view word : choice->words) words += concat({words.empty() ? "`" : ", `", word, "`"});
    return words;
  }
  if (std::holds_alternative<bool*>(binding.target)) return "`true`, `false`";
  if (std::holds_alternative<std::string*>(binding.target)) return "text";
  const Bounds& bounds = binding.bounds;
  std::string text = std::holds_alternative<std::int64_t*>(binding.target) ? "whole" : "";
  const auto add = [&](std::string_view part) { text += concat({text.empty() ? "" : ", ", part}); };
  if (std::isfinite(bounds.lower)) add(concat({bounds.lower_open ? "> " : "≥ ", format_number(bounds.lower)}));
  if (std::isfinite(bounds.upper)) add(concat({"≤ ", format_number(bounds.upper)}));
  return text.empty() ? "any" : text;
}

}  // namespace

std::string reference_markdown(std::span<const Binding> bindings, std::string_view title) {
  std::string page = concat({"# ", title, "\n"});
  for (const SectionView& section : sections(bindings)) {
    if (!section.path.empty()) page += concat({"\n## `[", section.path, "]`\n"});
    if (!section.doc.empty()) page += concat({"\n", section.doc, "\n"});
    if (section.keys.empty()) continue;
    page += "\n| Key | Unit | Bounds | Default | Meaning |\n|---|---|---|---|---|\n";
    for (const Binding* key : section.keys) {
      page += concat({"| `", key_of(key->path), "` | ", key->unit.symbol, " | ", admitted(*key), " | `",
                      in_cell(toml_value(*key)), "` | ", in_cell(key->doc), " |\n"});
    }
  }
  return page;
}

}  // namespace tactus::configuration
