// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>

#include "tests/recording/files.hpp"

namespace tactus::recording {
namespace {

using Header = RecordingFiles;
using Values = std::vector<double>;

/// `NAME|UNIT ` of each column.
std::string columns_of(const std::filesystem::path& file) {
  const auto entries = contents(file);
  if (!entries) return describe(entries.error());
  std::string seen;
  for (const Entry& entry : *entries) seen += entry.name + "|" + entry.unit + " ";
  return seen;
}

TEST_F(Header, ASuffixIsAUnitOnlyWhereItFitsTheQuantity) {
  for (const auto& [head, seen] :
       {std::pair{"time,x_m,x_s", "time| x_m| x_s| "},
        std::pair{"t,q_m,q_s,tau_m,tau_s", "t| q_m| q_s| tau_m| tau_s| "},
        std::pair{"time_s,x_m,F_s", "time|s x_m| F_s| "}, std::pair{"time_s,x_m,drive_N", "time|s x|m drive|N "},
        std::pair{"t,pos_m,pos_s", "t| pos_m| pos_s| "}, std::pair{"t_s,out_m,out_s", "t|s out_m| out_s| "},
        std::pair{"theta_m,dq_s,v_m,tau_J,q_d_s", "theta_m| dq_s| v_m| tau_J| q_d_s| "},
        std::pair{"x_m_m,x_s_m,x_des_m", "x_m|m x_s|m x_des|m "},
        std::pair{"dq_rad_s,v_m_s,tau_Nm,x_cm", "dq|rad/s v|m/s tau|N m x|cm "}}) {
    std::string row = "1";
    for (const char c : std::string_view(head)) row += c == ',' ? ",1" : "";
    EXPECT_EQ(columns_of(write("a.csv", std::string(head) + "\n" + row + "\n" + row + "\n")), seen) << head;
  }
}

TEST_F(Header, AUnitIsKnownHoweverItIsSpelled) {
  for (const auto& [head, seen] : {std::pair{"f (Newton)", "f|N "},
                                   std::pair{"f [newtons]", "f|N "},
                                   std::pair{"x (meters)", "x|m "},
                                   std::pair{"x [metre]", "x|m "},
                                   std::pair{"tau [N.m]", "tau|N m "},
                                   std::pair{"tau [Nm]", "tau|N m "},
                                   std::pair{"tau (N·m)", "tau|N m "},
                                   std::pair{"tau [N*m]", "tau|N m "},
                                   std::pair{"tau [N-m]", "tau|N m "},
                                   std::pair{"tau (Newton meters)", "tau|N m "},
                                   std::pair{"q [degrees]", "q|deg "},
                                   std::pair{"q [°]", "q|deg "},
                                   std::pair{"q (Radians)", "q|rad "},
                                   std::pair{"x [cm]", "x|cm "},
                                   std::pair{"i [mA]", "i|mA "},
                                   std::pair{"i (Amps)", "i|A "},
                                   std::pair{"dq [rad s^-1]", "dq|rad/s "},
                                   std::pair{"dq (deg/sec)", "dq|deg/s "},
                                   std::pair{"v [meters per second]", "v|m/s "},
                                   std::pair{"a [m/s²]", "a|m/s^2 "},
                                   std::pair{"a [m/s2]", "a|m/s^2 "},
                                   std::pair{"t [sec]", "t|s "},
                                   std::pair{"t (milliseconds)", "t|ms "},
                                   std::pair{"gain [-]", "gain| "},
                                   std::pair{"x [furlong]", "x|furlong "}}) {
    EXPECT_EQ(columns_of(write("a.csv", std::string(head) + "\n1\n2\n")), seen) << head;
  }
}

TEST_F(Header, ANumberOrADescriptionInBracketsBelongsToTheName) {
  for (const auto& [head, seen] :
       {std::pair{"q[0]", "q[0]| "}, std::pair{"state.q[12]", "state.q[12]| "}, std::pair{"q(3)", "q(3)| "},
        std::pair{"q[0] [rad]", "q[0]|rad "}, std::pair{"q_rad[0]", "q[0]|rad "}, std::pair{"tau_J[6]", "tau_J[6]| "},
        std::pair{"position[shoulder_pan]", "position[shoulder_pan]| "},
        std::pair{"force (filtered) [N]", "force (filtered)|N "},
        std::pair{"force (filtered)", "force (filtered)| "}}) {
    EXPECT_EQ(columns_of(write("a.csv", std::string(head) + "\n1\n2\n")), seen) << head;
  }
  const auto file = write("b.csv", "time [s],state.q[0],state.q[1]\n0,1,2\n1,3,4\n");
  EXPECT_EQ(read({.file = file, .variable = "state.q[1]"})->values, (Values{2, 4}));
  const auto range = read_columns(file, std::vector<std::string>{"state.q[0]:state.q[1]", "2"});
  ASSERT_TRUE(range) << describe(range.error());
  EXPECT_EQ((*range)[0].size(), 2U);
  EXPECT_EQ((*range)[1][0].values, (Values{1, 3}));
}

TEST_F(Header, BlanksSeparateWhereTheSamplesShowIt) {
  for (const char* text :
       {"time q tau\n0.00 0.1 1\n0.01 0.2 2\n", "time [s] q [rad] tau [N m]\n0 0.1 1\n0.01 0.2 2\n",
        "  time   q   tau  \n  0.00   0.1   1\n  0.01   0.2   2\n", "time q tau\n0\t0.1\t1\n0.01\t0.2\t2\n",
        "\"time\" \"q\" \"tau\"\n0 0.1 1\n0.01 0.2 2\n", "time q tau\n0,00 0,1 1\n0,01 0,2 2\n"}) {
    const auto signal = read({.file = write("a.csv", text), .variable = "q"});
    ASSERT_TRUE(signal) << text << describe(signal.error());
    EXPECT_EQ(signal->values, (Values{0.1, 0.2})) << text;
    EXPECT_EQ(signal->sample_time_s, 0.01) << text;
  }
  const auto wide = read({.file = write("b.txt", "time   joint one\n0   1\n1   2\n"), .variable = "joint one"});
  ASSERT_TRUE(wide) << describe(wide.error());
}

TEST_F(Header, ACommentWithAWordForEachColumnIsTheHeaderWhereNoOtherIs) {
  for (const char* text : {"# time_s force_N\n0 1.5\n0.01 2\n", "# made by savetxt\n# time_s,force_N\n0,1.5\n0.01,2\n",
                           "% time_s force_N\n0 1.5\n0.01 2\n", "# time_s; force_N\n0;1.5\n0.01;2\n",
                           "%time_s,force_N\n0,1.5\n0.01,2\n", "# time_s force_N\n0,1.5\n0.01,2\n"}) {
    const auto signal = read({.file = write("a.txt", text), .variable = "force"});
    ASSERT_TRUE(signal) << text << describe(signal.error());
    EXPECT_EQ(signal->values, (Values{1.5, 2})) << text;
    EXPECT_EQ(signal->unit, "N") << text;
    EXPECT_EQ(signal->sample_time_s, 0.01) << text;
  }
  EXPECT_TRUE(
      says(refusal({.file = write("b.txt", "# two words more\n0 1\n1 2\n"), .variable = "a"}), "a header is needed"));
}

TEST_F(Header, DecimalCommasAreReadWhereCommasDoNotSeparate) {
  for (const char* text :
       {"Zeit [s];Kraft [N]\n0,000;60\n0,001;-55,7329\n", "Zeit [s]\tKraft [N]\n0\t60\n0,001\t-55,7329\n",
        "Zeit [s],Kraft [N]\n\"0,000\",60\n\"0,001\",\"-55,7329\"\n",
        "sep=;\nZeit [s];Kraft [N]\n0,000;60\n1e-3;-5,57329E1\n"}) {
    const auto signal = read({.file = write("a.csv", text), .variable = "Kraft"});
    ASSERT_TRUE(signal) << text << describe(signal.error());
    EXPECT_EQ(signal->values, (Values{60, -55.7329})) << text;
    EXPECT_EQ(signal->sample_time_s, 0.001) << text;
  }
  const auto mixed = write("b.csv", "t;f\n0.5;1\n1.0;1,500\n");
  EXPECT_TRUE(says(refusal({.file = mixed, .variable = "f"}), "write a decimal point")) << "thousands or a fraction?";
}

}  // namespace
}  // namespace tactus::recording
