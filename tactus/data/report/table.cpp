// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <utility>

namespace tactus::report {
namespace {

using Align = Column::Align;

using Cells = std::vector<std::string>;

constexpr std::size_t between = 2;
constexpr std::size_t any_width = std::numeric_limits<std::size_t>::max();

/// The text in lines of at most `width`, broken at blanks; a word that is longer has a line of its own.
std::vector<std::string> wrapped(const std::string& text, std::size_t width) {
  if (display_width(text) <= width) return {text};
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(' ', at), text.size());
    const std::string word = text.substr(at, end - at);
    at = end + 1;
    if (word.empty()) continue;
    if (!lines.back().empty() && display_width(lines.back()) + 1 + display_width(word) > width) lines.emplace_back();
    lines.back() += (lines.back().empty() ? "" : " ") + word;
  }
  return lines;
}

/// The width of the widest word.
std::size_t narrowest(const std::string& text) {
  std::size_t width = 0;
  for (const std::string& word : wrapped(text, 0)) width = std::max(width, display_width(word));
  return width;
}

/// What a column shows: title, unit, cells. A title and a text may be broken into lines, a number may not.
struct Lane {
  std::string title, unit;
  Cells cells;
  Align align;
  std::size_t least = 0, width = 0;
};

std::vector<Lane> lanes_of(const std::vector<Column>& columns, std::span<const Cells> rows) {
  std::vector<Lane> lanes;
  for (std::size_t c = 0; c < columns.size(); ++c) {
    Lane lane{.title = printable(columns[c].title),
              .unit = printable(columns[c].unit),
              .cells = {},
              .align = columns[c].align};
    lane.least = std::max(narrowest(lane.title), display_width(lane.unit));
    lane.width = std::max(display_width(lane.title), display_width(lane.unit));
    for (const Cells& row : rows) {
      const std::string& shown = lane.cells.emplace_back(c < row.size() ? printable(row[c]) : std::string());
      const std::size_t whole = display_width(shown);
      lane.least = std::max(lane.least, lane.align == Align::left ? narrowest(shown) : whole);
      lane.width = std::max(lane.width, whole);
    }
    lanes.push_back(std::move(lane));
  }
  return lanes;
}

std::size_t sum(const std::vector<Lane>& lanes, std::size_t Lane::*width) {
  std::size_t all = lanes.empty() ? 0 : between * (lanes.size() - 1);
  for (const Lane& lane : lanes) all += lane.*width;
  return all;
}

/// Makes the widest of the lanes that can give way narrower until all fit.
bool squeeze(std::vector<Lane>& lanes, std::size_t width) {
  if (sum(lanes, &Lane::least) > width) return false;
  for (std::size_t all = sum(lanes, &Lane::width); all > width; --all) {
    Lane* give = nullptr;
    for (Lane& lane : lanes) {
      if (lane.width > lane.least && (give == nullptr || lane.width > give->width)) give = &lane;
    }
    --give->width;
  }
  return true;
}

/// One row, as many lines as its longest cell takes.
std::string row_of(const std::vector<Lane>& lanes, const Cells& cells) {
  std::vector<std::vector<std::string>> parts;
  std::size_t height = 1;
  for (std::size_t c = 0; c < lanes.size(); ++c) {
    parts.push_back(wrapped(cells[c], lanes[c].width));
    height = std::max(height, parts.back().size());
  }
  std::string text;
  for (std::size_t l = 0; l < height; ++l) {
    std::string line;
    for (std::size_t c = 0; c < lanes.size(); ++c) {
      const std::string shown = l < parts[c].size() ? parts[c][l] : std::string();
      const std::string padding(lanes[c].width - std::min(lanes[c].width, display_width(shown)), ' ');
      if (c > 0) line.append(between, ' ');
      line += lanes[c].align == Align::right ? padding + shown : shown + padding;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

/// Titles, units and rows between rules, if they fit.
std::optional<std::string> fitted(const std::vector<Column>& columns, std::span<const Cells> rows, std::size_t width) {
  std::vector<Lane> lanes = lanes_of(columns, rows);
  if (!squeeze(lanes, width)) return std::nullopt;
  std::string rule;
  for (std::size_t i = 0; i < sum(lanes, &Lane::width); ++i) rule += "─";
  rule += "\n";
  Cells titles, units;
  for (const Lane& lane : lanes) {
    titles.push_back(lane.title);
    units.push_back(lane.unit);
  }
  std::string text = rule + row_of(lanes, titles);
  if (std::any_of(units.begin(), units.end(), [](const std::string& unit) { return !unit.empty(); })) {
    text += row_of(lanes, units);
  }
  text += rule;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Cells cells;
    for (const Lane& lane : lanes) cells.push_back(lane.cells[r]);
    text += row_of(lanes, cells);
  }
  return text + rule;
}

/// Rows become columns, headed by their first cells.
std::pair<std::vector<Column>, std::vector<Cells>> turned(const std::vector<Column>& columns,
                                                          std::span<const Cells> rows) {
  const auto cell = [](const Cells& row, std::size_t c) { return c < row.size() ? row[c] : std::string(); };
  std::vector<Column> heads{{with_unit(columns.front().title, columns.front().unit), "", Align::left}};
  const bool texts =
      std::any_of(columns.begin() + 1, columns.end(), [](const Column& column) { return column.align == Align::left; });
  for (const Cells& row : rows) heads.push_back({cell(row, 0), "", texts ? Align::left : Align::right});
  std::vector<Cells> all;
  for (std::size_t c = 1; c < columns.size(); ++c) {
    Cells& line = all.emplace_back(1, with_unit(columns[c].title, columns[c].unit));
    for (const Cells& row : rows) line.push_back(cell(row, c));
  }
  return {std::move(heads), std::move(all)};
}

}  // namespace

Table::Table(std::vector<Column> columns, std::string caption)
    : columns_(std::move(columns)), caption_(std::move(caption)) {}

void Table::add_row(std::vector<std::string> cells) {
  while (columns_.size() < cells.size()) columns_.push_back({});
  rows_.push_back(std::move(cells));
}

std::string Table::to_text() const {
  const std::string heading = caption_.empty() ? "" : printable(caption_) + "\n";
  if (auto lines = fitted(columns_, rows_, rows_.empty() ? any_width : text_width())) return heading + *lines;
  // Too wide as it is: as many rows as fit stand beside one another, under what each begins with.
  std::string text = heading;
  for (std::size_t first = 0; first < rows_.size();) {
    std::size_t count = rows_.size() - first;
    std::optional<std::string> lines;
    for (; !lines; --count) {
      const auto [columns, rows] = turned(columns_, std::span(rows_).subspan(first, count));
      lines = fitted(columns, rows, text_width());
      if (!lines && count == 1) lines = fitted(columns, rows, any_width);
      if (lines) break;
    }
    text += *lines;
    first += count;
  }
  return text;
}

std::string Table::to_html() const {
  constexpr std::size_t longest_word = 24;  // a longer text is broken into lines
  const auto alignment = [&](std::size_t c) { return columns_[c].align == Align::right ? " class=\"number\"" : ""; };
  std::string html = "<table>\n";
  if (!caption_.empty()) html += "<caption>" + escape(caption_) + "</caption>\n";
  html += "<thead><tr>";
  for (std::size_t c = 0; c < columns_.size(); ++c) {
    const Column& column = columns_[c];
    html += std::string("<th scope=\"col\"") + alignment(c) + ">" + escape(column.title);
    if (!column.unit.empty()) html += " <span class=\"unit\">" + escape(column.unit) + "</span>";
    html += "</th>";
  }
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : rows_) {
    html += "<tr>";
    for (std::size_t c = 0; c < columns_.size(); ++c) {
      const std::string tag = c == 0 ? "th" : "td";
      const std::string shown = c < row.size() ? row[c] : std::string();
      const bool text = columns_[c].align == Align::left && display_width(printable(shown)) > longest_word;
      html += "<" + tag + (c == 0 ? " scope=\"row\"" : "") + (text ? " class=\"text\"" : alignment(c)) + ">";
      html += escape(shown) + "</" + tag + ">";
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n";
}

}  // namespace tactus::report
