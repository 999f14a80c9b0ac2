// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/spelling.hpp>

#include <algorithm>
#include <utility>
#include <vector>

namespace tactus {

namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool same(char a, char b) { return lower(a) == lower(b); }

}  // namespace

std::size_t slips(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before_last, last);
    std::swap(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (same(a[i - 1], b[j - 1]) ? 0 : 1);
      row[j] = std::min({replaced, last[j] + 1, row[j - 1] + 1});
      const bool swapped = i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[b.size()];
}

std::size_t most_slips(std::string_view word) {
  return word.size() < 3 ? 0 : std::max<std::size_t>(1, word.size() / 3);
}

std::optional<std::size_t> slips_up_to(std::size_t most, std::string_view a, std::string_view b) {
  const std::size_t difference = a.size() > b.size() ? a.size() - b.size() : b.size() - a.size();
  if (difference > most) return {};
  const std::size_t count = slips(a, b);
  return count <= most ? std::optional(count) : std::nullopt;
}

std::string_view nearest_word(std::string_view given, std::span<const std::string_view> words) {
  std::string_view nearest;
  std::size_t fewest = 0;
  for (const std::string_view word : words) {
    const auto count = slips_up_to(most_slips(word), given, word);
    if (!count || (!nearest.empty() && *count >= fewest)) continue;
    nearest = word;
    fewest = *count;
  }
  return nearest;
}

}  // namespace tactus
