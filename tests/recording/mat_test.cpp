// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <string>

#include "tests/recording/files.hpp"

namespace tactus::recording {
namespace {

using Mat = RecordingFiles;
using Values = std::vector<double>;
constexpr matio_compression both[] = {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB};

TEST_F(Mat, AColumnOfAStructInAStructArrayIsReadCompressedAndNotShortAndLong) {
  // matio keeps short members of a compressed struct apart from long ones, so both lengths are tried.
  for (const matio_compression compression : both) {
    for (const std::size_t samples : {2U, 10U, 9000U}) {
      const auto file = write_mat(path("a.mat"), {matrix("Ts", 1, 1, {0.5}), scope("scope", samples)}, compression);
      const auto signal = read({.file = file, .variable = "scope.signals(2).values", .column = 2});
      ASSERT_TRUE(signal) << describe(signal.error());
      ASSERT_EQ(signal->values.size(), samples);
      for (std::size_t i = 0; i < samples; ++i) ASSERT_EQ(signal->values[i], -200.0 - static_cast<double>(i));
      EXPECT_EQ(signal->name, "scope.signals(2).values(:,2)");
      EXPECT_EQ(signal->unit, "");
      ASSERT_TRUE(signal->sample_time_s);
      EXPECT_DOUBLE_EQ(*signal->sample_time_s, 0.0005);
    }
  }
}

TEST_F(Mat, AnIndexOfOneOnASingleStructMayBeWrittenOrLeftOut) {
  const auto file = write_mat(path("a.mat"), {scope("scope", 5)}, MAT_COMPRESSION_ZLIB);
  for (const char* name : {"scope.time", "scope(1).time"}) EXPECT_TRUE(read({.file = file, .variable = name})) << name;
  for (const char* name :
       {"scope.time(1)", "scope(2).time", "scope.signals.values", "scope.signals(4).values", "scope.signals(0).values",
        "scope.signals(x).values", "scope.", ".", "", "(1)", "scope(1)"}) {
    EXPECT_FALSE(read({.file = file, .variable = name})) << name;
  }
  EXPECT_EQ(read({.file = file, .variable = "scope(1).signals(1).values"})->values, (Values{100, 101, 102, 103, 104}));
}

TEST_F(Mat, EveryClassOfNumberReadsAsTheSameNumbers) {
  const Values expected{0, 1, 100};
  for (const matio_compression compression : both) {
    const auto file = write_mat(path("a.mat"),
                                {matrix<double>("d", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, 1, {0, 1, 100}),
                                 matrix<float>("f", MAT_C_SINGLE, MAT_T_SINGLE, 3, 1, {0, 1, 100}),
                                 matrix<std::int8_t>("i8", MAT_C_INT8, MAT_T_INT8, 3, 1, {0, 1, 100}),
                                 matrix<std::uint8_t>("u8", MAT_C_UINT8, MAT_T_UINT8, 3, 1, {0, 1, 100}),
                                 matrix<std::int16_t>("i16", MAT_C_INT16, MAT_T_INT16, 3, 1, {0, 1, 100}),
                                 matrix<std::uint16_t>("u16", MAT_C_UINT16, MAT_T_UINT16, 3, 1, {0, 1, 100}),
                                 matrix<std::int32_t>("i32", MAT_C_INT32, MAT_T_INT32, 3, 1, {0, 1, 100}),
                                 matrix<std::uint32_t>("u32", MAT_C_UINT32, MAT_T_UINT32, 3, 1, {0, 1, 100}),
                                 matrix<std::int64_t>("i64", MAT_C_INT64, MAT_T_INT64, 3, 1, {0, 1, 100}),
                                 matrix<std::uint64_t>("u64", MAT_C_UINT64, MAT_T_UINT64, 3, 1, {0, 1, 100})},
                                compression);
    for (const char* name : {"d", "f", "i8", "u8", "i16", "u16", "i32", "u32", "i64", "u64"}) {
      const auto signal = read({.file = file, .variable = name});
      ASSERT_TRUE(signal) << name << describe(signal.error());
      EXPECT_EQ(signal->values, expected) << name;
    }
  }
}

TEST_F(Mat, ARowVectorIsOneColumnOfSamples) {
  const auto file = write_mat(path("a.mat"), {matrix("row", 1, 3, {1, 2, 3})}, MAT_COMPRESSION_NONE);
  const auto signal = read({.file = file, .variable = "row"});
  ASSERT_TRUE(signal) << describe(signal.error());
  EXPECT_EQ(signal->values, (Values{1, 2, 3}));
  EXPECT_EQ(signal->name, "row");
  EXPECT_TRUE(says(refusal({.file = file, .variable = "row", .column = 2}), "has 1 columns of 3 samples"));
}

TEST_F(Mat, SignalsInRowsAreReadAsSignals) {
  // Time and two signals in the rows of one variable, as Simulink's To File block writes them.
  std::vector<double> columns;
  for (int i = 0; i < 50; ++i) columns.insert(columns.end(), {0.002 * i, 10.0 + i, -20.0 - i});
  for (const matio_compression compression : both) {
    const auto file = write_mat(path("a.mat"), {matrix("ans", 3, 50, columns)}, compression);
    const auto signal = read({.file = file, .variable = "ans", .column = 3, .time = "ans"});
    ASSERT_TRUE(signal) << describe(signal.error());
    ASSERT_EQ(signal->values.size(), 50U);
    EXPECT_EQ(signal->values[7], -27.0);
    EXPECT_EQ(signal->name, "ans(3,:)");
    EXPECT_DOUBLE_EQ(signal->sample_time_s.value_or(0.0), 0.002);
    EXPECT_EQ(read({.file = file, .variable = "ans", .column = 2, .time = "ans:1"})->values[49], 59.0);
    EXPECT_EQ(contents(file)->front().rows, 50);
    EXPECT_EQ(contents(file)->front().columns, 3);
    const auto lists = read_columns(file, std::vector<std::string>{"ans:1", "ans:2:3"});
    ASSERT_TRUE(lists) << describe(lists.error());
    EXPECT_EQ((*lists)[1][1].values[0], -20.0);
    EXPECT_TRUE(says(refusal({.file = file, .variable = "ans", .column = 4}), "has 3 columns of 50 samples"));
  }
}

TEST_F(Mat, AFileInTheOtherByteOrderReadsAlike) {
  // Written by hand after the format's specification: a 2 x 1 matrix of doubles called `x`, values 1 and -2.
  std::string text(124, ' ');
  text.replace(0, 10, "MATLAB 5.0");
  text += std::string("\x01\x00MI", 4);
  const auto word = [&text](std::uint32_t value) {
    for (int shift = 24; shift >= 0; shift -= 8)
      text += static_cast<char>(value >> static_cast<unsigned>(shift) & 0xffU);
  };
  for (const std::uint32_t value : {14U, 72U, 6U, 8U, 6U, 0U, 5U, 8U, 2U, 1U}) word(value);
  word(1U);
  word(1U);
  text += std::string("x\0\0\0\0\0\0\0", 8);
  word(9U);
  word(16U);
  for (const std::uint32_t value : {0x3ff00000U, 0U, 0xc0000000U, 0U}) word(value);
  const auto signal = read({.file = write("a.mat", text), .variable = "x"});
  ASSERT_TRUE(signal) << describe(signal.error());
  EXPECT_EQ(signal->values, (Values{1.0, -2.0}));
}

TEST_F(Mat, ContentsUnfoldsStructsAndTellsWhatIsReadable) {
  const auto file = write_mat(path("a.mat"), {matrix("Ts", 1, 1, {0.5}), scope("scope", 7)}, MAT_COMPRESSION_ZLIB);
  const auto entries = contents(file);
  ASSERT_TRUE(entries) << describe(entries.error());
  std::string seen;
  for (const Entry& e : *entries) {
    seen += e.name + " " + std::to_string(e.rows) + "x" + std::to_string(e.columns) + " " + e.kind +
            (e.readable ? "+" : "-") + "\n";
  }
  EXPECT_EQ(seen,
            "Ts 1x1 double-\nscope.time 7x1 double+\n"
            "scope.signals(1).values 7x2 double+\nscope.signals(1).label 1x6 char-\n"
            "scope.signals(2).values 7x2 double+\nscope.signals(2).label 1x6 char-\n"
            "scope.signals(3).values 7x2 double+\nscope.signals(3).label 1x6 char-\n");
}

TEST_F(Mat, AMissingVariableIsAnsweredWithTheNearestNameAndTheSignalsInTheFile) {
  const auto file = write_mat(path("a.mat"), {scope("scope", 5)}, MAT_COMPRESSION_ZLIB);
  const std::string said = refusal({.file = file, .variable = "scope.signal(2).values"});
  EXPECT_TRUE(says(said, "did you mean 'scope.signals(2).values'?")) << said;
  EXPECT_TRUE(says(said, "'scope.time' (5 x 1 double), 'scope.signals(1).values' (5 x 2 double)")) << said;
  EXPECT_TRUE(says(refusal({.file = file, .variable = "scope.signals"}), "is a struct; name one of its fields"));
}

TEST_F(Mat, WhatIsNoMatrixOfRealNumbersIsRefusedWithItsClass) {
  std::size_t two[] = {2, 1};
  std::size_t cube[] = {2, 2, 2};
  std::string text = "ab";
  double parts[] = {1, 2, 3, 4, 5, 6, 7, 8};
  mat_complex_split_t complex_parts{parts, parts + 2};
  mat_uint32_t rows[] = {0, 1};
  mat_uint32_t columns[] = {0, 2};
  mat_sparse_t sparse{2, rows, 2, columns, 2, 2, parts};
  for (const matio_compression compression : both) {
    matvar_t* cells[] = {matrix("", 2, 1, {1, 2}), matrix("", 2, 1, {3, 4})};
    const std::vector<matvar_t*> variables{
        Mat_VarCreate("text", MAT_C_CHAR, MAT_T_UTF8, 2, two, text.data(), 0),
        Mat_VarCreate("complex", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, two, &complex_parts, MAT_F_COMPLEX),
        Mat_VarCreate("cube", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, cube, parts, 0),
        Mat_VarCreate("sparse", MAT_C_SPARSE, MAT_T_DOUBLE, 2, two, &sparse, MAT_F_DONT_COPY_DATA),
        Mat_VarCreate("cells", MAT_C_CELL, MAT_T_CELL, 2, two, cells, 0),
        matrix("good", 2, 1, {1, 2})};
    const auto file = write_mat(path("a.mat"), variables, compression);
    for (const auto& [name, kind] : {std::pair{"text", "class char"}, std::pair{"complex", "class complex double"},
                                     std::pair{"cube", "double of 3 dimensions"}, std::pair{"sparse", "class sparse"},
                                     std::pair{"cells", "class cell"}}) {
      const auto signal = read({.file = file, .variable = name});
      ASSERT_FALSE(signal) << name;
      EXPECT_EQ(signal.error().code, ErrorCode::wrong_type);
      EXPECT_TRUE(says(signal.error().message, kind)) << describe(signal.error());
    }
    EXPECT_TRUE(read({.file = file, .variable = "good"}));
  }
}

TEST_F(Mat, AColumnOutOfRangeTooFewSamplesAndValuesThatAreNotFiniteAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto file = write_mat(path("a.mat"),
                              {matrix("x", 3, 2, {1, 2, 3, 4, nan, 6}), matrix("one", 1, 1, {1}),
                               matrix("none", 0, 0, {}), matrix("huge", 2, 1, {1e30, -9e307})},
                              MAT_COMPRESSION_ZLIB);
  EXPECT_TRUE(says(refusal({.file = file, .variable = "huge"}), "sample 2 of 'huge' is beyond 1e30"));
  for (const std::int64_t column :
       {std::int64_t{0}, std::int64_t{-1}, std::int64_t{3}, std::numeric_limits<std::int64_t>::max()}) {
    const auto error = read({.file = file, .variable = "x", .column = column}).error();
    EXPECT_EQ(error.parameter, "column");
    EXPECT_EQ(error.code, ErrorCode::out_of_bounds);
  }
  EXPECT_TRUE(read({.file = file, .variable = "x", .column = 1}));
  EXPECT_TRUE(says(refusal({.file = file, .variable = "x", .column = 2}), "sample 2 of 'x(:,2)' is not finite"));
  EXPECT_TRUE(says(refusal({.file = file, .variable = "one"}), "holds 1 samples"));
  EXPECT_FALSE(read({.file = file, .variable = "none"}));
}

TEST_F(Mat, TimesAreTheNearestThatFitUnlessOthersAreNamed) {
  const auto file = write_mat(path("a.mat"),
                              {matrix("time", 4, 1, {0, 2, 4, 6}), matrix("x", 4, 1, {1, 2, 3, 4}),
                               matrix("y", 3, 1, {1, 2, 3}), matrix("clock", 4, 1, {0, 1, 2, 3}), scope("scope", 4)},
                              MAT_COMPRESSION_ZLIB);
  EXPECT_EQ(read({.file = file, .variable = "x"})->sample_time_s, 2.0);
  EXPECT_EQ(read({.file = file, .variable = "x", .time = "clock"})->sample_time_s, 1.0);
  EXPECT_EQ(read({.file = file, .variable = "scope.signals(1).values"})->sample_time_s, 0.0005);
  EXPECT_EQ(read({.file = file, .variable = "y"})->sample_time_s, std::nullopt);
  EXPECT_TRUE(says(refusal({.file = file, .variable = "y", .time = "clock"}), "has 4 samples where 'y' has 3"));
  EXPECT_TRUE(says(refusal({.file = file, .variable = "x", .sample_time_s = 1.0}), "contradicts"));
}

TEST_F(Mat, AVariableCalledTHoldsTimesWhereNoneIsCalledTime) {
  const auto file = write_mat(path("a.mat"), {matrix("t", 1, 4, {0, 2, 4, 6}), matrix("x", 4, 1, {1, 2, 3, 4})},
                              MAT_COMPRESSION_NONE);
  EXPECT_EQ(read({.file = file, .variable = "x"})->sample_time_s, 2.0);
}

TEST_F(Mat, AFileThatIsNoVersionFiveFileIsRefusedWithTheRemedy) {
  EXPECT_TRUE(says(refusal({.file = write("a.mat", "hello"), .variable = "x"}), "is not a MATLAB file of version 5"));
  EXPECT_TRUE(says(refusal({.file = write("b.mat", ""), .variable = "x"}), "is not a MATLAB file of version 5"));
  EXPECT_TRUE(says(refusal({.file = path("c.mat"), .variable = "x"}), "does not exist"));
  mat_t* hdf5 = Mat_CreateVer(path("d.mat").c_str(), nullptr, MAT_FT_MAT73);
  ASSERT_NE(hdf5, nullptr);
  Mat_Close(hdf5);
  EXPECT_TRUE(says(refusal({.file = path("d.mat"), .variable = "x"}), "save it with '-v7'"));
  mat_t* old = Mat_CreateVer(path("e.mat").c_str(), nullptr, MAT_FT_MAT4);
  matvar_t* x = matrix("x", 2, 1, {1, 2});
  Mat_VarWrite(old, x, MAT_COMPRESSION_NONE);
  Mat_VarFree(x);
  Mat_Close(old);
  EXPECT_TRUE(says(refusal({.file = path("e.mat"), .variable = "x"}), "is not a MATLAB file of version 5"));
}

TEST_F(Mat, ColumnsOfAVariableAreChosenTogether) {
  const auto file = write_mat(path("a.mat"), {matrix("q", 2, 3, {1, 2, 3, 4, 5, 6}), matrix("t", 2, 1, {0, 1})},
                              MAT_COMPRESSION_NONE);
  const auto lists = read_columns(file, std::vector<std::string>{"t", "q", "q:2", "q:2:3"});
  ASSERT_TRUE(lists) << describe(lists.error());
  EXPECT_EQ((*lists)[0].size(), 1U);
  EXPECT_EQ((*lists)[1].size(), 3U);
  EXPECT_EQ((*lists)[2][0].values, (Values{3, 4}));
  ASSERT_EQ((*lists)[3].size(), 2U);
  EXPECT_EQ((*lists)[3][1].values, (Values{5, 6}));
  for (const char* wrong : {"p", "q:4", "q:0", "q:2:1", "q:x", "p:1"}) {
    EXPECT_FALSE(read_columns(file, std::vector<std::string>{wrong})) << wrong;
  }
}

}  // namespace
}  // namespace tactus::recording
