// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/heat_map.hpp>
#include <tactus/data/report/table.hpp>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactus::report {

/// A report as one HTML file that needs nothing alongside itself: no network, no other file, and a content security
/// policy that forbids both. Parts appear in the order in which they are added. It follows the light or dark scheme of
/// the reader, fits a phone (wide figures and tables scroll in place, and show it) and prints; a script lets a click or
/// Enter enlarge a figure, and without the script all else works. Every text given is shown literally, never read as
/// markup.
class Page {
 public:
  explicit Page(std::string title) : title_(std::move(title)) {}

  /// Level 2 (a section) to 6; others are taken as the nearest. Level 1 is the title of the page.
  void heading(std::string_view text, int level = 2);
  void paragraph(std::string_view text);
  void table(const Table& table);
  /// The figure, numbered, with its title and caption below.
  void figure(const Figure& figure);
  /// The map, numbered among the figures, with its title and this caption below.
  void figure(const HeatMap& map, std::string_view caption);
  /// A command or a file, line by line as it is; `label` states what it is.
  void code(std::string_view text, std::string_view label = {});
  /// The same, folded: a reader who wants it opens it.
  void folded(std::string_view text, std::string_view label);
  /// Terms and what they stand for: settings, results in a few words.
  void definitions(const std::vector<std::pair<std::string, std::string>>& entries);
  /// The last line of the page: what made it, and the command that makes it again.
  void footer(std::string_view text, std::string_view command = {});

  /// The document. Equal calls give equal bytes.
  [[nodiscard]] std::string to_html() const;

 private:
  void add_picture(const Drawing& drawing, std::string_view title, std::string_view caption);

  std::string title_;
  std::string body_;
  std::string footer_;
  int figures_ = 0;
};

}  // namespace tactus::report
