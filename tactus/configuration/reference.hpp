#pragma once

#include <tactus/configuration/binding.hpp>

#include <span>
#include <string>
#include <string_view>

namespace tactus::configuration {

/// A page of Markdown: per section one table of its keys with unit, bounds, default and meaning. The values that the
/// bindings point to are the defaults.
std::string reference_markdown(std::span<const Binding> bindings, std::string_view title);

template <Described T>
std::string reference_markdown(std::string_view title) {
  T defaults{};
  return reference_markdown(bind(defaults), title);
}

}  // namespace tactus::configuration
