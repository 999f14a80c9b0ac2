// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>

#include <limits>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::report {
namespace {

using Json = nlohmann::ordered_json;

TEST(Json, ADocumentIsIndentedAndKeepsTheOrderOfItsKeys) {
  EXPECT_EQ(json_text(Json{{"b", 1}, {"a", {2, 3}}}), "{\n  \"b\": 1,\n  \"a\": [\n    2,\n    3\n  ]\n}\n");
  EXPECT_EQ(json_line(Json{{"b", 1}, {"a", {2, 3}}}), R"({"b":1,"a":[2,3]})");
}

TEST(Json, WhatIsNotUtf8IsReplacedAndWhatIsNotFiniteIsNull) {
  const Json document{{"name", "a\xff"}, {"gain", std::numeric_limits<double>::infinity()}};
  EXPECT_EQ(json_line(document), "{\"name\":\"a\xef\xbf\xbd\",\"gain\":null}");
  EXPECT_EQ(json_text(document), "{\n  \"name\": \"a\xef\xbf\xbd\",\n  \"gain\": null\n}\n");
}

TEST(Json, WhatIsReadIsWhatWasWritten) {
  const Json document{{"gain", 0.1}, {"name", "é"}, {"of", {1, nullptr, true}}};
  EXPECT_EQ(parse_json<Json>(json_text(document)), document);
  EXPECT_EQ(parse_json<Json>(json_line(document)), document);
}

TEST(Json, WhatIsNoJsonIsDiscarded) {
  for (const char* text : {"", "{", "[1,]", "{} {}", "nan", "\"\xff\"", "position-force"}) {
    EXPECT_TRUE(parse_json<Json>(text).is_discarded()) << text;
  }
}

}  // namespace
}  // namespace tactus::report
