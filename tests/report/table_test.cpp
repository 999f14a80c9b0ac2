#include <tactus/report/table.hpp>

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
