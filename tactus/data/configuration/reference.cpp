// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/reference.hpp>
#include <tactus/data/configuration/text.hpp>
#include <tactus/data/configuration/toml_writer.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <iterator>
#include <string>
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

bool alike(const SectionView& a, const SectionView& b) {
  return std::equal(a.keys.begin(), a.keys.end(), b.keys.begin(), b.keys.end(), [](const Binding* x, const Binding* y) {
    return key_of(x->path) == key_of(y->path) && x->unit.symbol == y->unit.symbol && admitted(*x) == admitted(*y) &&
           x->doc == y->doc;
  });
}

/// How many sections from the first on are numbered, as `joint_1`, `joint_2`, and differ in defaults alone; 1 at least.
std::size_t numbered_alike(std::span<const SectionView> all) {
  const std::string_view path = all.front().path;
  if (!path.ends_with("_1")) return 1;
  const std::string_view stem = path.substr(0, path.size() - 1);
  std::size_t count = 1;
  while (count < all.size() && all[count].path == concat({stem, std::to_string(count + 1)}) &&
         alike(all[count], all.front())) {
    ++count;
  }
  return count;
}

/// Of a key of each of `sections`: one default, or that of each.
std::string defaults(std::span<const SectionView> sections, std::size_t key) {
  std::vector<std::string> values;
  for (const SectionView& section : sections) values.push_back(in_cell(toml_value(*section.keys[key])));
  if (std::adjacent_find(values.begin(), values.end(), std::not_equal_to<>()) == values.end()) values.resize(1);
  std::string text;
  for (const std::string& value : values) text += concat({text.empty() ? "`" : ", `", value, "`"});
  return text;
}

/// A section as the page shows it, or several that differ in their number alone: the names of its keys, and the text
/// of each.
struct ShownSection {
  std::string_view path;
  std::string_view last_path;  ///< of several
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
  const std::vector<SectionView> each = sections(bindings);
  for (std::span<const SectionView> left = each; !left.empty();) {
    const std::size_t count = numbered_alike(left);
    const std::span<const SectionView> same = left.first(count);
    const SectionView& first = left.front();
    ShownSection& one =
        all.emplace_back(ShownSection{first.path, count > 1 ? same.back().path : "", first.doc, {}, {}});
    for (std::size_t i = 0; i < first.keys.size(); ++i) {
      const Binding& key = *first.keys[i];
      one.keys.push_back(key_of(key.path));
      one.rows.push_back(concat({"| `", key_of(key.path), "` | ", key.unit.symbol, " | ", admitted(key), " | ",
                                 defaults(same, i), " | ", in_cell(key.doc), " |\n"}));
    }
    left = left.subspan(count);
  }
  return all;
}

std::vector<ShownSection> below(const std::vector<ShownSection>& all, std::string_view root) {
  std::vector<ShownSection> found;
  std::copy_if(all.begin(), all.end(), std::back_inserter(found), [&](const auto& one) { return one.is_in(root); });
  return found;
}

bool same_below(std::span<const ShownSection> a, std::string_view a_root, std::span<const ShownSection> b,
                std::string_view b_root) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](const ShownSection& x, const ShownSection& y) {
    const bool roots = x.path == a_root && y.path == b_root;
    return x.path.substr(a_root.size()) == y.path.substr(b_root.size()) && x.rows == y.rows &&
           (roots || x.doc == y.doc);
  });
}

/// Of the sections in `before`, the first whose keys, and those of all below it, are those of `section`.
const ShownSection* equal_one(const std::vector<const ShownSection*>& before, const std::vector<ShownSection>& all,
                              const ShownSection& section) {
  const std::vector<ShownSection> own = below(all, section.path);
  if (std::all_of(own.begin(), own.end(), [](const ShownSection& one) { return one.rows.empty(); })) return nullptr;
  for (const ShownSection* one : before) {
    if (!section.is_in(one->path) && same_below(below(all, one->path), one->path, own, section.path)) return one;
  }
  return nullptr;
}

void add_word(std::string& list, std::string_view before, std::string_view word, std::string_view after) {
  list += concat({list.empty() ? "" : ", ", before, word, after});
}

std::string heading(const ShownSection& section) {
  std::string text;
  if (!section.path.empty()) text += concat({"\n## `[", section.path, "]`"});
  if (!section.last_path.empty()) text += concat({" to `", key_of(section.last_path), "`"});
  if (!section.path.empty()) text += "\n";
  if (section.doc.empty()) return text;
  text += "\n";
  if (!section.last_path.empty()) text += concat({"`", key_of(section.path), "`: "});
  return text + concat({section.doc, "\n"});
}

/// The section with its table; keys that `other` has too are only named.
std::string text_of(const ShownSection& section, const ShownSection& other, std::string_view other_kind) {
  std::string text = heading(section), table, there;
  for (std::size_t i = 0; i < section.keys.size(); ++i) {
    if (other.has(section.rows[i])) {
      add_word(there, "`", section.keys[i], "`");
    } else {
      table += section.rows[i];
    }
  }
  if (!table.empty()) text += "\n| Key | Unit | Bounds | Default | Meaning |\n|---|---|---|---|---|\n" + table;
  if (!there.empty()) text += concat({"\nSame as in [`", other_kind, "`](", other_kind, ".md): ", there, ".\n"});
  return text;
}

}  // namespace

std::string reference_markdown(std::span<const Binding> bindings, std::string_view title, const OtherPage& other) {
  const std::vector<ShownSection> own = shown(bindings), others = shown(other.bindings);
  std::string tables, equal_roots;
  std::string_view equal_root;  // whose sections are not shown again
  std::vector<const ShownSection*> before;
  for (const ShownSection& section : own) {
    if (!equal_root.empty() && section.is_in(equal_root)) continue;
    if (!section.path.empty() && below(own, section.path) == below(others, section.path)) {
      equal_root = section.path;
      add_word(equal_roots, "`[", equal_root, "]`");
      continue;
    }
    if (section.last_path.empty() && !section.path.empty()) {
      if (const ShownSection* equal = equal_one(before, own, section)) {
        equal_root = section.path;
        tables += concat({heading(section), "\nKeys and defaults of `[", equal->path, "]`.\n"});
        continue;
      }
      before.push_back(&section);
    }
    const auto same =
        std::find_if(others.begin(), others.end(), [&](const auto& one) { return one.path == section.path; });
    const bool nothing_new = same != others.end() && std::all_of(section.rows.begin(), section.rows.end(),
                                                                 [&](const auto& text) { return same->has(text); });
    if (!section.path.empty() && nothing_new && !section.rows.empty()) {
      add_word(equal_roots, "the keys directly under `[", section.path, "]`");
      continue;
    }
    tables += text_of(section, same != others.end() ? *same : ShownSection{}, other.kind);
  }
  std::string page = concat({"# ", title, "\n"});
  if (!equal_roots.empty()) {
    page += concat(
        {"\nSame as in [`", other.kind, "`](", other.kind, ".md), with the same defaults: ", equal_roots, ".\n"});
    if (!own.front().rows.empty()) page += "\n## Keys at the top of the file\n";
  }
  return page + tables;
}

}  // namespace tactus::configuration
