// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/binding.hpp>

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::configuration {

/// The value of a binding as TOML: `3950.0`, `true`, `"off"`. Empty for a section.
std::string toml_value(const Binding& binding);

/// One section and the keys that lie directly in it, in the order of their description.
struct SectionView {
  std::string_view path;  ///< empty for the top of the document
  std::string_view doc;
  std::vector<const Binding*> keys;
};

/// The sections of a configuration, the top of the document first, each path once.
std::vector<SectionView> sections(std::span<const Binding> bindings);

/// The whole configuration as TOML text, every key written. It reads back equal, doubles bit for bit, provided that
/// the values lie within their bounds and the texts are UTF-8.
std::string to_toml(std::span<const Binding> bindings);

template <Described T>
std::string to_toml(const T& params) {
  T copy = params;
  return to_toml(bind(copy));
}

}  // namespace tactus::configuration
