#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>

#include <algorithm>
#include <utility>

namespace tactus::report {
namespace {

using Align = Column::Align;

/// A cell as the terminal shows it.
struct Cell {
  std::string text;
  std::size_t width;
};

Cell cell(const std::string& text) {
  std::string shown = printable(text);
  const std::size_t width = display_width(shown);
  return {std::move(shown), width};
}

}  // namespace

Table::Table(std::vector<Column> columns, std::string caption)
    : columns_(std::move(columns)), caption_(std::move(caption)) {}

void Table::add_row(std::vector<std::string> cells) {
  while (columns_.size() < cells.size()) columns_.push_back({});
  rows_.push_back(std::move(cells));
}

std::string Table::to_text() const {
  const std::size_t count = columns_.size();
  std::vector<std::vector<Cell>> lines(2);
  bool any_unit = false;
  for (const Column& column : columns_) {
    lines[0].push_back(cell(column.title));
    lines[1].push_back(cell(column.unit));
    any_unit = any_unit || !column.unit.empty();
  }
  if (!any_unit) lines.pop_back();
  const std::size_t header_lines = lines.size();
  for (const auto& row : rows_) {
    auto& line = lines.emplace_back();
    for (std::size_t c = 0; c < count; ++c) line.push_back(cell(c < row.size() ? row[c] : std::string()));
  }

  constexpr std::size_t gap = 2;
  std::vector<std::size_t> widths(count, 0);
  for (const auto& line : lines) {
    for (std::size_t c = 0; c < count; ++c) widths[c] = std::max(widths[c], line[c].width);
  }
  std::string rule;
  for (std::size_t c = 0; c < count; ++c) {
    for (std::size_t i = 0; i < widths[c] + (c == 0 ? 0 : gap); ++i) rule += "─";
  }
  rule += "\n";

  std::string text = caption_.empty() ? "" : printable(caption_) + "\n";
  text += rule;
  for (std::size_t l = 0; l < lines.size(); ++l) {
    std::string line;
    for (std::size_t c = 0; c < count; ++c) {
      const auto& [shown, width] = lines[l][c];
      const std::string padding(widths[c] - width, ' ');
      if (c > 0) line.append(gap, ' ');
      line += columns_[c].align == Align::right ? padding + shown : shown + padding;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
    if (l + 1 == header_lines) text += rule;
  }
  return text + rule;
}

std::string Table::to_html() const {
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
      html += "<" + tag + (c == 0 ? " scope=\"row\"" : "") + alignment(c) + ">";
      html += escape(c < row.size() ? row[c] : std::string()) + "</" + tag + ">";
    }
    html += "</tr>\n";
  }
  return html + "</tbody>\n</table>\n";
}

}  // namespace tactus::report
