// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/serve_report.hpp>

#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <tests/live/sample_view.hpp>

namespace tactus::cli {
namespace serve_report_test {

TEST(ServeReport, TellsWhatWasTriedAndThatOneLoopRangWhereTheOtherSettled) {
  const auto view = live::sample_view();
  ASSERT_FALSE(live::publish(*view, "/operator/command", R"({"command":"tap"})"));
  for (int i = 0; i < 3000; ++i) {
    view->engine().step();
    if (i % 100 == 99) view->collect([](std::size_t) { return false; }, [](auto, auto, const auto&) {});
  }
  const experiments::Request request{.document = configuration::Document::parse("", "sample.toml").value(),
                                     .variations = {},
                                     .name = "sample",
                                     .command = "tactus serve"};
  report::set_text_width(200);
  const auto outcome = serve_outcome({.duration_s = 0.6, .server = {.accepted = 3}}, view->history(),
                                     live::sample_settings().descriptions(), request, "[task]");
  const auto document = nlohmann::json::parse(outcome.json);
  EXPECT_EQ(document["connections"], 3);
  ASSERT_EQ(document["settings"].size(), 1U);
  EXPECT_EQ(document["settings"][0]["control.force_gain"], 10.0);
  std::string left, right;
  for (const auto& contact : document["contacts"]) (contact["loop"] == "left" ? left : right) = contact["verdict"];
  EXPECT_EQ(left, "settled");
  EXPECT_EQ(right, "rang");
  ASSERT_EQ(outcome.figures.size(), 1U);
  report::set_text_width(80);
  EXPECT_NE(outcome.text.find("Force gain"), std::string::npos) << outcome.text;
  EXPECT_NE(outcome.html.find("tactus serve"), std::string::npos);
}

}  // namespace serve_report_test
}  // namespace tactus::cli
