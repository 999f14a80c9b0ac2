// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/runtime/servo/site_command.hpp>

#include <array>
#include <optional>

namespace tactus::runtime {

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

/// The hands of a simulated operator on the buttons of a site: turns words into what is pressed, tick by tick. A site
/// aligns by itself at the second tick. The dead-man switch is taken as pressed while the site is armed or active,
/// until the word `release`; after each arming it is pressed again. Real-time safe.
class SiteButtons {
 public:
  /// Whether a word can be taken: a button that was pushed is released for a tick first.
  [[nodiscard]] bool ready() const noexcept { return !pushed_; }
  /// For the next `step`; `state` is that of the site. A word that marks an episode presses nothing. A tare that a page
  /// or a node asks for arms nothing, and waits until the operator does.
  void take(const SiteCommand& command, control::SiteState state) noexcept;
  void take(SiteWord word) noexcept { take(SiteCommand(word), control::SiteState::configure); }
  /// Nobody is there any more: the dead-man switch stays released, whatever is taken.
  void lose_person() noexcept { lost_ = true; }
  /// What is pressed at this tick; `state` is that after the tick before.
  control::SiteRequests step(control::SiteState state) noexcept;

 private:
  control::SiteRequests next_{.dead_man = true};  ///< its dead-man switch: whether the operator means to press it
  bool begun_ = false;
  bool aligned_ = false;
  bool pushed_ = false;
  bool tares_anew_ = false;
  bool lost_ = false;
};

}  // namespace tactus::runtime
