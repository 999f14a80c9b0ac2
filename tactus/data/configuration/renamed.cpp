// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/renamed.hpp>

#include <algorithm>
#include <array>
#include <string_view>

namespace tactus::configuration {

namespace {

struct Renamed {
  std::string_view before, now;
};
/// Every key that was renamed and that files of users may have.
constexpr std::array renamed{Renamed{"patience_s", "reply_timeout_s"}};

}  // namespace

std::string_view new_name_of(std::string_view key) {
  const auto found =
      std::find_if(renamed.begin(), renamed.end(), [key](const Renamed& each) { return each.before == key; });
  return found == renamed.end() ? std::string_view{} : found->now;
}

}  // namespace tactus::configuration
