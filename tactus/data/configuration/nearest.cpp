// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/nearest.hpp>
#include <tactus/kernel/core/spelling.hpp>

#include <algorithm>
#include <utility>

namespace tactus::configuration {

namespace {

std::string_view without_unit(std::string_view key, const Unit& unit) {
  const std::string_view suffix = unit.suffix;
  return key.size() > suffix.size() && key.ends_with(suffix) ? key.substr(0, key.size() - suffix.size()) : key;
}

}  // namespace

std::string_view nearest_path(std::string_view given, bool is_section, std::span<const Binding> bindings) {
  const std::string_view given_key = key_of(given);
  std::string_view nearest;
  // Of two keys of the same name, the one whose whole path is nearer.
  std::pair<std::size_t, std::size_t> fewest;
  for (const Binding& binding : bindings) {
    if (binding.is_section() != is_section) continue;
    const std::string_view key = key_of(binding.path);
    const std::string_view bare = without_unit(key, binding.unit);
    const std::size_t most = most_slips(bare);
    auto count = slips_up_to(most, given_key, key);
    for (const auto& other : {slips_up_to(most, given, binding.path), slips_up_to(0, given_key, bare)}) {
      if (other && (!count || *other < *count)) count = other;
    }
    if (!count) continue;
    const std::pair rank(*count, slips(given, binding.path));
    if (!nearest.empty() && rank >= fewest) continue;
    nearest = binding.path;
    fewest = rank;
  }
  return nearest;
}

}  // namespace tactus::configuration
