#include <tactus/configuration/reference.hpp>
#include <tactus/configuration/text.hpp>
#include <tactus/configuration/toml_writer.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <variant>
#include <vector>

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

std::string row(const Binding& key) {
  return concat({"| `", key_of(key.path), "` | ", key.unit.symbol, " | ", admitted(key), " | `",
                 in_cell(toml_value(key)), "` | ", in_cell(key.doc), " |\n"});
}

/// A section as the page shows it: the names of its keys, and the text of each.
struct ShownSection {
  std::string_view path;
  std::string_view doc;
  std::vector<std::string_view> keys;
  std::vector<std::string> rows;
  bool operator==(const ShownSection&) const = default;

  [[nodiscard]] bool is_in(std::string_view root) const {
    return path == root || (path.starts_with(root) && path.substr(root.size()).starts_with('.'));
  }
  [[nodiscard]] bool has(const std::string& row) const {
    return std::find(rows.begin(), rows.end(), row) != rows.end();
  }
};

std::vector<ShownSection> shown(std::span<const Binding> bindings) {
  std::vector<ShownSection> all;
  for (const SectionView& section : sections(bindings)) {
    ShownSection& one = all.emplace_back(ShownSection{section.path, section.doc, {}, {}});
    for (const Binding* key : section.keys) {
      one.keys.push_back(key_of(key->path));
      one.rows.push_back(row(*key));
    }
  }
  return all;
}

std::vector<ShownSection> below(const std::vector<ShownSection>& all, std::string_view root) {
  std::vector<ShownSection> found;
  std::copy_if(all.begin(), all.end(), std::back_inserter(found), [&](const auto& one) { return one.is_in(root); });
  return found;
}

void add_word(std::string& list, std::string_view before, std::string_view word, std::string_view after) {
  list += concat({list.empty() ? "" : ", ", before, word, after});
}

/// The section with its table; keys that `other` has too are only named.
std::string text_of(const ShownSection& section, const ShownSection& other, std::string_view other_kind) {
  std::string text, table, there;
  if (!section.path.empty()) text += concat({"\n## `[", section.path, "]`\n"});
  if (!section.doc.empty()) text += concat({"\n", section.doc, "\n"});
  for (std::size_t i = 0; i < section.keys.size(); ++i) {
    if (other.has(section.rows[i])) {
      add_word(there, "`", section.keys[i], "`");
    } else {
      table += section.rows[i];
    }
  }
  if (!table.empty()) text += "\n| Key | Unit | Bounds | Default | Meaning |\n|---|---|---|---|---|\n" + table;
  if (!there.empty()) text += concat({"\nAs in [`", other_kind, "`](", other_kind, ".md): ", there, ".\n"});
  return text;
}

}  // namespace

std::string reference_markdown(std::span<const Binding> bindings, std::string_view title, const OtherPage& other) {
  const std::vector<ShownSection> own = shown(bindings), others = shown(other.bindings);
  std::string tables, equal_roots;
  std::string_view equal_root;
  for (const ShownSection& section : own) {
    if (!equal_root.empty() && section.is_in(equal_root)) continue;
    if (!section.path.empty() && below(own, section.path) == below(others, section.path)) {
      equal_root = section.path;
      add_word(equal_roots, "`[", equal_root, "]`");
      continue;
    }
    const auto same =
        std::find_if(others.begin(), others.end(), [&](const auto& one) { return one.path == section.path; });
    const bool nothing_new = same != others.end() && std::all_of(section.rows.begin(), section.rows.end(),
                                                                 [&](const auto& text) { return same->has(text); });
    if (!section.path.empty() && nothing_new && !section.rows.empty()) {
      add_word(equal_roots, "the keys of `[", section.path, "]` itself");
      continue;
    }
    tables += text_of(section, same != others.end() ? *same : ShownSection{}, other.kind);
  }
  std::string page = concat({"# ", title, "\n"});
  if (!equal_roots.empty()) {
    page += concat({"\nAs in [`", other.kind, "`](", other.kind, ".md), with the same defaults: ", equal_roots, ".\n"});
  }
  return page + tables;
}

}  // namespace tactus::configuration
