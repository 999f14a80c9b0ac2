// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <string>

#include "tests/cli/command.hpp"

namespace tactus::cli {
namespace device_servos_test {

class DeviceServos : public Command {
 protected:
  Outcome check(const std::string& emulated, const std::string& checked) {
    write("script", R"sh(
      mkfifo said
      $TACTUS emulate )sh" +
                        emulated + R"sh( >said 2>emulate.err </dev/null & peer=$!
      trap "kill -KILL $peer" EXIT
      read -r path <said || exit 99
      $TACTUS device check --port "$path" )sh" +
                        checked + R"sh( >check.out 2>check.err
      echo $? >check.status
    )sh");
    setenv("TACTUS", TACTUS_COMMAND, 1);
    EXPECT_EQ(std::system(("cd '" + folder().string() + "' && rm -f said && sh script").c_str()), 0);
    return {
        .status = std::atoi(content("check.status").c_str()), .out = content("check.out"), .err = content("check.err")};
  }
};

TEST_F(DeviceServos, AreCheckedAgainstWhatIsStated) {
  const Outcome clean = check("dynamixel", "--bus dynamixel --motors 1:xl330-m288,2:xl330-m288");
  EXPECT_EQ(clean.status, 0) << clean.err;
  EXPECT_EQ(clean.out.find("Clean: each motor is what was stated; "), 0U) << clean.out;
  EXPECT_NE(clean.out.find("1.75 A"), std::string::npos) << clean.out;
  const Outcome other = check("dynamixel --fault wrong-model:2", "--bus dynamixel --motors 1:xl330-m288,2:xl330-m288");
  EXPECT_EQ(other.status, 1);
  EXPECT_EQ(other.out.find("Not clean; no motor got power.\nservo 2 reports model number 1220 (XC330-T288) where "
                           "XL330-M288 is stated: state the model that is there, or change the servo.\n"),
            0U)
      << other.out;
  const Outcome leader = check("feetech", "--bus feetech --motors 1:sts3215,2:sts3215");
  EXPECT_EQ(leader.status, 0) << leader.err;
  EXPECT_NE(leader.out.find("no force"), std::string::npos) << leader.out;
  const Outcome missing = check("feetech --model hls3625", "--bus feetech --motors 1:hls3625,5:hls3625");
  EXPECT_EQ(missing.status, 1);
  EXPECT_NE(missing.out.find("servo 5 does not answer at 1000000 bit/s"), std::string::npos) << missing.out;
}

TEST_F(DeviceServos, AWrongModelOrRateIsRefusedWithWhatThereIs) {
  const Outcome model = tactus({"device", "check", "--bus", "dynamixel", "--port", "/dev/null", "--motors", "1:xl320"});
  EXPECT_EQ(model.status, 2);
  EXPECT_NE(model.err.find("--motors: 'xl320' is not one of xl330-m077, "), std::string::npos) << model.err;
  const Outcome rate = tactus({"device", "check", "--bus", "feetech", "--port", "/dev/null", "--motors", "1:sts3215",
                               "--bits-per-s", "4000000"});
  EXPECT_EQ(rate.status, 2);
  EXPECT_NE(rate.err.find("--bits-per-s: 4000000 bit/s: the servos do 38400, "), std::string::npos) << rate.err;
}

}  // namespace device_servos_test
}  // namespace tactus::cli
