// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <locale>
#include <string>

#include "tests/recording/files.hpp"

namespace tactus::recording {
namespace {

using Csv = RecordingFiles;
using Values = std::vector<double>;

TEST_F(Csv, AColumnIsFoundByItsNameWithOrWithoutItsUnitInEveryStyleOfHeader) {
  for (const std::string header : {"time [s],force [N]", "time (s),force (N)", "time_s,force_N", "force_N,time_s"}) {
    const bool force_first = header.starts_with("force");
    const auto file = write("a.csv", header + (force_first ? "\n1.5,0\n-2,0.25\n" : "\n0,1.5\n0.25,-2\n"));
    for (const std::string& name :
         {std::string("force"), force_first ? "force_N" : header.substr(header.find(',') + 1)}) {
      const Result<Signal> signal = read({.file = file, .variable = name});
      ASSERT_TRUE(signal) << describe(signal.error());
      EXPECT_EQ(signal->values, (Values{1.5, -2.0}));
      EXPECT_EQ(signal->name, "force");
      EXPECT_EQ(signal->unit, "N");
      EXPECT_EQ(signal->sample_time_s, 0.25);
    }
  }
}

TEST_F(Csv, SuffixesOfSiteAreNotTakenForUnitsWhereAUnitFollows) {
  const auto file = write("a.csv", "x_m_m,x_s_m,tau_m_N_m,b_N_s_per_m\n1,2,3,4\n5,6,7,8\n");
  const auto entries = contents(file);
  ASSERT_TRUE(entries);
  std::string seen;
  for (const Entry& entry : *entries) seen += entry.name + "|" + entry.unit + " ";
  EXPECT_EQ(seen, "x_m|m x_s|m tau_m|N m b|N s/m ");
}

TEST_F(Csv, CommasSemicolonsAndTabsSeparateAndBlanksQuotesBomAndCarriageReturnsDoNotMatter) {
  const Values expected{1e-3, -2.5};
  for (const std::string text :
       {"a,force [N]\n0,1e-3\n0,-2.5", "a;force [N]\n0;0.001\n0;-2.5\n\n\n", "a\tforce [N]\n\t+0.001\n0\t-2.5\t\n",
        "\xEF\xBB\xBF# recorded today\r\n\r\n#b\r\na , \"force [N]\"\r\n0, 0.001\r\n0,\" -2.5 \"\r\n",
        "\"a, b; \"\"c\"\";;\",force [N]\nwords,1e-3\n\"more, words\",-2.5\n"}) {
    const bool one_too_many = text.ends_with("-2.5\t\n");
    const auto signal =
        read({.file = write("a.csv", one_too_many ? text.substr(0, text.size() - 2) : text), .variable = "force"});
    ASSERT_TRUE(signal) << text << describe(signal.error());
    EXPECT_EQ(signal->values, expected) << text;
  }
}

struct DecimalComma : std::numpunct<char> {
  [[nodiscard]] char do_decimal_point() const override { return ','; }
};

TEST_F(Csv, NumbersReadAlikeUnderALocaleWithDecimalCommas) {
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  const auto signal = read({.file = write("a.csv", "f\n0.1\n2.5e-3\n"), .variable = "f"});
  std::locale::global(before);
  ASSERT_TRUE(signal) << describe(signal.error());
  EXPECT_EQ(signal->values, (Values{0.1, 0.0025}));
}

TEST_F(Csv, EveryValueReadsBackAsTheNumberThatWasWritten) {
  std::string text = "time [ms],force [N]\n";
  Values written;
  for (int i = 0; i < 20000; ++i) {
    written.push_back(std::sin(0.37 * i) * std::pow(10.0, i % 30 - 15));
    char line[64];
    std::snprintf(line, sizeof line, "%.1f,%.17g\n", 0.5 * i, written.back());
    text += line;
  }
  const auto signal = read({.file = write("a.csv", text), .variable = "force"});
  ASSERT_TRUE(signal) << describe(signal.error());
  EXPECT_EQ(signal->values, written);
  EXPECT_EQ(signal->sample_time_s, 0.0005);
}

TEST_F(Csv, ContentsListsEachColumnWithItsUnitAndLength) {
  const auto entries = contents(write("a.csv", "time [s],force_N,note\n0,1,x\n1,2,y\n2,3,z\n"));
  ASSERT_TRUE(entries);
  ASSERT_EQ(entries->size(), 3U);
  EXPECT_EQ((*entries)[1].name, "force");
  EXPECT_EQ((*entries)[1].unit, "N");
  EXPECT_EQ((*entries)[1].rows, 3);
  EXPECT_EQ((*entries)[2].unit, "");
}

TEST_F(Csv, AMissingColumnIsAnsweredWithTheNearestNameAndTheList) {
  const auto file = write("a.csv", "time [s],force [N]\n0,1\n1,2\n");
  EXPECT_EQ(
      refusal({.file = file, .variable = "forse"}),
      "variable: '" + file.string() + "' has no 'forse' (did you mean 'force'?); it has: 'time' in s, 'force' in N");
  EXPECT_EQ(read({.file = file, .variable = "forse"}).error().code, ErrorCode::missing);
  EXPECT_TRUE(says(refusal({.file = file, .variable = "force", .time = "tim"}), "time: '" + file.string()));
  EXPECT_TRUE(says(refusal({.file = file, .variable = ""}), "has no ''"));
}

TEST_F(Csv, AnAmbiguousNameIsRefusedAndTheFullHeaderResolvesIt) {
  const auto file = write("a.csv", "x_mm,x_cm\n1,2\n3,4\n");
  EXPECT_TRUE(says(refusal({.file = file, .variable = "x"}), "'x_mm' and 'x_cm'"));
  EXPECT_EQ(read({.file = file, .variable = "x_cm"})->values, (Values{2, 4}));
}

TEST_F(Csv, ADefectIsNamedWithItsLineItsCharacterTheTextAndTheRemedy) {
  struct Case {
    const char* text;
    const char* place;
    const char* said;
  };
  for (const Case& c :
       {Case{"# c\ntime_s,force_N\n0,1\n1,abc\n2,3\n", ":4:3", "'abc' in column 'force_N' is not a number"},
        Case{"time_s;force_N\n0;1.5\n1;  1,5\n", ":3:5", "write a decimal point"},
        Case{"time_s,force_N\n0,1\n1,nan\n", ":3:3", "is not finite"},
        Case{"time_s,force_N\n0,1\n1,-inf\n", ":3:3", "is not finite"},
        Case{"time_s,force_N\n0,1\n1,-9e307\n", ":3:3", "is beyond 1e30"},
        Case{"time_s,force_N\n0,1\n1,1.1e30\n", ":3:3", "is beyond 1e30"},
        Case{"time_s,force_N\n0,1\n1,1e999\n", ":3:3", "beyond the range"},
        Case{"time_s,force_N\n0,1\n1,\n2,3\n", ":3:3", "is empty"},
        Case{"time_s,force_N\n0,1\n1,2,3\n", ":3", "has 3 fields where the header has 2"},
        Case{"time_s,force_N\n0,1\n\n1,2\n", ":3", "has 1 fields where the header has 2"},
        Case{"time_s,force_N\n0,1\n1,\"2\n3,4\n", ":3", "quote is not closed"},
        Case{"time_s,\"force_N\n0,1\n1,2\n", ":1", "quote is not closed"},
        Case{"time_s,force_N\n0,+-1\n1,2\n", ":2:3", "is not a number"},
        Case{"#recorded today by me\n0,1\n1,2\n", ":2", "a header is needed before the numbers '0,1'"},
        Case{"time_s,force_N\n0,1\n", "", "holds 1 samples"},
        Case{"time_s,force_N\n", "", "holds 0 samples"},
        Case{"", "", "is empty"},
        Case{"# only\n\n", "", "is empty"},
        Case{"\xFF\xFEt\n", "", "UTF-16"},
        Case{"\xFF\xFE", "", "UTF-16"}}) {
    const auto file = write("a.csv", c.text);
    const Result<Signal> result = read({.file = file, .variable = "force"});
    ASSERT_FALSE(result) << c.text;
    EXPECT_EQ(result.error().place, file.string() + c.place) << c.text;
    EXPECT_TRUE(says(result.error().message, c.said)) << c.text << describe(result.error());
  }
  EXPECT_TRUE(
      says(refusal({.file = write("b.csv", std::string("a,b\n1,\0\n2,3\n", 12)), .variable = "a"}), "zero byte"));
}

TEST_F(Csv, ADefectInAColumnThatNobodyAskedForDoesNoHarm) {
  const auto file = write("a.csv", "note,force\nstart,1\n,2\nnan,3\n");
  EXPECT_EQ(read({.file = file, .variable = "force"})->values, (Values{1, 2, 3}));
}

TEST_F(Csv, AColumnNumberIsRefusedForATable) {
  EXPECT_TRUE(
      says(refusal({.file = write("a.csv", "a,b\n1,2\n3,4\n"), .variable = "a", .column = 2}), "column: 2 chooses"));
}

TEST_F(Csv, AFileThatIsNotThereOrOfNoKnownFormatIsRefusedByName) {
  EXPECT_TRUE(says(refusal({.file = path("no.csv"), .variable = "a"}),
                   "file: '" + path("no.csv").string() + "' does not exist"));
  EXPECT_EQ(read({.file = path("no.csv"), .variable = "a"}).error().code, ErrorCode::missing);
  EXPECT_TRUE(says(refusal({.file = write("a.xlsx", "x"), .variable = "a"}), "must end in .csv, .tsv, .txt"));
  EXPECT_TRUE(says(refusal({.file = path(""), .variable = "a"}), "is not a file"));
  EXPECT_FALSE(contents(path("no.csv")));
}

TEST_F(Csv, ColumnsAreChosenByNameNumberAndRangeWithAHeaderOrWithout) {
  const auto with_header = write("a.csv", "t,q1 [rad],q2 [rad]\n0,1,2\n1,3,4\n");
  const std::vector<std::string> choices{"t", "q1:q2", "3,q1"};
  const auto lists = read_columns(with_header, choices);
  ASSERT_TRUE(lists) << describe(lists.error());
  ASSERT_EQ((*lists)[1].size(), 2U);
  EXPECT_EQ((*lists)[1][0].unit, "rad");
  EXPECT_EQ((*lists)[1][1].values, (std::vector<double>{2.0, 4.0}));
  EXPECT_EQ((*lists)[2][0].name, "q2");
  EXPECT_EQ((*lists)[2][1].name, "q1");
  for (const char* text : {"0,1,2\n1,3,4\n", "# t q1 q2\n 0  1 2\n1 3\t4 \n", "0;1;2\n1;3;4\n"}) {
    const auto plain = read_columns(write("b.txt", text), std::vector<std::string>{"1", "2:3"});
    ASSERT_TRUE(plain) << describe(plain.error());
    EXPECT_EQ((*plain)[0][0].values, (std::vector<double>{0.0, 1.0}));
    EXPECT_EQ((*plain)[1][1].values, (std::vector<double>{2.0, 4.0}));
  }
  for (const char* wrong : {"q3", "0", "4", "q2:q1", "q1:", "", "t,", "2:x", "-1"}) {
    const auto refused = read_columns(with_header, std::vector<std::string>{wrong});
    ASSERT_FALSE(refused) << wrong;
    EXPECT_FALSE(refused.error().message.empty());
  }
}

}  // namespace
}  // namespace tactus::recording
