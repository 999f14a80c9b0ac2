// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/binding.hpp>

#include <span>
#include <string>
#include <string_view>

namespace tactus::configuration {

/// A JSON Schema (draft 2020-12) of the configuration, for editors that complete and check TOML files. The values that
/// the bindings point to are the defaults; a description ends with the unit.
///
/// It admits what `Document::read` admits, except that to JSON Schema `3.0` is a whole number and to `read` it is not.
std::string json_schema(std::span<const Binding> bindings, std::string_view title);

template <Described T>
std::string json_schema(std::string_view title) {
  T defaults{};
  return json_schema(bind(defaults), title);
}

}  // namespace tactus::configuration
