// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/real_between.hpp>

#include <cstdlib>
#include <sstream>
#include <string>

#include <CLI/CLI.hpp>

namespace tactus::cli {

CLI::Validator real_between(double low, double high) {
  std::ostringstream range;
  range << '[' << low << " - " << high << ']';
  const auto check = [low, high, words = range.str()](const std::string& text) -> std::string {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (end != text.c_str() && *end == '\0' && value >= low && value <= high) return {};
    return "'" + text + "' is not a number in " + words;
  };
  return {check, "FLOAT in " + range.str(), {}};
}

}  // namespace tactus::cli
