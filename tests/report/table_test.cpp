// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>

#include <algorithm>
#include <sstream>

#include "markup.hpp"
#include <gtest/gtest.h>

namespace tactus::report {
namespace table_test {

using Align = Column::Align;

TEST(TableText, LinesUpColumnsWhoseTextIsNotAscii) {
  Table table({{"µ", "", Align::left}, {"λ limit", "µm"}, {"time", "ms"}}, "Taps");
  table.add_row({"a–b", "1.5", "49.2"});
  table.add_row({"力", "–", "1050"});
  EXPECT_EQ(table.to_text(),
            "Taps\n"
            "──────────────────\n"
            "µ    λ limit  time\n"
            "          µm    ms\n"
            "──────────────────\n"
            "a–b      1.5  49.2\n"
            "力         –  1050\n"
            "──────────────────\n");
}

TEST(TableText, HasNoUnitLineWithoutUnitsAndNoTrailingBlanks) {
  Table table({{"name", "", Align::left}, {"note", "", Align::left}});
  table.add_row({"a", "a long note"});
  table.add_row({"b", ""});
  EXPECT_EQ(table.to_text(),
            "─────────────────\n"
            "name  note\n"
            "─────────────────\n"
            "a     a long note\n"
            "b\n"
            "─────────────────\n");
}

TEST(TableText, KeepsItsShapeForShortRowsLongRowsAndLineBreaks) {
  Table table({{"a"}});
  table.add_row({});
  table.add_row({"1", "2\n3"});
  EXPECT_EQ(table.to_text(),
            "──────\n"
            "a\n"
            "──────\n"
            "\n"
            "1  2 3\n"
            "──────\n");
}

/// Every line within the width, and every word there.
void expect_whole(const std::string& text, std::size_t width, const std::vector<std::string>& words) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(display_width(line), width) << text;
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << "\n" << text;
}

Table wide_table(std::size_t columns, std::size_t rows) {
  std::vector<Column> heads{{"method", "", Align::left}};
  for (std::size_t c = 0; c < columns; ++c) heads.push_back({"quantity number" + std::to_string(c), "mN RMS"});
  Table table(heads, "Wide");
  for (std::size_t r = 0; r < rows; ++r) {
    std::vector<std::string> cells{"a method of many words " + std::to_string(r)};
    for (std::size_t c = 0; c < columns; ++c) cells.push_back(std::to_string(1000 * r + c) + ".25");
    table.add_row(cells);
  }
  return table;
}

TEST(TableText, TitlesAndTextsAreBrokenIntoLinesWhereTheTableIsTooWide) {
  Table table({{"gain", "", Align::left}, {"settling, median", "ms"}, {"verdict", "", Align::left}});
  table.add_row({"1", "49.2", "stopped: master, because the slave was silent for longer than it may be, and so on"});
  EXPECT_EQ(table.to_text(),
            "────────────────────────────────────────────────────────────────────────────────\n"
            "gain  settling, median  verdict\n"
            "                    ms\n"
            "────────────────────────────────────────────────────────────────────────────────\n"
            "1                 49.2  stopped: master, because the slave was silent for longer\n"
            "                        than it may be, and so on\n"
            "────────────────────────────────────────────────────────────────────────────────\n");
}

TEST(TableText, NoColumnIsLostHoweverManyThereAre) {
  for (const std::size_t columns : {3U, 6U, 12U, 40U}) {
    for (const std::size_t rows : {1U, 3U, 20U}) {
      std::vector<std::string> words{"number0", "number" + std::to_string(columns - 1)};
      for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t c = 0; c < columns; ++c) words.push_back(std::to_string(1000 * r + c) + ".25");
      }
      expect_whole(wide_table(columns, rows).to_text(), 80, words);
    }
  }
}

TEST(TableText, AWiderTerminalIsUsed) {
  const Table table = wide_table(8, 2);
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  const auto in_80 = lines(table.to_text());
  set_text_width(400);
  const std::string wide = table.to_text();
  set_text_width(80);
  EXPECT_LT(lines(wide), in_80);
  EXPECT_EQ(lines(wide), 1 + 3 + 2 + 2) << wide;
  EXPECT_EQ(lines(table.to_text()), in_80);
}

TEST(TableHtml, NamesScopesAndAlignsNumbers) {
  Table table({{"mode", "", Align::left}, {"time", "ms"}}, "Settling");
  table.add_row({"on", "49.2"});
  EXPECT_EQ(table.to_html(),
            "<table>\n<caption>Settling</caption>\n<thead><tr><th scope=\"col\">mode</th>"
            "<th scope=\"col\" class=\"number\">time <span class=\"unit\">ms</span></th></tr></thead>\n<tbody>\n"
            "<tr><th scope=\"row\">on</th><td class=\"number\">49.2</td></tr>\n</tbody>\n</table>\n");
}

TEST(TableHtml, ShowsMarkupLiterally) {
  const std::string evil = "<script>\"&'</script>";
  Table table({{evil, evil}}, evil);
  table.add_row({evil});
  EXPECT_EQ(fault_of(table.to_html()), "");
  EXPECT_EQ(table.to_html().find("<script"), std::string::npos);
}

}  // namespace table_test
}  // namespace tactus::report
