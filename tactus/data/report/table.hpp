// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tactus::report {

/// A column of a table: what is in it, in which unit, and how its cells line up (numbers: right).
struct Column {
  enum class Align { left, right };
  std::string title;
  std::string unit = {};
  Align align = Align::right;
};

/// A table for a user: text for a terminal, or HTML for a page. Cells are text; `number` makes it from numbers.
/// Whatever a caption, title or cell holds stays inert: no escape sequence reaches the terminal, no tag the page.
class Table {
 public:
  explicit Table(std::vector<Column> columns, std::string caption = {});

  /// Appends a row, cells in the order of the columns. Missing cells are empty; a cell too many gets an untitled
  /// column, so that nothing given is lost.
  void add_row(std::vector<std::string> cells);

  [[nodiscard]] const std::string& caption() const { return caption_; }

  /// Lines of UTF-8 for a terminal, each ended by a line feed and free of trailing blanks: the caption (if any),
  /// titles, a line of units (if any column has one), the rows between rules. No line is wider than `text_width()`,
  /// and no column is left out: titles and texts are broken into lines, and where that is not enough the rows are
  /// alongside one another, in several tables if need be. Only a number or a word that is wider itself sticks out.
  [[nodiscard]] std::string to_text() const;

  /// A `<table>` with caption and scopes; the first column heads its rows.
  [[nodiscard]] std::string to_html() const;

 private:
  std::vector<Column> columns_;
  std::string caption_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace tactus::report
