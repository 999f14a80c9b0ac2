// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/text.hpp>
#include <tactus/data/configuration/toml_writer.hpp>

#include <algorithm>
#include <variant>

namespace tactus::configuration {

std::string toml_value(const Binding& binding) {
  if (const auto* number = std::get_if<double*>(&binding.target)) return toml_float(**number);
  if (const auto* whole = std::get_if<std::int64_t*>(&binding.target)) return std::to_string(**whole);
  if (const auto* flag = std::get_if<bool*>(&binding.target)) return **flag ? "true" : "false";
  if (const auto* text = std::get_if<std::string*>(&binding.target)) return toml_string(**text);
  if (const auto* choice = std::get_if<Choice>(&binding.target)) return toml_string(choice->word_of(choice->member));
  return {};
}

std::vector<SectionView> sections(std::span<const Binding> bindings) {
  std::vector<SectionView> all{{}};
  const auto find = [&](std::string_view path) {
    return std::find_if(all.begin(), all.end(), [&](const SectionView& section) { return section.path == path; });
  };
  for (const Binding& binding : bindings) {
    if (binding.is_section()) {
      if (find(binding.path) == all.end()) all.push_back({binding.path, binding.doc, {}});
    } else {
      find(section_of(binding.path))->keys.push_back(&binding);
    }
  }
  return all;
}

std::string to_toml(std::span<const Binding> bindings) {
  std::string text;
  for (const SectionView& section : sections(bindings)) {
    if (section.keys.empty()) continue;
    if (!section.path.empty()) text += concat({text.empty() ? "[" : "\n[", section.path, "]\n"});
    for (const Binding* key : section.keys) {
      text += concat({key_of(key->path), " = ", toml_value(*key), "\n"});
    }
  }
  return text;
}

}  // namespace tactus::configuration
