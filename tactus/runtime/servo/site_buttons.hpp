// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/core/result.hpp>

#include <array>
#include <optional>
#include <string_view>

namespace tactus::runtime {

/// What the operator may type at a running site.
enum class SiteWord {
  arm,       ///< arms both sites and takes the dead-man switch in hand; an empty line does the same
  press,     ///< takes the dead-man switch in hand again
  release,   ///< releases it
  clutch,    ///< from now on the hand moves and the slave does not
  unclutch,  ///< from now on the slave follows again
  stop,      ///< emergency stop of this site: no force, until `clear`
  clear,     ///< leaves a fault
  start,     ///< starts an episode of the log here
  keep,      ///< ends the episode that runs
  discard,   ///< ends it, or takes the last one, and discards it
};
constexpr auto enumerators(SiteWord) {
  return std::array{Enumerator{SiteWord::arm, "arm"},           Enumerator{SiteWord::press, "press"},
                    Enumerator{SiteWord::release, "release"},   Enumerator{SiteWord::clutch, "clutch"},
                    Enumerator{SiteWord::unclutch, "unclutch"}, Enumerator{SiteWord::stop, "stop"},
                    Enumerator{SiteWord::clear, "clear"},       Enumerator{SiteWord::start, "start"},
                    Enumerator{SiteWord::keep, "keep"},         Enumerator{SiteWord::discard, "discard"}};
}

/// What an operator marks in the log.
enum class EpisodeMark { start, keep, discard };
constexpr auto enumerators(EpisodeMark) {
  return std::array{Enumerator{EpisodeMark::start, "start"}, Enumerator{EpisodeMark::keep, "keep"},
                    Enumerator{EpisodeMark::discard, "discard"}};
}

/// The mark that a word makes; none for a word that presses a button.
constexpr std::optional<EpisodeMark> mark_of(SiteWord word) noexcept {
  switch (word) {
    case SiteWord::start:
      return EpisodeMark::start;
    case SiteWord::keep:
      return EpisodeMark::keep;
    case SiteWord::discard:
      return EpisodeMark::discard;
    default:
      return std::nullopt;
  }
}

/// A line that was typed, spaces around it left out. At the slave only `stop` and `clear` have a meaning: all else is
/// asked at the master. Errors: `syntax`, naming the words that there are.
Result<SiteWord> parse_site_word(std::string_view line, control::SiteRole role);

/// The hands of a simulated operator on the buttons of a site: turns words into what is pressed, tick by tick. A site
/// aligns by itself at the second tick. The dead-man switch is taken as pressed while the site is armed or active,
/// until the word `release`; after each arming it is pressed again. Real-time safe.
class SiteButtons {
 public:
  /// Whether a word can be taken: a button that was pushed is released for a tick first.
  [[nodiscard]] bool ready() const noexcept { return !pushed_; }
  /// For the next `step`. A word that marks an episode presses nothing.
  void take(SiteWord word) noexcept;
  /// Nobody is there any more: the dead-man switch stays released, whatever is taken.
  void lose_person() noexcept { lost_ = true; }
  /// What is pressed at this tick; `state` is that after the tick before.
  control::SiteRequests step(control::SiteState state) noexcept;

 private:
  control::SiteRequests next_{.dead_man = true};  ///< its dead-man switch: whether the operator means to press it
  bool begun_ = false;
  bool aligned_ = false;
  bool pushed_ = false;
  bool lost_ = false;
};

}  // namespace tactus::runtime
