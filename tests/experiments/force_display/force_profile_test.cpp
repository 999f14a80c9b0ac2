// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/force_display/force_display.hpp>

#include <cmath>
#include <functional>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "tests/experiments/force_display/scratch.hpp"
#include <gtest/gtest.h>
#include <matio.h>

namespace tactus::experiments {
namespace force_profile_test {

class ForceProfile : public Scratch {
 protected:
  /// A table of `samples` rows at 2 kHz with a time and one column of `value(time)`.
  std::string table(const std::string& header, std::size_t samples, const std::function<double(double)>& value) const {
    std::ostringstream text;
    text.precision(17);
    text << "time_s," << header << "\n";
    for (std::size_t i = 0; i < samples; ++i) {
      const double time_s = 0.0005 * static_cast<double>(i);
      text << time_s << "," << value(time_s) << "\n";
    }
    return write("recording.csv", text.str());
  }

  static ForceDisplayParams playing(const std::string& file, const std::string& variable) {
    ForceDisplayParams params;
    params.profile.file = file;
    params.profile.variable = variable;
    return params;
  }
  static std::vector<double> loaded(const ForceDisplayParams& params) {
    const auto profile = load_profile(params);
    EXPECT_TRUE(profile) << (profile ? "" : describe(profile.error()));
    return profile ? *profile : std::vector<double>{};
  }
  static Error refusal(const ForceDisplayParams& params) {
    const auto profile = load_profile(params);
    EXPECT_FALSE(profile) << "was loaded";
    return profile ? Error{} : profile.error();
  }
};

/// A half-sine of 8 ms that begins at 10 ms.
double pulse(double time_s) {
  const double phase = (time_s - 0.010) / 0.008;
  return phase > 0.0 && phase < 1.0 ? std::sin(std::numbers::pi * phase) : 0.0;
}

TEST_F(ForceProfile, WithoutAFileIsTheSyntheticTransient) {
  ForceDisplayParams params;
  params.profile.duration_s = 0.02;
  params.profile.frequency_Hz = 125.0;
  params.profile.decay_time_s = 0.01;
  params.task.force_limit_N = 0.8;
  const auto profile = loaded(params);
  ASSERT_EQ(profile.size(), 100U);
  EXPECT_DOUBLE_EQ(profile.front(), 0.8);
  EXPECT_NEAR(profile[20], -0.8 * std::exp(-0.4), 1e-12);  // 4 ms: half a period
  EXPECT_NEAR(profile[50], 0.0, 1e-12);                    // 10 ms: 1.25 periods
  EXPECT_NEAR(profile[80], 0.8 * std::exp(-1.6), 1e-12);   // 16 ms: two periods
}

TEST_F(ForceProfile, ARecordingIsBroughtToTheServoRateAndItsPeakToTheLimit) {
  ForceDisplayParams params = playing(table("force_N", 100, [](double t) { return 37.0 * pulse(t); }), "force_N");
  params.profile.duration_s = 0.04;
  const auto profile = loaded(params);
  // 80 samples of 0.5 ms reach from 0 to 39.5 ms: 198 ticks of 0.2 ms.
  ASSERT_EQ(profile.size(), 198U);
  for (std::size_t i = 0; i < profile.size(); ++i) {
    // The cubic through the samples cuts the corners at both ends of the pulse by a few percent.
    EXPECT_NEAR(profile[i], pulse(2e-4 * static_cast<double>(i)), 0.03) << i;
  }
}

TEST_F(ForceProfile, AStatedScaleIsNewtonsPerUnitAndTheLimitCutsWhatIsBeyond) {
  ForceDisplayParams params = playing(table("torque_N_m", 100, [](double t) { return 0.1 * pulse(t); }), "torque");
  params.profile.duration_s = 0.04;
  params.profile.scale_N = -4.0;
  const auto profile = loaded(params);
  EXPECT_NEAR(profile[70], -0.4, 1e-3);  // 14 ms, the top
  params.profile.scale_N = 40.0;
  const auto clipped = loaded(params);
  EXPECT_EQ(clipped[70], params.task.force_limit_N);
  EXPECT_NEAR(clipped[0], 0.0, 1e-9);
}

TEST_F(ForceProfile, StartAndDurationCutThePieceOut) {
  ForceDisplayParams params = playing(table("force_N", 400, [](double t) { return 10.0 * t; }), "force");
  params.profile.start_s = 0.1;
  params.profile.duration_s = 0.02;
  params.profile.scale_N = 0.1;
  const auto profile = loaded(params);
  // 40 samples, 0.1 s to 0.1195 s, along a straight line.
  ASSERT_EQ(profile.size(), 98U);
  for (std::size_t i = 0; i < profile.size(); ++i) EXPECT_NEAR(profile[i], 0.1 + 2e-4 * static_cast<double>(i), 1e-12);
}

TEST_F(ForceProfile, APieceOutsideTheRecordingIsRefusedWithBothLengths) {
  ForceDisplayParams params = playing(table("force_N", 400, [](double t) { return 1.0 + t; }), "force");
  params.profile.start_s = 0.15;
  params.profile.duration_s = 0.06;
  const Error error = refusal(params);
  EXPECT_EQ(error.code, ErrorCode::inconsistent);
  EXPECT_EQ(error.parameter, "profile.start_s");
  EXPECT_NE(error.message.find("0.15 s to 0.21 s"), std::string::npos) << error.message;
  EXPECT_NE(error.message.find("recording of 0.2 s"), std::string::npos) << error.message;
  params.profile.start_s = 0.14;
  EXPECT_TRUE(load_profile(params));
}

TEST_F(ForceProfile, ASilentPieceIsRefusedWithAndWithoutAScale) {
  ForceDisplayParams params = playing(table("force_N", 400, [](double) { return 0.0; }), "force");
  for (const double scale_N : {0.0, 1.0}) {
    params.profile.scale_N = scale_N;
    const Error error = refusal(params);
    EXPECT_EQ(error.parameter, "profile.start_s");
    EXPECT_NE(error.message.find("zero throughout"), std::string::npos) << error.message;
  }
}

TEST_F(ForceProfile, AMissingColumnNamesTheNearest) {
  const Error error = refusal(playing(table("force_N", 100, pulse), "farce"));
  EXPECT_EQ(error.code, ErrorCode::missing);
  EXPECT_EQ(error.parameter, "profile.variable");
  EXPECT_NE(error.message.find("did you mean 'force'"), std::string::npos) << error.message;
}

TEST_F(ForceProfile, AMissingFileNamesIt) {
  const Error error = refusal(playing(path("nowhere.csv"), "force"));
  EXPECT_EQ(error.code, ErrorCode::missing);
  EXPECT_EQ(error.parameter, "profile.file");
  EXPECT_NE(error.message.find("nowhere.csv"), std::string::npos) << error.message;
}

TEST_F(ForceProfile, WithoutTimesTheSampleTimeMustBeGivenAndIsThenUsed) {
  std::string text = "force [N]\n";
  for (int i = 0; i < 100; ++i) text += std::to_string(i) + "\n";
  ForceDisplayParams params = playing(write("untimed.csv", text), "force");
  params.profile.duration_s = 0.01;
  const Error error = refusal(params);
  EXPECT_EQ(error.code, ErrorCode::missing);
  EXPECT_EQ(error.parameter, "profile.sample_time_s");
  params.profile.sample_time_s = 0.001;
  params.profile.scale_N = 0.1;
  const auto profile = loaded(params);
  ASSERT_EQ(profile.size(), 46U);  // 0 to 9 ms
  EXPECT_NEAR(profile[5], 0.1, 1e-12);
  EXPECT_NEAR(profile[45], 0.9, 1e-12);
}

TEST_F(ForceProfile, ASampleTimeThatContradictsTheFileIsRefused) {
  ForceDisplayParams params = playing(table("force_N", 400, pulse), "force");
  params.profile.sample_time_s = 0.001;
  EXPECT_EQ(refusal(params).parameter, "profile.sample_time_s");
}

TEST_F(ForceProfile, AColumnOfAMatlabVariableIsPlayed) {
  // 2 x the sample number in the first column, minus the sample number in the second, at 2 kHz.
  constexpr std::size_t samples = 200;
  std::vector<double> values(2 * samples), time(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    values[i] = 2.0 * static_cast<double>(i);
    values[samples + i] = -static_cast<double>(i);
    time[i] = 0.0005 * static_cast<double>(i);
  }
  const std::string file = path("recording.mat");
  mat_t* mat = Mat_CreateVer(file.c_str(), nullptr, MAT_FT_MAT5);
  ASSERT_NE(mat, nullptr);
  const auto put = [&](const char* name, std::size_t columns, std::vector<double>& data) {
    std::size_t dimensions[] = {samples, columns};
    matvar_t* variable = Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dimensions, data.data(), 0);
    EXPECT_EQ(Mat_VarWrite(mat, variable, MAT_COMPRESSION_ZLIB), 0);
    Mat_VarFree(variable);
  };
  put("time", 1, time);
  put("torque", 2, values);
  Mat_Close(mat);

  ForceDisplayParams params = playing(file, "torque");
  params.profile.column = 2;
  params.profile.start_s = 0.05;  // sample 100
  params.profile.duration_s = 0.01;
  params.profile.scale_N = 0.001;
  const auto profile = loaded(params);
  ASSERT_EQ(profile.size(), 48U);  // 20 samples, 0 to 9.5 ms
  for (std::size_t i = 0; i < profile.size(); ++i) {
    EXPECT_NEAR(profile[i], -0.1 - 0.001 * 0.4 * static_cast<double>(i), 1e-12);
  }
  params.profile.column = 3;
  EXPECT_EQ(refusal(params).parameter, "profile.column");
  params.profile.variable = "torqe";
  const Error error = refusal(params);
  EXPECT_NE(error.message.find("did you mean 'torque'"), std::string::npos) << error.message;
}

}  // namespace force_profile_test
}  // namespace tactus::experiments
