// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/runtime/servo/site_command.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <string>

namespace tactus::runtime {

namespace {

constexpr std::string_view spaces = " \t\r";

/// The first word of a line, and what follows it.
std::string_view take_word(std::string_view& line) {
  const std::size_t begin = std::min(line.find_first_not_of(spaces), line.size());
  const std::size_t end = std::min(line.find_first_of(spaces, begin), line.size());
  const std::string_view word = line.substr(begin, end - begin);
  line.remove_prefix(std::min(line.find_first_not_of(spaces, end), line.size()));
  return word;
}

Error refused(ErrorCode code, const char* parameter, std::string message) {
  return {.code = code, .parameter = parameter, .message = std::move(message), .place = {}};
}

bool takes(SiteWord word, control::SiteRole role, RequestSource source) {
  const bool of_slave = word == SiteWord::stop || word == SiteWord::clear || word == SiteWord::tare;
  const bool of_all = word == SiteWord::set || word == SiteWord::tare || word == SiteWord::start ||
                      word == SiteWord::keep || word == SiteWord::discard;
  return (role == control::SiteRole::master || of_slave) && (source == RequestSource::operator_input || of_all);
}

Result<double> parse_force_gain(std::string_view rest, const Settable& settable) {
  const std::string usage = "write for instance: set force_gain " +
                            (settable.most_force_gain ? rounded_number(*settable.most_force_gain) : "1");
  const std::string_view key = take_word(rest);
  if (key.empty()) return refused(ErrorCode::syntax, "", "set needs a key and a number: " + usage);
  if (key != "force_gain") {
    return refused(ErrorCode::syntax, "",
                   "'" + report::printable(key.substr(0, 40)) + "' cannot be set while a site runs: " + usage);
  }
  const std::string_view written = rest, number = take_word(rest);
  double gain = 0.0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), gain);
  if (error != std::errc{} || end != number.data() + number.size() || !std::isfinite(gain) || !rest.empty()) {
    return refused(ErrorCode::syntax, "force_gain",
                   "'" + report::printable(written.substr(0, 40)) + "' is not one finite number: " + usage);
  }
  if (!settable.most_force_gain) {
    return refused(ErrorCode::inconsistent, "force_gain",
                   "cannot change while these sites run: their method has no force gain or counts energy by it, or "
                   "this is not the leader's site");
  }
  if (gain >= 0.0 && gain <= *settable.most_force_gain) return gain;
  return refused(ErrorCode::out_of_bounds, "force_gain",
                 rounded_number(gain) + " is refused: it may be 0 to " + rounded_number(*settable.most_force_gain) +
                     (*settable.most_force_gain > settable.file_force_gain
                          ? ", the key force_gain.limit of its supervision"
                          : ", the gain with which this run started; a larger one needs the key force_gain.limit of "
                            "its supervision"));
}

}  // namespace

Result<SiteCommand> parse_site_command(std::string_view line, control::SiteRole role, const Settable& settable,
                                       RequestSource source) {
  const bool master = role == control::SiteRole::master;
  const bool by_operator = source == RequestSource::operator_input;
  std::string_view rest = line;
  const std::string_view first = take_word(rest);
  if (master && by_operator && first.empty()) return SiteCommand(SiteWord::arm);
  std::string known;
  for (const auto& [word, name] : enumerators(SiteWord{})) {
    if (!takes(word, role, source)) continue;
    if (first == name && word == SiteWord::set) {
      const auto gain = parse_force_gain(rest, settable);
      if (!gain) return gain.error();
      return SiteCommand(word, *gain, source);
    }
    if (first == name && rest.empty()) {
      if (word != SiteWord::tare || settable.tares) return SiteCommand(word, 0.0, source);
      return refused(
          ErrorCode::inconsistent, "tare",
          "it corrects the gravity compensation of two arms, and this experiment is not of the kind arm-tapping");
    }
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  line.remove_prefix(std::min(line.find_first_not_of(spaces), line.size()));
  Error error = refused(ErrorCode::syntax, "",
                        "'" + report::printable(line.substr(0, 40)) + "' is no word for the " + name_of(role) +
                            ": type one of " + known + (master ? "" : "; the rest is typed at the master"));
  if (by_operator) {
    error.place = "standard input";
  } else {
    error.message += "; all others are typed at the console";
  }
  return error;
}

}  // namespace tactus::runtime
