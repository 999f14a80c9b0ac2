#include <tactus/recording/time_base.hpp>

#include <cmath>
#include <string>

#include "tests/recording/files.hpp"

namespace tactus::recording {
namespace {

std::string nowhere(std::size_t) { return {}; }

TEST(TimeBase, RoundedTimesGiveTheSampleTimeOfTheirGrid) {
  std::vector<double> time;
  for (int i = 0; i < 4000; ++i) time.push_back(std::round((3.0 + i * 0.0002) * 1e5) / 1e5);
  const auto found = uniform_sample_time(time, nowhere);
  ASSERT_TRUE(found) << describe(found.error());
  EXPECT_DOUBLE_EQ(*found, 0.0002);
}

TEST(TimeBase, ALostSampleIsNoticedWhereverItIs) {
  for (std::size_t lost = 1; lost < 99; ++lost) {
    std::vector<double> time;
    for (std::size_t i = 0; i < 100; ++i) {
      if (i != lost) time.push_back(0.001 * static_cast<double>(i));
    }
    const auto found = uniform_sample_time(time, nowhere);
    ASSERT_FALSE(found) << lost;
    EXPECT_TRUE(says(found.error().message, "not uniform"));
  }
}

TEST(TimeBase, JitterOfATwentiethPassesAndOfAFifthDoesNot) {
  for (const auto& [share, accepted] : {std::pair{0.05, true}, std::pair{0.2, false}}) {
    std::vector<double> time;
    for (int i = 0; i < 50; ++i) time.push_back(i + (i % 2 == 0 || i == 49 ? 0.0 : share));
    EXPECT_EQ(uniform_sample_time(time, nowhere).ok(), accepted) << share;
  }
}

using TimeColumn = RecordingFiles;

TEST_F(TimeColumn, TimesInAnyUnitGiveSeconds) {
  for (const auto& [head, step] : {std::pair{"time [s]", "2"}, std::pair{"t_ms", "2000"}, std::pair{"Time_us", "2e6"},
                                   std::pair{"time [µs]", "2e6"}, std::pair{"time (ns)", "2e9"}, std::pair{"t", "2"}}) {
    const auto signal =
        read({.file = write("a.csv", std::string(head) + ",f\n0,1\n" + step + ",1\n"), .variable = "f"});
    ASSERT_TRUE(signal) << head << describe(signal.error());
    EXPECT_DOUBLE_EQ(signal->sample_time_s.value_or(0.0), 2.0) << head;
  }
  EXPECT_TRUE(says(refusal({.file = write("a.csv", "time [h],f\n0,1\n1,1\n"), .variable = "f"}), "times are in s, ms"));
}

TEST_F(TimeColumn, WithoutTimesTheStatedSampleTimeCountsOrNone) {
  const auto file = write("a.csv", "f\n1\n2\n");
  EXPECT_EQ(read({.file = file, .variable = "f"})->sample_time_s, std::nullopt);
  EXPECT_EQ(read({.file = file, .variable = "f", .sample_time_s = 0.001})->sample_time_s, 0.001);
  for (const double bad : {0.0, -1.0, std::nan("")}) {
    EXPECT_TRUE(says(refusal({.file = file, .variable = "f", .sample_time_s = bad}), "sample_time_s: "));
  }
}

TEST_F(TimeColumn, AStatedSampleTimeMustAgreeWithTheTimes) {
  const auto file = write("a.csv", "time_s,f\n0,1\n0.0010001,2\n0.0020002,3\n");
  EXPECT_EQ(read({.file = file, .variable = "f", .sample_time_s = 0.001})->sample_time_s, 0.001);
  EXPECT_EQ(
      refusal({.file = file, .variable = "f", .sample_time_s = 0.0005}),
      "sample_time_s: a sample time of 5e-04 s contradicts the times in the file, 0.0010001 s apart; correct it or "
      "leave it out");
}

TEST_F(TimeColumn, AnIrregularTimeIsNamedWithItsLine) {
  const auto standing = write("a.csv", "# c\nstamp_s,f\n0,1\n1,2\n1,3\n2,4\n");
  const auto error = read({.file = standing, .variable = "f", .time = "stamp"}).error();
  EXPECT_EQ(error.place, standing.string() + ":5");
  EXPECT_TRUE(says(error.message, "does not increase: 1 s is followed by 1 s"));

  const auto late = write("b.csv", "time_s,f\n0,1\n1,2\n2.5,3\n3,4\n");
  EXPECT_EQ(read({.file = late, .variable = "f"}).error().place, late.string() + ":4");
}

TEST_F(TimeColumn, ANamedTimeColumnTakesTheRoleOfTheOneCalledTime) {
  const auto file = write("a.csv", "time_s,clock_ms,f\n0,0,1\n0,2,2\n0,4,3\n");
  EXPECT_EQ(read({.file = file, .variable = "f", .time = "clock"})->sample_time_s, 0.002);
}

}  // namespace
}  // namespace tactus::recording
