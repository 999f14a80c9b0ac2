// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/runtime/servo/site_buttons.hpp>

#include <algorithm>
#include <cstddef>
#include <string>

namespace tactus::runtime {

Result<SiteWord> parse_site_word(std::string_view line, control::SiteRole role) {
  constexpr std::string_view spaces = " \t\r";
  const std::size_t begin = std::min(line.find_first_not_of(spaces), line.size());
  const std::string_view word = line.substr(begin, line.find_last_not_of(spaces) + 1 - begin);
  const bool master = role == control::SiteRole::master;
  if (master && word.empty()) return SiteWord::arm;
  std::string known;
  for (const auto& [value, name] : enumerators(SiteWord{})) {
    if (!master && value != SiteWord::stop && value != SiteWord::clear) continue;
    if (word == name) return value;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  return Error{.code = ErrorCode::syntax,
               .parameter = {},
               .message = "'" + report::printable(word.substr(0, 40)) + "' is no word for the " + name_of(role) +
                          ": type one of " + known + (master ? "" : "; the rest is typed at the master"),
               .place = "standard input"};
}

void SiteButtons::take(SiteWord word) noexcept {
  switch (word) {
    case SiteWord::arm:
      next_.arm = next_.dead_man = true;
      break;
    case SiteWord::press:
      next_.dead_man = true;
      break;
    case SiteWord::release:
      next_.dead_man = false;
      break;
    case SiteWord::clutch:
      next_.clutch = true;
      break;
    case SiteWord::unclutch:
      next_.clutch = false;
      break;
    case SiteWord::stop:
      next_.emergency_stop = true;
      break;
    case SiteWord::clear:
      next_.emergency_stop = false;
      next_.clear = true;
      break;
    case SiteWord::start:
    case SiteWord::keep:
    case SiteWord::discard:
      break;
  }
}

control::SiteRequests SiteButtons::step(control::SiteState state) noexcept {
  using control::SiteState;
  control::SiteRequests pressed = next_;
  // What is pressed at the very first tick is not heard.
  pressed.align = begun_ && !aligned_;
  aligned_ = begun_;
  begun_ = true;
  // Let go where the site is armed anew, so that it is pressed after arming.
  const bool follows = state == SiteState::active || (state == SiteState::armed && !pressed.arm);
  pressed.dead_man = next_.dead_man && follows && !lost_;
  pushed_ = pressed.arm || pressed.clear;
  next_.arm = next_.clear = false;
  return pressed;
}

}  // namespace tactus::runtime
