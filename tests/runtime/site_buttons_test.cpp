// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/site_buttons.hpp>

#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace tactus::runtime {
namespace site_buttons_test {

using control::SiteRole;
using control::SiteState;

Result<SiteWord> parse_site_word(std::string_view line, SiteRole role) {
  const auto parsed = parse_site_command(line, role);
  if (!parsed) return parsed.error();
  return parsed->word;
}

TEST(SiteWords, AreReadFromALineAndAWrongOneNamesThoseThatThereAre) {
  EXPECT_EQ(parse_site_word("", SiteRole::master).value(), SiteWord::arm);
  EXPECT_EQ(parse_site_word("  release \r", SiteRole::master).value(), SiteWord::release);
  EXPECT_EQ(parse_site_word("clear", SiteRole::slave).value(), SiteWord::clear);
  const auto wrong = parse_site_word("amr", SiteRole::master);
  ASSERT_FALSE(wrong);
  EXPECT_NE(describe(wrong.error())
                .find("arm, press, release, clutch, unclutch, stop, clear, start, keep, discard, tare, set"),
            std::string::npos)
      << describe(wrong.error());
  const auto elsewhere = parse_site_word("arm", SiteRole::slave);
  ASSERT_FALSE(elsewhere);
  EXPECT_NE(describe(elsewhere.error()).find("at the master"), std::string::npos) << describe(elsewhere.error());
  EXPECT_FALSE(parse_site_word("", SiteRole::slave));
}

TEST(SiteWords, SetAForceGainWithinWhatIsAllowedAndARefusalStatesBoth) {
  constexpr Settable within_the_file{.most_force_gain = 0.5, .file_force_gain = 0.5};
  const auto set = parse_site_command(" set force_gain  0.25 ", SiteRole::master, within_the_file);
  ASSERT_TRUE(set) << describe(set.error());
  EXPECT_EQ(*set, SiteCommand(SiteWord::set, 0.25));
  const auto said = [&](std::string_view line, const Settable& settable) {
    const auto refused = parse_site_command(line, SiteRole::master, settable);
    return refused ? std::string("taken") : describe(refused.error());
  };
  for (const char* words : {"set force_gain 2", "set force_gain -0.1"}) {
    const std::string text = said(words, within_the_file);
    EXPECT_NE(text.find("0 to 0.5"), std::string::npos) << text;
    EXPECT_NE(text.find("force_gain.limit"), std::string::npos) << text;
  }
  EXPECT_NE(said("set force_gain 2", within_the_file).find("2 is refused"), std::string::npos);
  EXPECT_EQ(said("set force_gain 2", {.most_force_gain = 4.0, .file_force_gain = 0.5}), "taken");
  for (const char* line : {"set", "set damping 2", "set force_gain", "set force_gain nan", "set force_gain inf",
                           "set force_gain 1 2", "set force_gain 0x1", "set force_gain 1e999"}) {
    EXPECT_NE(said(line, within_the_file).find("set force_gain 0.5"), std::string::npos) << said(line, within_the_file);
  }
  EXPECT_NE(said("set force_gain 1", {}).find("cannot change"), std::string::npos) << said("set force_gain 1", {});
}

TEST(SiteWords, OfAPageOrANodeAreThoseThatMoveNoArmByThemselves) {
  constexpr Settable settable{.most_force_gain = 1.0, .tares = true};
  for (const RequestSource source : {RequestSource::page, RequestSource::node}) {
    for (const auto& [word, name] : enumerators(SiteWord{})) {
      const std::string line = std::string(name) + (word == SiteWord::set ? " force_gain 1" : "");
      const bool taken = static_cast<bool>(parse_site_command(line, SiteRole::master, settable, source));
      const bool harmless = word == SiteWord::set || word == SiteWord::tare || mark_of(word).has_value();
      EXPECT_EQ(taken, harmless) << name;
    }
    EXPECT_FALSE(parse_site_command("", SiteRole::master, settable, source)) << "an empty line arms at the console";
  }
  EXPECT_FALSE(parse_site_command("tare", SiteRole::master, {})) << "no arms, no gravity compensation";
}

TEST(SiteButtons, ATareReleasesTheSwitchArmsWhereNeededAndIsLetGoByThePress) {
  SiteButtons buttons;
  buttons.step(SiteState::configure);
  buttons.step(SiteState::configure);
  buttons.take(SiteCommand(SiteWord::tare), SiteState::align);
  const auto first = buttons.step(SiteState::align);
  EXPECT_TRUE(first.arm);
  EXPECT_FALSE(first.tare) << "it rises a tick later";
  const auto second = buttons.step(SiteState::armed);
  EXPECT_TRUE(second.tare);
  EXPECT_FALSE(second.arm);
  EXPECT_FALSE(second.dead_man);
  buttons.take(SiteCommand(SiteWord::tare), SiteState::armed);
  EXPECT_FALSE(buttons.step(SiteState::armed).tare) << "asked for again, it rises again";
  EXPECT_TRUE(buttons.step(SiteState::armed).tare);
  buttons.take(SiteCommand(SiteWord::press), SiteState::armed);
  const auto pressed = buttons.step(SiteState::armed);
  EXPECT_FALSE(pressed.tare);
  EXPECT_TRUE(pressed.dead_man);
  EXPECT_LT(pressed.force_gain, 0.0) << "nobody asked for one";
  buttons.take(SiteCommand(SiteWord::set, 0.75), SiteState::active);
  buttons.step(SiteState::active);
  EXPECT_EQ(buttons.step(SiteState::active).force_gain, 0.75) << "and it stays asked for";
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
