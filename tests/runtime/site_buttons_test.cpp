// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/site_buttons.hpp>

#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace tactus::runtime {
namespace site_buttons_test {

using control::SiteRole;
using control::SiteState;

TEST(SiteWords, AreReadFromALineAndAWrongOneNamesThoseThatThereAre) {
  EXPECT_EQ(parse_site_word("", SiteRole::master).value(), SiteWord::arm);
  EXPECT_EQ(parse_site_word("  release \r", SiteRole::master).value(), SiteWord::release);
  EXPECT_EQ(parse_site_word("clear", SiteRole::slave).value(), SiteWord::clear);
  const auto wrong = parse_site_word("amr", SiteRole::master);
  ASSERT_FALSE(wrong);
  EXPECT_NE(describe(wrong.error()).find("arm, press, release, clutch, unclutch, stop, clear, start, keep, discard"),
            std::string::npos)
      << describe(wrong.error());
  const auto elsewhere = parse_site_word("arm", SiteRole::slave);
  ASSERT_FALSE(elsewhere);
  EXPECT_NE(describe(elsewhere.error()).find("at the master"), std::string::npos) << describe(elsewhere.error());
  EXPECT_FALSE(parse_site_word("", SiteRole::slave));
}

TEST(SiteWords, ThatMarkAnEpisodePressNothing) {
  for (const auto& [word, mark] :
       {std::pair{SiteWord::start, EpisodeMark::start}, std::pair{SiteWord::keep, EpisodeMark::keep},
        std::pair{SiteWord::discard, EpisodeMark::discard}}) {
    EXPECT_EQ(parse_site_word(name_of(word), SiteRole::master).value(), word);
    EXPECT_EQ(mark_of(word), mark);
    SiteButtons marked, untouched;
    for (const SiteState state : {SiteState::configure, SiteState::align, SiteState::armed, SiteState::active}) {
      marked.take(word);
      const auto pressed = marked.step(state), expected = untouched.step(state);
      EXPECT_EQ(pressed.arm, expected.arm);
      EXPECT_EQ(pressed.dead_man, expected.dead_man);
      EXPECT_EQ(pressed.emergency_stop, expected.emergency_stop);
      EXPECT_EQ(pressed.clear, expected.clear);
    }
  }
  EXPECT_FALSE(mark_of(SiteWord::arm));
  EXPECT_FALSE(parse_site_word("keep", SiteRole::slave));
}

TEST(SiteButtons, AButtonIsPushedForATickAndTheDeadManSwitchComesAfterArming) {
  SiteButtons buttons;
  EXPECT_FALSE(buttons.step(SiteState::configure).align) << "what is pressed at the start is not heard";
  EXPECT_TRUE(buttons.step(SiteState::configure).align);
  EXPECT_FALSE(buttons.step(SiteState::align).align);
  ASSERT_TRUE(buttons.ready());
  buttons.take(SiteWord::arm);
  const auto pushed = buttons.step(SiteState::align);
  EXPECT_TRUE(pushed.arm);
  EXPECT_FALSE(pushed.dead_man);
  EXPECT_FALSE(buttons.ready()) << "let go first, or a second push would not rise";
  const auto after = buttons.step(SiteState::armed);
  EXPECT_FALSE(after.arm);
  EXPECT_TRUE(after.dead_man);
  ASSERT_TRUE(buttons.ready());
  buttons.take(SiteWord::arm);
  EXPECT_FALSE(buttons.step(SiteState::armed).dead_man) << "armed anew, pressed anew";
  EXPECT_TRUE(buttons.step(SiteState::armed).dead_man);
  buttons.take(SiteWord::arm);
  EXPECT_TRUE(buttons.step(SiteState::active).dead_man) << "an arming while active lets nothing go";
  EXPECT_FALSE(buttons.step(SiteState::hold).dead_man);
  buttons.take(SiteWord::release);
  EXPECT_FALSE(buttons.step(SiteState::active).dead_man);
}

}  // namespace site_buttons_test
}  // namespace tactus::runtime
