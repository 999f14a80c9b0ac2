// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/binding.hpp>

#include <algorithm>
#include <utility>

namespace tactus {

std::string join(std::string_view section, std::string_view key) {
  std::string path(section);
  if (!section.empty() && !key.empty()) path += '.';
  return path.append(key);
}

std::string_view section_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? std::string_view{} : path.substr(0, dot);
}

std::string_view key_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? path : path.substr(dot + 1);
}

namespace detail {

namespace {

template <class Target>
void append_key(std::vector<Binding>& bindings, std::string_view section, const Key& key, Target target) {
  bindings.push_back({join(section, key.name), key.unit, key.bounds, key.doc, std::move(target)});
}

}  // namespace

void append(std::vector<Binding>& bindings, std::string_view section, const Key& key, double* target) {
  append_key(bindings, section, key, target);
}
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key, std::int64_t* target) {
  append_key(bindings, section, key, target);
}
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key, bool* target) {
  append_key(bindings, section, key, target);
}
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key, std::string* target) {
  append_key(bindings, section, key, target);
}
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key, Choice target) {
  append_key(bindings, section, key, std::move(target));
}
void append(std::vector<Binding>& bindings, std::string_view section, const Key& key) {
  append_key(bindings, section, key, Section{});
}

std::vector<Binding> sections_down_to(std::string_view section, const char* doc) {
  std::vector<Binding> bindings;
  for (std::size_t end = 0; end < section.size(); ++end) {
    end = std::min(section.find('.', end), section.size());
    bindings.push_back(
        {std::string(section.substr(0, end)), units::none, any_finite, end == section.size() ? doc : "", Section{}});
  }
  return bindings;
}

}  // namespace detail

}  // namespace tactus
