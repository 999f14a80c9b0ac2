// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/names.hpp>
#include <tactus/data/recording/unit_words.hpp>
#include <tactus/kernel/core/spelling.hpp>
#include <tactus/kernel/core/units.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <iterator>

namespace tactus::recording {
namespace {

std::string describe_entry(const Entry& entry) {
  if (entry.kind == "column") return in_quotes(entry.name) + (entry.unit.empty() ? "" : " in " + entry.unit);
  return in_quotes(entry.name) + " (" + std::to_string(entry.rows) + " x " + std::to_string(entry.columns) + " " +
         entry.kind + ")";
}

/// Suffixes that others write for the units of this project.
struct Suffix {
  std::string_view text;
  const char* unit;
};
constexpr std::array foreign_suffixes{
    Suffix{"_Nm", "N m"},     Suffix{"_mNm", "mN m"},       Suffix{"_rad_s", "rad/s"}, Suffix{"_deg_s", "deg/s"},
    Suffix{"_mm_s", "mm/s"},  Suffix{"_rad_s2", "rad/s^2"}, Suffix{"_m_s2", "m/s^2"},  Suffix{"_deg_per_s", "deg/s"},
    Suffix{"_cm", "cm"},      Suffix{"_um", "um"},          Suffix{"_sec", "s"},       Suffix{"_secs", "s"},
    Suffix{"_seconds", "s"},  Suffix{"_msec", "ms"},        Suffix{"_usec", "us"},     Suffix{"_nsec", "ns"},
    Suffix{"_nanosec", "ns"}, Suffix{"_degrees", "deg"},    Suffix{"_radians", "rad"}, Suffix{"_meters", "m"},
    Suffix{"_metres", "m"},   Suffix{"_newtons", "N"},      Suffix{"_amps", "A"},      Suffix{"_volts", "V"}};

/// The name and the unit that its suffix tells.
NameAndUnit split_suffix(std::string_view head) {
  const auto without = [head](std::size_t length) { return std::string(head.substr(0, head.size() - length)); };
  for (const Suffix& suffix : foreign_suffixes) {
    if (head.size() > suffix.text.size() && head.ends_with(suffix.text))
      return {without(suffix.text.size()), suffix.unit};
  }
  constexpr std::string_view speed = "_m_s";
  if (head.size() > speed.size() && head.ends_with(speed) && unit_fits_name(without(speed.size()), "m/s") &&
      !unit_fits_name(without(speed.size()), "m")) {
    return {without(speed.size()), "m/s"};
  }
  const Unit unit = unit_at_end_of(head);
  const std::string_view suffix = unit.suffix;
  constexpr std::size_t of_one_letter = 2;
  if (suffix.size() == of_one_letter && !unit_fits_name(without(suffix.size()), unit.symbol)) {
    return {std::string(head), {}};
  }
  return {without(suffix.size()), unit.symbol};
}

/// Does a text in brackets, which is no known unit, belong to the name: an index, or a word that describes?
bool belongs_to_name(std::string_view inside, bool attached) {
  constexpr std::size_t longest_unit = 10, longest_attached_unit = 4;
  constexpr std::array describing{"raw",       "filtered", "measured", "actual",  "desired", "command",
                                  "commanded", "target",   "master",   "slave",   "leader",  "follower",
                                  "left",      "right",    "hand",     "tip",     "est",     "estimated",
                                  "filt",      "meas",     "ref",      "smoothed"};
  return inside.empty() || inside.size() > (attached ? longest_attached_unit : longest_unit) ||
         inside.find_first_of("0123456789_ ,:") != std::string_view::npos ||
         std::find(describing.begin(), describing.end(), inside) != describing.end();
}

/// Does a name end as those of masters and slaves do?
bool names_site(std::string_view head) { return head.size() > 2 && (head.ends_with("_m") || head.ends_with("_s")); }

}  // namespace

std::string in_quotes(std::string_view text) {
  std::string result;
  result += '\'';
  result += text;
  result += '\'';
  return result;
}

std::string significant(double value, int digits) {
  constexpr double longest = 1e9;
  std::array<char, 64> text{};
  auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, digits).ptr;
  const bool whole = std::abs(value) < longest && std::abs(value) >= std::pow(10.0, digits);
  if (whole) end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, 0).ptr;
  return {text.data(), end};
}

std::string_view trim(std::string_view text) {
  constexpr std::string_view blanks = " \t\r";
  const std::size_t first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

NameAndUnit split_unit(std::string_view head) {
  head = trim(head);
  for (const auto& [open, close] : {std::pair{'[', ']'}, std::pair{'(', ')'}}) {
    const std::size_t start = head.rfind(open);
    if (start == std::string_view::npos || start == 0 || !head.ends_with(close)) continue;
    const std::string_view inside = trim(head.substr(start + 1, head.size() - start - 2));
    const std::string_view before = trim(head.substr(0, start));
    if (inside == "-" || inside == "–") return {std::string(before), {}};
    if (std::string unit = unit_of(inside); !unit.empty()) return {std::string(before), std::move(unit)};
    // As our own exports write a unit, whatever it is.
    constexpr std::size_t longest_word = 10;
    const bool of_export = open == '[' && before.size() != start && inside.size() > longest_word;
    if (of_export || !belongs_to_name(inside, open == '[' && before.size() == start)) {
      return {std::string(before), std::string(inside)};
    }
    NameAndUnit stem = split_suffix(before);
    stem.name += head.substr(before.size());
    return stem;
  }
  return split_suffix(head);
}

std::vector<NameAndUnit> split_units(std::span<const std::string> heads) {
  std::vector<NameAndUnit> all;
  std::transform(heads.begin(), heads.end(), std::back_inserter(all), split_unit);
  const auto has = [&](const std::string& head) { return std::find(heads.begin(), heads.end(), head) != heads.end(); };
  const bool sites = std::any_of(heads.begin(), heads.end(), [](const std::string& head) {
    const std::string_view name = trim(head);
    return names_site(name) && split_unit(name).name == name;
  });
  constexpr std::size_t longest_symbol = 2;
  for (std::size_t i = 0; i < heads.size(); ++i) {
    const std::string_view head = trim(heads[i]);
    if (!names_site(head) || all[i].name == head) continue;
    const std::string stem(head.substr(0, head.size() - 2));
    const bool pair = has(stem + "_m") && has(stem + "_s");
    const bool symbol_beside_sites = sites && stem.size() <= longest_symbol && all[i].unit == "m";
    if (pair || symbol_beside_sites) all[i] = {std::string(head), {}};
  }
  return all;
}

std::string nearest(std::string_view name, std::span<const Entry> candidates) {
  std::vector<std::string_view> names;
  for (const Entry& candidate : candidates) {
    if (candidate.readable) names.emplace_back(candidate.name);
  }
  return std::string(nearest_word(name, names));
}

std::string enumerate_signals(std::span<const Entry> entries) {
  constexpr std::size_t shown = 12;
  std::string text;
  std::size_t signals = 0;
  for (const Entry& entry : entries) {
    if (!entry.readable || ++signals > shown) continue;
    text += (text.empty() ? "" : ", ") + describe_entry(entry);
  }
  if (signals > shown) text += " and " + std::to_string(signals - shown) + " more";
  return text.empty() ? "no signals" : text;
}

Error no_such_variable(std::string_view name, const std::filesystem::path& file, std::span<const Entry> entries) {
  const std::string guess = nearest(name, entries);
  return {.code = ErrorCode::missing,
          .parameter = {},
          .message = in_quotes(file.string()) + " has no '" + std::string(name) + "'" +
                     (guess.empty() ? "" : " (did you mean '" + guess + "'?)") +
                     "; it has: " + enumerate_signals(entries),
          .place = {}};
}

}  // namespace tactus::recording
