// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/page.hpp>

#include "markup.hpp"
#include <gtest/gtest.h>

namespace tactus::report {
namespace page_test {

const std::string evil = "</style><script>alert(\"1\" && '2')</script>";

Page full_page(const std::string& text) {
  Page page(text);
  page.heading(text);
  page.heading(text, 9);
  page.paragraph(text);
  Table table({{text, text}}, text);
  table.add_row({text});
  page.table(table);
  Figure figure;
  figure.title = figure.caption = text;
  Panel panel;
  panel.lines = {{.name = text, .x = {0, 1}, .y = {0, 1}}};
  figure.panels = {panel};
  page.figure(figure);
  page.figure(figure);
  page.code(text, text);
  page.definitions({{text, text}});
  page.footer(text, text);
  return page;
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++found;
  return found;
}

TEST(Page, IsWellFormedWhateverItShows) {
  EXPECT_EQ(fault_of(full_page("text").to_html()), "");
  EXPECT_EQ(fault_of(full_page(evil).to_html()), "");
}

TEST(Page, ShowsMarkupLiterally) {
  const std::string html = full_page(evil).to_html();
  EXPECT_EQ(occurrences(html, "<script"), 1U);  // its own
  EXPECT_EQ(occurrences(html, "</style"), 1U);
  EXPECT_EQ(occurrences(html, "alert(\"1\""), 0U);
  EXPECT_GE(occurrences(html, "&lt;script&gt;alert(&quot;1&quot; &amp;&amp; &#39;2&#39;)"), 15U);
}

TEST(Page, NeedsNothingBesideItself) {
  const std::string html = full_page("text").to_html();
  for (const char* reference : {"http:", "https:", "src=", "href", "url(", "@import", "//", "fetch("}) {
    EXPECT_EQ(occurrences(html, reference), 0U) << reference;
  }
  EXPECT_EQ(occurrences(html, "default-src 'none'"), 1U);
}

TEST(Page, KeepsTheOrderOfItsPartsAndEndsWithTheFooter) {
  Page page("First");
  page.footer("tactus 0.1.0", "tactus run tapping.toml");
  page.paragraph("Second");
  page.heading("Third");
  page.code("Fourth\n  indented");
  const std::string html = page.to_html();
  std::size_t at = 0;
  for (const char* part : {"<title>First</title>", "<h1>First</h1>", "<p>Second</p>", "<h2>Third</h2>",
                           "<code>Fourth\n  indented</code></pre>", "</main>",
                           "<footer>tactus 0.1.0 <code>tactus run tapping.toml</code></footer>"}) {
    const std::size_t found = html.find(part, at);
    ASSERT_NE(found, std::string::npos) << part;
    at = found;
  }
}

TEST(Page, NumbersItsFiguresAndHoldsTheirStylesOnce) {
  const std::string html = full_page("text").to_html();
  EXPECT_EQ(occurrences(html, "<strong>Figure 1. text.</strong>"), 1U);
  EXPECT_EQ(occurrences(html, "<strong>Figure 2. text.</strong>"), 1U);
  EXPECT_EQ(tags(html, "svg").size(), 2U);
  EXPECT_EQ(occurrences(html, "<style>"), 1U);
  EXPECT_EQ(occurrences(html, figure_style()), 1U);
}

TEST(Page, ScrollsFiguresAndTablesInPlaceOnANarrowScreen) {
  const std::string html = full_page("text").to_html();
  EXPECT_NE(html.find("width=device-width"), std::string::npos);
  EXPECT_EQ(tags(html, "div", "scroll").size(), 3U);
  for (const std::string& part : tags(html, "div", "scroll")) EXPECT_EQ(attribute(part, "tabindex"), "0");
}

TEST(Page, WhatIsFoldedIsThereAndShownLiterally) {
  Page page("Title");
  page.folded("[task]\nkind = \"<b>\"\n", "The whole configuration");
  const std::string html = page.to_html();
  EXPECT_EQ(fault_of(html), "");
  EXPECT_NE(html.find("<details>\n<summary>The whole configuration</summary>\n<pre"), std::string::npos);
  EXPECT_NE(html.find("kind = &quot;&lt;b&gt;&quot;"), std::string::npos);
}

TEST(Page, ATableThatIsWiderThanThePageSaysThatThereIsMore) {
  Page page("Title");
  Table table({{"a", "", Column::Align::left}, {"b"}});
  table.add_row({"a text of many words, which goes on", "2"});
  page.table(table);
  const std::string html = page.to_html();
  EXPECT_NE(html.find(".scroll:not(.picture){background:"), std::string::npos) << "a shadow where it goes on";
  EXPECT_NE(html.find("<th scope=\"row\" class=\"text\">a text of many words"), std::string::npos);
  EXPECT_NE(html.find("There is more on the right"), std::string::npos);
  EXPECT_NE(html.find(".text{white-space:normal"), std::string::npos) << "texts are broken into lines";
}

}  // namespace page_test
}  // namespace tactus::report
