// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/json_writer.hpp>
#include <tactus/data/configuration/toml_reader.hpp>

#include <cmath>
#include <type_traits>
#include <variant>

#include <nlohmann/json.hpp>

namespace tactus::configuration {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const Value& value) {
  return std::visit(
      [](const auto& held) -> Json {
        using Held = std::remove_cvref_t<decltype(held)>;
        if constexpr (std::is_same_v<Held, Table>) {
          return Json::object();
        } else if constexpr (std::is_same_v<Held, Foreign>) {
          return held.kind;
        } else if constexpr (std::is_same_v<Held, double>) {
          if (std::isnan(held)) return "nan";
          if (std::isinf(held)) return held > 0.0 ? "inf" : "-inf";
          return held;
        } else {
          return held;
        }
      },
      value);
}

}  // namespace

Result<std::string> json_of_toml(std::string_view toml) {
  const auto entries = read_toml(toml, {});
  if (!entries) return entries.error();
  Json document = Json::object();
  for (const Entry& entry : *entries) {
    Json* at = &document;
    std::string_view path = entry.path;
    for (std::size_t dot = path.find('.'); dot != std::string_view::npos; dot = path.find('.')) {
      at = &(*at)[std::string(path.substr(0, dot))];
      path.remove_prefix(dot + 1);
    }
    Json& member = (*at)[std::string(path)];
    if (member.is_null()) member = json_of(entry.value);  // a section that was begun further up stays
  }
  return document.dump();
}

}  // namespace tactus::configuration
