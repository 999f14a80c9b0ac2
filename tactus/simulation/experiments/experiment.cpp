// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/experiment.hpp>

#include <algorithm>
#include <utility>

namespace tactus::experiments {

namespace {

constexpr std::size_t most_combinations = 100'000;

Error bad_variation(std::string_view text, const std::string& why) {
  return {.code = ErrorCode::syntax,
          .parameter = {},
          .message = why + ": write key=value,value,..., for instance control.force_gain=1,3,5",
          .place = "--vary " + std::string(text)};
}

}  // namespace

Result<Variation> parse_variation(std::string_view text) {
  const auto equals = text.find('=');
  if (equals == std::string_view::npos) return bad_variation(text, "there is no '='");
  if (equals == 0) return bad_variation(text, "there is no key before '='");
  Variation variation{.key = std::string(text.substr(0, equals)), .values = {}};
  std::string_view rest = text.substr(equals + 1);
  for (bool more = true; more;) {
    const auto comma = rest.find(',');
    more = comma != std::string_view::npos;
    const std::string_view value = rest.substr(0, comma);
    if (value.empty()) return bad_variation(text, "a value is empty");
    variation.values.emplace_back(value);
    if (more) rest.remove_prefix(comma + 1);
  }
  return variation;
}

Result<std::vector<Settings>> combinations(const std::vector<Variation>& variations) {
  std::vector<Settings> all{{}};
  for (const Variation& variation : variations) {
    const auto same_key = [&](const Variation& other) { return other.key == variation.key; };
    if (std::count_if(variations.begin(), variations.end(), same_key) > 1) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = variation.key,
                   .message = "is varied twice: give all its values in one --vary",
                   .place = "--vary"};
    }
    if (all.size() * variation.values.size() > most_combinations) {
      return Error{.code = ErrorCode::inconsistent,
                   .parameter = variation.key,
                   .message = "more than " + std::to_string(most_combinations) + " combinations: vary fewer values",
                   .place = "--vary"};
    }
    std::vector<Settings> longer;
    for (const Settings& settings : all) {
      for (const std::string& value : variation.values) {
        longer.push_back(settings);
        longer.back().emplace_back(variation.key, value);
      }
    }
    all = std::move(longer);
  }
  return all;
}

Error blame_variation(Error error, const Settings& settings) {
  constexpr std::string_view set = "--set ";
  for (const auto& setting : settings) {
    if (error.place.starts_with(std::string(set) + setting.first + "=")) {
      error.place.replace(0, set.size(), "--vary ");
      break;
    }
  }
  return error;
}

Error locate_in(const Request& request, const Settings& settings, const Error& error) {
  configuration::Document document = request.document;
  for (const auto& [key, value] : settings) (void)document.set(key + "=" + value);  // they were set before
  return blame_variation(document.locate(error), settings);
}

Check refuse_variations(const Request& request, std::string message) {
  if (request.variations.empty()) return std::nullopt;
  return Error{.code = ErrorCode::inconsistent,
               .parameter = request.variations.front().key,
               .message = std::move(message),
               .place = "--vary"};
}

}  // namespace tactus::experiments
