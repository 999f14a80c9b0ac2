// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>

#include <ctime>
#include <random>
#include <string>
#include <string_view>

#include <gtest/gtest.h>
#include <tests/configuration/experiment.hpp>

namespace tactus::configuration {
namespace {

using std::string_view_literals::operator""sv;
using testing::Experiment;

constexpr std::string_view sound = R"(# an experiment
duration_s = 1.5
[slave]
mass_kg = 2e-1
velocity_filter = { cutoff_Hz = 40, enabled = false }
[control]
force_gain = 0x3
cancellation = "off"
taps = 1_000
[task]
kind = """tapping"""
recording = 'C:\x\y.csv'
)";

std::string repeat(std::string_view part, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) text += part;
  return text;
}

/// Every text is either read, or refused with a placed and printable message.
bool holds(std::string_view text) {
  const Result<Document> document = Document::parse(text, "t.toml");
  Check problem;
  if (!document) {
    problem = document.error();
  } else if (const Result<Experiment> experiment = document->read<Experiment>(); !experiment) {
    problem = experiment.error();
  }
  if (!problem) return true;
  EXPECT_TRUE(problem->place.starts_with("t.toml")) << problem->place;
  EXPECT_LT(describe(*problem).size(), 1500U);
  for (const char c : describe(*problem)) {
    if (static_cast<unsigned char>(c) < 0x20) ADD_FAILURE() << "a control character in: " << describe(*problem);
  }
  return false;
}

TEST(HostileText, TheSoundOneIsRead) { EXPECT_TRUE(holds(sound)); }

TEST(HostileText, EveryTruncationIsReadOrRefused) {
  int refused = 0;
  for (std::size_t length = 0; length < sound.size(); ++length) refused += holds(sound.substr(0, length)) ? 0 : 1;
  EXPECT_GT(refused, 50);
}

TEST(HostileText, MutationsAreReadOrRefused) {
  constexpr int count = 2000;
  constexpr std::string_view likely = "[]{}=.\"'#\n\r\t,-+_e0x\\\x00\x7f\xff\xc3"sv;  // with its NUL
  std::mt19937 random(20240607);
  const auto below = [&](std::size_t n) { return std::uniform_int_distribution<std::size_t>(0, n - 1)(random); };
  int refused = 0;
  for (int i = 0; i < count; ++i) {
    std::string text(sound);
    for (std::size_t change = 1 + below(6); change > 0; --change) {
      const std::size_t at = below(text.size());
      const char letter = below(2) == 0 ? static_cast<char>(below(256)) : likely[below(likely.size())];
      switch (below(5)) {
        case 0:
          text[at] = letter;
          break;
        case 1:
          text.insert(at, 1, letter);
          break;
        case 2:
          text.erase(at, 1 + below(8));
          break;
        case 3:
          text.insert(at, "\xc2\xa7");
          break;
        default:
          text.insert(at, text.substr(below(text.size()), below(30)));
          break;
      }
      if (text.empty()) text.push_back('\n');
    }
    refused += holds(text) ? 0 : 1;
  }
  EXPECT_GT(refused, count / 2);
  EXPECT_LT(refused, count);
}

TEST(HostileText, ALetterBeyondAsciiIsFineInTextsAndCommentsAndRefusedElsewhere) {
  for (const char* letter : {"\xc2\xa7", "\xcc\xaa", "\xe2\xbf\xbf", "\xef\xb7\xbf", "\xf0\x9f\x98\x80"}) {
    const std::string text(letter);
    EXPECT_FALSE(holds(text));
    EXPECT_FALSE(holds(text + " = 1"));
    EXPECT_FALSE(holds("[" + text + "]"));
    EXPECT_FALSE(holds("duration_s = 1 " + text));
    EXPECT_FALSE(holds("duration_s = " + text));
    EXPECT_TRUE(holds("duration_s = 1 #" + text));
    // A backslash at the end of a line skips the white space up to the letter.
    const auto document = Document::parse("task.kind = \"\"\"\\\n  " + text + "\"\"\"", "t.toml");
    ASSERT_TRUE(document) << describe(document.error());
    EXPECT_EQ(document->read<Experiment>()->task.kind, text);
  }
}

TEST(HostileText, NoiseIsRefused) {
  std::mt19937 random(7);
  for (int i = 0; i < 300; ++i) {
    std::string text(1 + random() % 200, '\0');
    for (char& c : text) c = static_cast<char>(random());
    text += "=";  // no text that ends so is TOML, unless a comment swallows the end
    if (text.find('#') == std::string::npos) {
      EXPECT_FALSE(holds(text));
    }
  }
}

TEST(HostileText, DeepNestingIsRefusedBeforeItExhaustsTheStack) {
  const std::string deep = repeat("a.", 200000) + "a";
  EXPECT_FALSE(holds(deep + " = 1"));
  EXPECT_FALSE(holds("[" + deep + "]"));
  EXPECT_FALSE(holds("a = " + repeat("[", 400000)));
  EXPECT_FALSE(holds("a = " + repeat("[", 40) + repeat("]", 40)));
  EXPECT_FALSE(holds("a = " + repeat("{a=", 200000)));
}

TEST(HostileText, TheDeepestNestingThatIsReadIsHandled) {
  const Result<Document> flat = Document::parse(repeat("a.", 100) + "a = 1", "t.toml");
  ASSERT_TRUE(flat) << describe(flat.error());
  EXPECT_EQ(flat->read<Experiment>().error().code, ErrorCode::unknown_key);
  const std::string open = repeat("a.", 98) + "a = [\n{";
  const Result<Document> nested = Document::parse(repeat(open, 7) + "a = 1" + repeat("}]", 7), "t.toml");
  ASSERT_TRUE(nested) << describe(nested.error());
  EXPECT_EQ(nested->read<Experiment>().error().code, ErrorCode::unknown_key);
}

TEST(HostileText, HugeTextIsRefusedOrReadWithoutHugeWork) {
  EXPECT_FALSE(holds(std::string((1U << 20U) + 1, ' ')));
  EXPECT_TRUE(holds(std::string(1U << 20U, ' ')));
  EXPECT_FALSE(holds(repeat("k", 1000000) + " = 1"));
  EXPECT_FALSE(holds('"' + repeat("\\n", 400000) + "\" = 1"));
  EXPECT_FALSE(holds("[control]\ncancellation = \"" + repeat("x", 1000000) + "\""));
  EXPECT_FALSE(holds("duration_s = " + repeat("9", 1000000)));
  std::string many;
  for (int i = 0; i < 5000; ++i) many.append("[k").append(std::to_string(i)).append(repeat(".a", 80)).append("]\n");
  EXPECT_FALSE(holds(many));
}

/// Processor time of a job, in seconds.
template <class Job>
double seconds_of(Job&& job) {
  const std::clock_t start = std::clock();
  job();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

std::string keys(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text.append("k").append(std::to_string(i)).append("=1\n");
  return text;
}

std::string keys_under(std::size_t letters, int count) {
  return repeat("[", 1).append(repeat("s", letters)).append("]\n").append(keys(count));
}

TEST(HostileText, ALongSectionOverManyKeysDoesNotTakeTheSquareOfItsSize) {
  const Result<Document> document = Document::parse(keys_under(100000, 10000), "t.toml");  // a gigabyte of paths
  ASSERT_FALSE(document);
  EXPECT_EQ(document.error().place, "t.toml:1:2");
  EXPECT_NE(document.error().message.find("more than the 500"), std::string::npos) << document.error().message;
  EXPECT_TRUE(Document::parse(keys_under(400, 10), "t.toml"));
}

TEST(HostileText, MergingTakesTimeInProportionToTheKeys) {
  const auto merging = [](int count) {
    const auto other = Document::parse(keys(count), "other.toml");
    EXPECT_TRUE(other);
    auto document = Document::parse(keys(count / 2), "t.toml");
    return seconds_of([&] { EXPECT_FALSE(document->merge(*other)); });
  };
  // A tenth of a second, where the square took ten.
  EXPECT_LT(merging(100000), 1.0 + 3.0 * merging(50000));
}

}  // namespace
}  // namespace tactus::configuration
