// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/resample.hpp>
#include <tactus/data/recording/time_base.hpp>

#include <cmath>
#include <cstdint>
#include <cstdio>
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

TEST_F(TimeColumn, TimesSince1970AreKnownByTheirSize) {
  for (const auto& [first, second] :
       {std::pair{"1700000000.5", "1700000000.75"}, std::pair{"1700000000500", "1700000000750"},
        std::pair{"1700000000500000", "1700000000750000"}, std::pair{"1700000000500000000", "1700000000750000000"}}) {
    const auto file = write("a.csv", "timestamp,f\n" + std::string(first) + ",1\n" + second + ",1\n");
    const auto signal = read({.file = file, .variable = "f"});
    ASSERT_TRUE(signal) << first << describe(signal.error());
    EXPECT_NEAR(signal->sample_time_s.value_or(0.0), 0.25, 1e-6) << first;
    EXPECT_TRUE(signal->time_unit_stated);
  }
  const auto small = write("b.csv", "t,f\n0,1\n5,1\n");
  EXPECT_FALSE(read({.file = small, .variable = "f"})->time_unit_stated);
  EXPECT_DOUBLE_EQ(read({.file = small, .variable = "f", .time_unit = "ms"})->sample_time_s.value_or(0.0), 0.005);
  EXPECT_TRUE(says(refusal({.file = small, .variable = "f", .time_unit = "days"}), "'days'; times are in s, ms"));
}

TEST_F(TimeColumn, PairsOfSecondsAndTheirPartsAndDatesAreTimes) {
  for (const char* text :
       {"sec,nanosec,f\n1700000000,999000000,1\n1700000001,1000000,1\n",
        "header.stamp.sec,header.stamp.nanosec,f\n5,999000000,1\n6,1000000,1\n",
        "time_secs,time_nsecs,f\n5,999000000,1\n6,1000000,1\n", "tv_sec,tv_usec,f\n5,999000,1\n6,1000,1\n",
        "time,f\n2024-02-29T23:59:59.999Z,1\n2024-03-01T00:00:00.001Z,1\n",
        "timestamp,f\n2024-01-15 10:20:30.125,1\n2024-01-15 10:20:30.127,1\n",
        "time,f\n2024-01-15T10:20:30.125+01:00,1\n2024-01-15T10:20:30.127+01:00,1\n",
        "time,f\n10:20:59.999,1\n10:21:00.001,1\n"}) {
    const auto signal = read({.file = write("a.csv", text), .variable = "f"});
    ASSERT_TRUE(signal) << text << describe(signal.error());
    EXPECT_NEAR(signal->sample_time_s.value_or(0.0), 0.002, 1e-9) << text;
  }
  const auto file = write("b.csv", "a_sec,a_nanosec,f\n5,999000000,1\n6,1000000,1\n");
  EXPECT_NEAR(*read({.file = file, .variable = "f", .time = "a_sec,a_nanosec"})->sample_time_s, 0.002, 1e-9);
  EXPECT_TRUE(says(refusal({.file = file, .variable = "f", .time = "a_nanosec,f"}), "is no pair"));
  EXPECT_TRUE(says(refusal({.file = write("c.csv", "time,f\n10:20:59.9,1\nlater,1\n"), .variable = "f"}),
                   "'later' in column 'time' is not a time of day"));
}

TEST_F(TimeColumn, JitterIsInterpolatedAndALostSampleIsStillRefused) {
  // A sine of 20 Hz, sampled about every 2 ms, up to 30 % of a step early or late.
  const auto table = [](double share, int lost) {
    std::uint32_t state = 7;
    std::string text = "time,f\n";
    for (int i = 0; i < 1000; ++i) {
      state = state * 1664525U + 1013904223U;
      const double t = 0.002 * (i + share * (static_cast<double>(state >> 8U) / 8388608.0 - 1.0));
      char line[64];
      std::snprintf(line, sizeof line, "%.9f,%.9f\n", t, std::sin(2.0 * 3.14159265358979 * 20.0 * t));
      if (i != lost) text += line;
    }
    return text;
  };
  for (const double share : {0.12, 0.2, 0.3}) {
    const auto signal = read({.file = write("a.csv", table(share, -1)), .variable = "f"});
    ASSERT_TRUE(signal) << share << describe(signal.error());
    ASSERT_TRUE(signal->jitter_s);
    EXPECT_NEAR(*signal->jitter_s, 0.002 * share / std::sqrt(3.0), 0.0001);
    EXPECT_NEAR(*signal->sample_time_s, 0.002, 2e-6);
    const auto first_s = 0.002 * share;  // at most off by this
    for (std::size_t i = 1; i + 1 < signal->values.size(); ++i) {
      // Compared with the sine through the first zero, the whole may be shifted by the first sample's jitter.
      EXPECT_NEAR(signal->values[i],
                  std::sin(2.0 * 3.14159265358979 * 20.0 * *signal->sample_time_s * static_cast<double>(i)),
                  0.01 + 2.0 * 3.14159265358979 * 20.0 * 2.0 * first_s);
    }
    for (const int lost : {1, 2, 300, 500, 997}) {
      const auto refused = read({.file = write("b.csv", table(share, lost)), .variable = "f"});
      ASSERT_FALSE(refused) << share << " " << lost;
      EXPECT_TRUE(says(refused.error().message, "not uniform"));
    }
  }
  const std::string note = jitter_note(0.0004, 0.002);
  EXPECT_TRUE(says(note, "0.4 ms rms, 20 % of a step")) << note;
  EXPECT_TRUE(says(note, "above 40 Hz")) << note;
  EXPECT_EQ(jitter_note(std::nullopt, 0.002), "");
}

TEST(TimeBase, UnequalSamplesOfASineComeToEqualStepsWithinATenthOfAPercent) {
  std::vector<double> time, values;
  for (int i = 0; i < 400; ++i) {
    time.push_back(0.001 * (i + (i == 0 || i == 399 ? 0.0 : 0.3 * std::sin(1.7 * i * i))));
    values.push_back(std::sin(2.0 * 3.14159265358979 * 25.0 * time.back()));
  }
  const std::vector<double> equal = at_equal_steps(time, values);
  for (int i = 0; i < 400; ++i) {
    EXPECT_NEAR(equal[static_cast<std::size_t>(i)], std::sin(2.0 * 3.14159265358979 * 25.0 * 0.001 * i), 1e-3) << i;
  }
}

TEST(TimeBase, AStepThatNoRecordingHasIsRefusedWithTheUnitThatWouldMakeSense) {
  EXPECT_FALSE(check_step(0.001, false));
  EXPECT_FALSE(check_step(0.1, false));
  const Check milliseconds = check_step(5.0, false);
  ASSERT_TRUE(milliseconds);
  EXPECT_TRUE(says(milliseconds->message, "5 s apart")) << milliseconds->message;
  EXPECT_TRUE(says(milliseconds->message, "in ms it would be 5 ms (--time-unit ms)")) << milliseconds->message;
  const Check nanoseconds = check_step(1e6, false);
  ASSERT_TRUE(nanoseconds);
  EXPECT_TRUE(says(nanoseconds->message, "in ns it would be 1 ms")) << nanoseconds->message;
  EXPECT_FALSE(says(check_step(1e6, true)->message, "in ns it would")) << "the unit is known";
  EXPECT_TRUE(check_step(1e-9, true));
}

TEST(TimeBase, AMeasuredVelocityShowsATimeThatIsOffByAThousand) {
  std::vector<double> position, velocity;
  for (int i = 0; i < 500; ++i) {
    position.push_back(0.3 * std::sin(0.01 * i));
    velocity.push_back(0.3 * 10.0 * std::cos(0.01 * i));  // every ms
  }
  EXPECT_EQ(step_is_too_long_by(position, velocity, 0.001), std::nullopt);
  EXPECT_EQ(step_is_too_long_by(position, velocity, 1.0), 1e3);
  EXPECT_EQ(step_is_too_long_by(position, velocity, 1e-6), 1e-3);
  for (double& v : velocity) v *= 57.3;
  EXPECT_EQ(step_is_too_long_by(position, velocity, 0.001), std::nullopt) << "degrees are not a unit of time";
  EXPECT_TRUE(says(contradicted_by_velocity("dq", 1e3, 1.0).message, "1 s apart, but by the measured velocity 'dq'"));
}

TEST_F(TimeColumn, ANamedTimeColumnTakesTheRoleOfTheOneCalledTime) {
  const auto file = write("a.csv", "time_s,clock_ms,f\n0,0,1\n0,2,2\n0,4,3\n");
  EXPECT_EQ(read({.file = file, .variable = "f", .time = "clock"})->sample_time_s, 0.002);
}

}  // namespace
}  // namespace tactus::recording
