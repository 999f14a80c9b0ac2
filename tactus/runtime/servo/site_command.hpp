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
  tare,      ///< releases the dead-man switch, arms where that was not done, and identifies what gravity lacks
  set        ///< changes the force gain: `set force_gain 2`
};
constexpr auto enumerators(SiteWord) {
  return std::array{Enumerator{SiteWord::arm, "arm"},           Enumerator{SiteWord::press, "press"},
                    Enumerator{SiteWord::release, "release"},   Enumerator{SiteWord::clutch, "clutch"},
                    Enumerator{SiteWord::unclutch, "unclutch"}, Enumerator{SiteWord::stop, "stop"},
                    Enumerator{SiteWord::clear, "clear"},       Enumerator{SiteWord::start, "start"},
                    Enumerator{SiteWord::keep, "keep"},         Enumerator{SiteWord::discard, "discard"},
                    Enumerator{SiteWord::tare, "tare"},         Enumerator{SiteWord::set, "set"}};
}

/// Who asks.
enum class RequestSource {
  operator_input,  ///< the operator: standard input, or the program that started the site
  page,            ///< a viewer of the live page
  node             ///< a ROS 2 node
};
constexpr auto enumerators(RequestSource) {
  return std::array{Enumerator{RequestSource::operator_input, "operator"}, Enumerator{RequestSource::page, "page"},
                    Enumerator{RequestSource::node, "node"}};
}

/// A request to a running site.
struct SiteCommand {
  // Implicit: most words are complete by themselves.
  constexpr SiteCommand(SiteWord word_ = SiteWord::arm, double value_ = 0.0,
                        RequestSource source_ = RequestSource::operator_input)
      : word(word_), value(value_), source(source_) {}
  friend constexpr bool operator==(const SiteCommand&, const SiteCommand&) = default;

  SiteWord word;
  double value;  ///< of `set`: the force gain
  RequestSource source;
};

/// What can be set at the sites of a run while they run.
struct Settable {
  std::optional<double> most_force_gain = {};  ///< largest force gain; nullopt if it cannot change
  double file_force_gain = 0.0;                ///< with which they start
  bool tares = false;                          ///< whether they know the word `tare`
};

/// A line that was typed or sent, spaces around it left out. At the slave only `stop`, `clear` and `tare` have a
/// meaning: all else is asked at the master. Pages and nodes may set the force gain, ask for a tare and mark episodes;
/// the rest is the operator's, who sees the arms. Errors: `syntax`, naming the words that there are; `out_of_bounds`
/// for a gain beyond what is allowed, with both; `inconsistent` for what these sites cannot do.
Result<SiteCommand> parse_site_command(std::string_view line, control::SiteRole role, const Settable& settable = {},
                                       RequestSource source = RequestSource::operator_input);

}  // namespace tactus::runtime
