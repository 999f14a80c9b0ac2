// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/join.hpp>
#include <tactus/hardware/wire/paced.hpp>

#include <gtest/gtest.h>
#include <tests/wire/scripted_end.hpp>

namespace tactus::wire {
namespace {

using testing::Bytes;
using testing::ScriptedEnd;
using Heard = std::vector<ScriptedEnd::Heard>;

TEST(Paced, AByteTakesTenBits) {
  EXPECT_EQ(byte_ns(1'000'000), 10'000);
  EXPECT_EQ(byte_ns(4'000'000), 2'500);
  EXPECT_EQ(byte_ns(921'600), 10'851);
  EXPECT_EQ(byte_ns(57'600), 173'611);
}

TEST(Paced, EachByteIsHeardWhenItHasComeAndTheLineTakesOneAfterTheOther) {
  ScriptedEnd driver, peer;
  Paced paced(peer, 10, Paced::Line::full_duplex);
  driver.script = {{100, {1, 2, 3}}, {105, {4}}, {500, {5}}};
  join(driver, paced, 0, 1000);
  EXPECT_EQ(peer.heard, (Heard{{110, {1}}, {120, {2}}, {130, {3}}, {140, {4}}, {510, {5}}}));
}

TEST(Paced, AnAnswerIsThereWhenItsLastByteHasGone) {
  ScriptedEnd driver, peer;
  Paced paced(peer, 10, Paced::Line::full_duplex);
  peer.script = {{7, {1, 2, 3}}, {8, {4}}};
  join(driver, paced, 0, 1000);
  EXPECT_EQ(driver.heard, (Heard{{37, {1, 2, 3}}, {47, {4}}}));
}

TEST(Paced, BothDirectionsOfAHalfDuplexLineShareItAndOfAFullDuplexLineDoNot) {
  for (const auto line : {Paced::Line::full_duplex, Paced::Line::half_duplex}) {
    ScriptedEnd driver, peer;
    Paced paced(peer, 10, line);
    driver.script = {{0, Bytes(5, 1)}};
    peer.script = {{20, {9, 9}}};
    join(driver, paced, 0, 1000);
    EXPECT_EQ(driver.heard, (Heard{{line == Paced::Line::half_duplex ? 70 : 40, {9, 9}}}));
    EXPECT_EQ(peer.heard.back().at_ns, 50);
  }
}

TEST(Paced, ABusOfQuestionsAndAnswersRunsAtTheRateOfItsBytes) {
  ScriptedEnd driver, peer;
  Paced paced(peer, 10, Paced::Line::half_duplex);
  driver.script = {{0, {1}}};
  driver.answer = {1};
  peer.answer = {2};
  join(driver, paced, 0, 20'000);
  // A nanosecond for each answer of the driver: no time passes in it, but time goes on.
  EXPECT_NEAR(static_cast<double>(driver.heard.size()), 20'000.0 / 21.0, 1.0);
}

TEST(Paced, ThePeerLivesAtTheExactTimesHoweverLateItIsCalled) {
  const auto run = [](std::int64_t step_ns) {
    ScriptedEnd peer;
    peer.answer = {7, 7};
    peer.answer_after_ns = 13;
    Paced paced(peer, 10, Paced::Line::full_duplex);
    paced.hear(Bytes{1, 2, 3}, 0);
    for (std::int64_t now_ns = 0; now_ns <= 1000; now_ns += step_ns) {
      while (!paced.say(now_ns).empty()) continue;
    }
    return peer.heard;
  };
  EXPECT_EQ(run(1000), run(1));
}

TEST(Paced, AnEndThatWantedToSpeakAndSaysNothingDoesNotStopTime) {
  struct Undecided : ScriptedEnd {
    [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return 0; }
  } peer;
  Paced paced(peer, 10, Paced::Line::full_duplex);
  paced.hear(Bytes{1}, 5);
  EXPECT_TRUE(paced.say(100).empty());
  EXPECT_EQ(peer.heard, (Heard{{15, {1}}}));
}

TEST(Paced, WhatComesWhenAnAdapterIsFullIsLost) {
  ScriptedEnd peer;
  Paced paced(peer, 1, Paced::Line::full_duplex);
  paced.hear(Bytes(20'000, 1), 0);
  EXPECT_TRUE(paced.say(100'000).empty());
  EXPECT_EQ(peer.heard.size(), 16'384U);
}

TEST(Paced, ItsEndBeginsWhenItIsCalledFirstAndNotWhenTheClockDid) {
  ScriptedEnd peer;
  Paced paced(peer, 10, Paced::Line::full_duplex);
  peer.script = {{0, {1, 2, 3}}};
  EXPECT_TRUE(paced.say(5000).empty());
  EXPECT_EQ(paced.say(5030).size(), 3U);
}

}  // namespace
}  // namespace tactus::wire
