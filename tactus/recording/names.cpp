#include <tactus/core/units.hpp>
#include <tactus/recording/names.hpp>

#include <algorithm>
#include <array>
#include <numeric>

namespace tactus::recording {
namespace {

/// The suffixes that mean a unit. Where one ends another (`_N_m` and `_m`), the longer stands first.
constexpr std::array suffixes{units::newton_second_per_metre,
                              units::newton_per_second,
                              units::newton_per_metre5,
                              units::newton_per_metre,
                              units::metre_per_second,
                              units::second_per_metre,
                              Unit{"m/s^2", "_m_per_s2"},
                              Unit{"rad/s^2", "_rad_per_s2"},
                              Unit{"rad/s", "_rad_per_s"},
                              Unit{"mm/s", "_mm_per_s"},
                              units::per_second,
                              Unit{"N m", "_N_m"},
                              units::second,
                              Unit{"ms", "_ms"},
                              Unit{"us", "_us"},
                              Unit{"ns", "_ns"},
                              units::hertz,
                              units::metre,
                              Unit{"mm", "_mm"},
                              Unit{"rad", "_rad"},
                              Unit{"deg", "_deg"},
                              units::newton,
                              Unit{"kN", "_kN"},
                              Unit{"mN", "_mN"},
                              units::kilogram,
                              Unit{"A", "_A"},
                              Unit{"mA", "_mA"},
                              Unit{"V", "_V"},
                              Unit{"Pa", "_Pa"},
                              Unit{"bar", "_bar"}};

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({substituted, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row[b.size()];
}

std::string describe_entry(const Entry& entry) {
  if (entry.kind == "column") return in_quotes(entry.name) + (entry.unit.empty() ? "" : " in " + entry.unit);
  return in_quotes(entry.name) + " (" + std::to_string(entry.rows) + " x " + std::to_string(entry.columns) + " " +
         entry.kind + ")";
}

}  // namespace

std::string in_quotes(std::string_view text) {
  std::string result;
  result += '\'';
  result += text;
  result += '\'';
  return result;
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
    return {std::string(trim(head.substr(0, start))),
            std::string(trim(head.substr(start + 1, head.size() - start - 2)))};
  }
  for (const Unit& unit : suffixes) {
    const std::string_view suffix = unit.suffix;
    if (head.size() > suffix.size() && head.ends_with(suffix)) {
      return {std::string(head.substr(0, head.size() - suffix.size())), unit.symbol};
    }
  }
  return {std::string(head), ""};
}

std::string nearest(std::string_view name, std::span<const Entry> candidates) {
  std::string best;
  std::size_t best_distance = name.size() / 2 + 1;
  for (const Entry& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate.name);
    if (candidate.readable && distance < best_distance) {
      best = candidate.name;
      best_distance = distance;
    }
  }
  return best;
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
