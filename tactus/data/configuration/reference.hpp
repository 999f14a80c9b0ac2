// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/binding.hpp>

#include <span>
#include <string>
#include <string_view>

namespace tactus::configuration {

/// Another page, whose keys a page need not repeat.
struct OtherPage {
  std::string_view kind;  ///< it is next to the page, as `kind`.md
  std::span<const Binding> bindings;
};

/// A page of Markdown: per section one table of its keys with unit, bounds, default and meaning. The values that the
/// bindings point to are the defaults. Sections that are numbered and differ in defaults alone, as those of joints,
/// share a table, and a section with the keys and defaults of an earlier one, all below them too, refers to it. Keys
/// that `other` shows with equal words, bounds and default are left to it.
std::string reference_markdown(std::span<const Binding> bindings, std::string_view title, const OtherPage& other = {});

template <Described T>
std::string reference_markdown(std::string_view title) {
  T defaults{};
  return reference_markdown(bind(defaults), title);
}

/// The page of `T`, where it differs from that of `Other`, which is `kind`.md.
template <Described T, Described Other>
std::string reference_beside(std::string_view title, std::string_view kind) {
  T defaults{};
  Other others{};
  const auto bindings = bind(others);
  return reference_markdown(bind(defaults), title, {.kind = kind, .bindings = bindings});
}

}  // namespace tactus::configuration
