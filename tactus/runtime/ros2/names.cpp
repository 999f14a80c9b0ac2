// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/ros2/names.hpp>

#include <algorithm>
#include <charconv>
#include <cstdlib>

namespace tactus::ros2 {

namespace {

/// 7400 + 250 × domain is the first port of a domain (OMG DDSI-RTPS 2.3 §9.6.1).
constexpr std::uint32_t last_domain = 232;
constexpr std::size_t longest_namespace = 128;

constexpr bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

Error refused(ErrorCode code, const char* variable, const char* value, const char* remedy) {
  return {.code = code,
          .parameter = {},
          .message = "the value `" + std::string(value).substr(0, 40) + "` " + remedy,
          .place = variable};
}

Result<std::uint32_t> domain_of(const char* text) {
  if (text == nullptr || *text == '\0') return std::uint32_t{0};
  const std::string_view digits = text;
  std::uint32_t domain = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), domain);
  if (code == std::errc::invalid_argument || end != digits.data() + digits.size()) {
    return refused(ErrorCode::syntax, "ROS_DOMAIN_ID", text, "is no whole number: set one from 0 to 232");
  }
  if (code != std::errc() || domain > last_domain) {
    return refused(ErrorCode::out_of_bounds, "ROS_DOMAIN_ID", text, "is out of bounds: set a number from 0 to 232");
  }
  return domain;
}

bool is_word(std::string_view word) {
  return !word.empty() && is_letter(word.front()) && word.find("__") == std::string_view::npos &&
         std::all_of(word.begin(), word.end(), [](char c) { return is_letter(c) || is_digit(c); });
}

}  // namespace

Environment environment() {
  // Nothing here sets variables.
  const auto variable = [](const char* name) { return std::getenv(name); };  // NOLINT(concurrency-mt-unsafe)
  return {.domain_id = variable("ROS_DOMAIN_ID"),
          .localhost_only = variable("ROS_LOCALHOST_ONLY"),
          .discovery_range = variable("ROS_AUTOMATIC_DISCOVERY_RANGE"),
          .configuration = variable("CYCLONEDDS_URI")};
}

Result<Network> network_of(const Environment& variables) {
  const auto domain = domain_of(variables.domain_id);
  if (!domain) return domain.error();
  Network network{.domain = *domain};
  if (variables.configuration != nullptr) network.configuration = variables.configuration;
  if (const char* const text = variables.localhost_only; text != nullptr && *text != '\0') {
    const std::string_view value = text;
    if (value != "0" && value != "1") {
      return refused(ErrorCode::syntax, "ROS_LOCALHOST_ONLY", text, "is neither 0 nor 1: set one of them");
    }
    network.loopback_only = value == "1";
  }
  if (const char* const text = variables.discovery_range; text != nullptr && *text != '\0') {
    const std::string_view value = text;
    if (value != "SUBNET" && value != "LOCALHOST") {
      return refused(ErrorCode::syntax, "ROS_AUTOMATIC_DISCOVERY_RANGE", text,
                     "is neither SUBNET nor LOCALHOST, and tactus knows no other: set one of them");
    }
    network.loopback_only = network.loopback_only || value == "LOCALHOST";
  }
  return network;
}

Check check_namespace(std::string_view name_space) {
  const auto no = [&](const char* why) {
    return Error{.code = ErrorCode::syntax,
                 .parameter = {},
                 .message = "the name `" + std::string(name_space.substr(0, 40)) + "` is no namespace of ROS 2: " + why,
                 .place = {}};
  };
  if (name_space.size() > longest_namespace) return no("write at most 128 characters");
  for (std::string_view rest = name_space;;) {
    const std::size_t end = rest.find('/');
    if (!is_word(rest.substr(0, end))) {
      return no(
          "write words of letters, digits and single underscores that begin with no digit, `/` between them, as in "
          "lab/left");
    }
    if (end == std::string_view::npos) return std::nullopt;
    rest.remove_prefix(end + 1);
  }
}

std::string dds_topic(std::string_view name_space, std::string_view topic) {
  return "rt/" + std::string(name_space) + "/" + std::string(topic);
}

}  // namespace tactus::ros2
