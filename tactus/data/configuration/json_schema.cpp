// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/json_schema.hpp>
#include <tactus/data/configuration/text.hpp>

#include <cmath>
#include <variant>

#include <nlohmann/json.hpp>

namespace tactus::configuration {

namespace {

using Json = nlohmann::ordered_json;

/// Whole limits of whole numbers are written without a point.
Json limit(double value, bool whole) {
  constexpr double exact = 9007199254740992.0;  // 2^53
  if (whole && std::abs(value) <= exact && std::trunc(value) == value) return static_cast<std::int64_t>(value);
  return value;
}

void add_bounds(Json& schema, const Bounds& bounds, bool whole) {
  if (std::isfinite(bounds.lower)) {
    schema[bounds.lower_open ? "exclusiveMinimum" : "minimum"] = limit(bounds.lower, whole);
  }
  if (std::isfinite(bounds.upper)) schema["maximum"] = limit(bounds.upper, whole);
}

Json schema_of(const Binding& binding) {
  Json schema;
  if (const auto* number = std::get_if<double*>(&binding.target)) {
    schema["type"] = "number";
    add_bounds(schema, binding.bounds, false);
    schema["default"] = **number;
  } else if (const auto* whole = std::get_if<std::int64_t*>(&binding.target)) {
    schema["type"] = "integer";
    add_bounds(schema, binding.bounds, true);
    schema["default"] = **whole;
  } else if (const auto* flag = std::get_if<bool*>(&binding.target)) {
    schema["type"] = "boolean";
    schema["default"] = **flag;
  } else if (const auto* text = std::get_if<std::string*>(&binding.target)) {
    schema["type"] = "string";
    schema["default"] = **text;
  } else if (const auto* choice = std::get_if<Choice>(&binding.target)) {
    schema["type"] = "string";
    schema["enum"] = choice->words;
    schema["default"] = choice->word_of(choice->member);
  } else {
    schema["type"] = "object";
    schema["properties"] = Json::object();
    schema["additionalProperties"] = false;
  }
  const std::string unit = binding.unit.symbol[0] == '\0' ? "" : concat({" [", binding.unit.symbol, "]"});
  if (!binding.doc.empty() || !unit.empty()) schema["description"] = binding.doc + unit;
  return schema;
}

}  // namespace

std::string json_schema(std::span<const Binding> bindings, std::string_view title) {
  Json root;
  root["$schema"] = "https://json-schema.org/draft/2020-12/schema";
  root["title"] = title;
  root["type"] = "object";
  root["properties"] = Json::object();
  root["additionalProperties"] = false;
  for (const Binding& binding : bindings) {
    Json* section = &root;
    std::string_view rest = binding.path;
    for (std::size_t dot = rest.find('.'); dot != std::string_view::npos; dot = rest.find('.')) {
      section = &(*section)["properties"][std::string(rest.substr(0, dot))];
      rest.remove_prefix(dot + 1);
    }
    Json& properties = (*section)["properties"];
    if (!properties.contains(rest)) properties[std::string(rest)] = schema_of(binding);
  }
  return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace tactus::configuration
