#include <tactus/core/spelling.hpp>
#include <tactus/core/units.hpp>
#include <tactus/recording/names.hpp>

namespace tactus::recording {
namespace {

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
  const Unit unit = unit_at_end_of(head);
  head.remove_suffix(std::string_view(unit.suffix).size());
  return {std::string(head), unit.symbol};
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
