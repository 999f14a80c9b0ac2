// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include <nlohmann/json.hpp>

namespace tactus::cli {

/// JSON Schema as far as ours use it: type, enum, properties, required, additionalProperties, items, anyOf, $ref.
class SchemaValidator {
 public:
  explicit SchemaValidator(const nlohmann::json& schema) : schema_(schema) {}
  /// What is wrong, a line each.
  [[nodiscard]] std::string faults(const nlohmann::json& value) const { return check(value, schema_, "$"); }

 private:
  static bool is_of(const nlohmann::json& value, const std::string& type) {
    if (type == "integer") return value.is_number() && std::floor(value.get<double>()) == value.get<double>();
    if (type == "number") return value.is_number();
    return type == value.type_name();
  }

  [[nodiscard]] std::string check(const nlohmann::json& value, const nlohmann::json& schema,
                                  const std::string& at) const {
    if (const auto ref = schema.find("$ref"); ref != schema.end()) {
      const std::string name = ref->get<std::string>().substr(std::string("#/$defs/").size());
      return check(value, schema_.at("$defs").at(name), at);
    }
    if (const auto any = schema.find("anyOf"); any != schema.end()) {
      std::string all;
      for (const nlohmann::json& one : *any) {
        const std::string faults = check(value, one, at);
        if (faults.empty()) return "";
        all += "  " + faults;
      }
      return at + ": none of\n" + all;
    }
    if (const auto type = schema.find("type"); type != schema.end()) {
      const nlohmann::json types = type->is_array() ? *type : nlohmann::json::array({*type});
      if (std::none_of(types.begin(), types.end(), [&](const nlohmann::json& one) { return is_of(value, one); })) {
        return at + ": is " + value.type_name() + " and not " + types.dump() + "\n";
      }
    }
    if (const auto words = schema.find("enum"); words != schema.end()) {
      if (std::find(words->begin(), words->end(), value) == words->end()) return at + ": " + value.dump() + "\n";
    }
    std::string all;
    if (value.is_array() && schema.contains("items")) {
      for (std::size_t i = 0; i < value.size(); ++i) {
        all += check(value[i], schema["items"], at + "[" + std::to_string(i) + "]");
      }
    }
    if (!value.is_object()) return all;
    for (const nlohmann::json& name : schema.value("required", nlohmann::json::array())) {
      if (!value.contains(name.get<std::string>())) all += at + ": has no " + name.dump() + "\n";
    }
    const nlohmann::json known = schema.value("properties", nlohmann::json::object()),
                         others = schema.value("additionalProperties", nlohmann::json(true));
    for (const auto& [name, member] : value.items()) {
      const std::string below = at + "." + name;
      if (known.contains(name)) {
        all += check(member, known[name], below);
      } else if (others.is_object()) {
        all += check(member, others, below);
      } else if (!others.get<bool>()) {
        all += below + ": is not in the schema\n";
      }
    }
    return all;
  }

  nlohmann::json schema_;
};

}  // namespace tactus::cli
