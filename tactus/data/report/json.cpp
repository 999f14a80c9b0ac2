// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>

#include <nlohmann/json.hpp>

namespace tactus::report {

template <class Json>
std::string json_text(const Json& document) {
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

template <class Json>
std::string json_line(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

template <class Json>
Json parse_json(std::string_view text) {
  return Json::parse(text, nullptr, false);
}

template std::string json_text(const nlohmann::ordered_json&);
template std::string json_line(const nlohmann::ordered_json&);
template nlohmann::ordered_json parse_json(std::string_view);

}  // namespace tactus::report
