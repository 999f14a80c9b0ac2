// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/join.hpp>

#include <gtest/gtest.h>
#include <tests/wire/scripted_end.hpp>

namespace tactus::wire {
namespace {

using testing::ScriptedEnd;

TEST(Join, BytesArriveAtTheTimeAtWhichTheyAreSaid) {
  ScriptedEnd a, b;
  a.script = {{5, {1, 2}}, {5, {3}}, {90, {4}}};
  b.script = {{7, {9}}};
  join(a, b, 0, 90);
  EXPECT_EQ(b.heard, (std::vector<ScriptedEnd::Heard>{{5, {1, 2}}, {5, {3}}}));
  EXPECT_EQ(a.heard, (std::vector<ScriptedEnd::Heard>{{7, {9}}}));
  join(a, b, 90, 91);
  EXPECT_EQ(b.heard.back(), (ScriptedEnd::Heard{90, {4}}));
}

TEST(Join, TimeGoesOnBetweenEndsThatAnswerAtOnce) {
  ScriptedEnd a, b;
  a.script = {{0, {1}}};
  a.answer = b.answer = {7};
  join(a, b, 0, 1000);
  EXPECT_EQ(a.heard.size(), 1000U);
  EXPECT_EQ(a.heard.back().at_ns, 999);
}

TEST(Join, ToCutItChangesNothing) {
  const auto run = [](std::int64_t piece_ns) {
    ScriptedEnd a, b;
    a.script = {{3, {1}}};
    a.answer = b.answer = {7};
    a.answer_after_ns = 11;
    b.answer_after_ns = 17;
    for (std::int64_t at_ns = 0; at_ns < 1200; at_ns += piece_ns) join(a, b, at_ns, at_ns + piece_ns);
    return a.heard;
  };
  const auto whole = run(1200);
  EXPECT_GT(whole.size(), 40U);
  EXPECT_EQ(run(1), whole);
  EXPECT_EQ(run(8), whole);
}

}  // namespace
}  // namespace tactus::wire
