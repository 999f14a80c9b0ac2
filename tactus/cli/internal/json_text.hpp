#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace tactus::cli {

/// A document as it is printed. Names in it may come from anywhere: what is not UTF-8 is replaced.
inline std::string json_text(const nlohmann::ordered_json& document) {
  return document.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace tactus::cli
