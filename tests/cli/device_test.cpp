// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <string>

#include "tests/cli/command.hpp"

namespace tactus::cli {
namespace device_test {

class Device : public Command {
 protected:
  /// What `tactus device check` says of emulated motors with these options.
  Outcome check(const std::string& emulated, const std::string& motors) {
    write("script", R"(
      mkfifo said
      $TACTUS emulate damiao )" +
                        emulated + R"( >said 2>emulate.err </dev/null & peer=$!
      trap "kill -KILL $peer" EXIT
      read -r path <said || exit 99
      $TACTUS device check --bus damiao --port "$path" --motors )" +
                        motors + R"( >check.out 2>check.err
      echo $? >check.status
    )");
    setenv("TACTUS", TACTUS_COMMAND, 1);
    EXPECT_EQ(std::system(("cd '" + folder().string() + "' && rm -f said && sh script").c_str()), 0);
    return {
        .status = std::atoi(content("check.status").c_str()), .out = content("check.out"), .err = content("check.err")};
  }
};

TEST_F(Device, MotorsThatAreWhatWasStatedAreClean) {
  const Outcome outcome = check("", "1:DM4310,2:DM4310");
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.out.find("Clean: each motor is what was stated; "), 0U) << outcome.out;
  EXPECT_NE(outcome.out.find("12.5 rad, 30"), std::string::npos) << outcome.out;
}

TEST_F(Device, WhatIsWrongIsSaidWithTheMotorAndTheRemedy) {
  const Outcome model = check("--model DM4340", "1:DM4340,2:DM4310");
  EXPECT_EQ(model.status, 1);
  EXPECT_EQ(
      model.out.find("Not clean; no motor got power.\nmotor 2 (DM4310): its register 22 (VMAX) reads 10 where this "
                     "model has 30 rad/s: state the model that it is"),
      0U)
      << model.out;
  const Outcome missing = check("", "1:DM4310,3:DM4310");
  EXPECT_EQ(missing.status, 1);
  EXPECT_NE(missing.out.find("motor 3 (DM4310) does not answer: look at its power"), std::string::npos) << missing.out;
  const Outcome hot = check("--fault hot-winding:2", "1:DM4310,2:DM4310");
  EXPECT_EQ(hot.status, 1);
  EXPECT_NE(hot.out.find("motor 2: too hot: let it cool"), std::string::npos) << hot.out;
}

TEST_F(Device, AWrongRequestIsRefusedWithTheRemedy) {
  const auto refusal = [this](const std::string& port, const std::string& motors, const std::string& framing) {
    const Outcome outcome =
        tactus({"device", "check", "--bus", "damiao", "--port", port, "--motors", motors, "--framing", framing});
    EXPECT_EQ(outcome.status, 2);
    return outcome.err;
  };
  EXPECT_EQ(
      refusal("/dev/ttyACM-nobody", "1:DM4310", "usb2can").find("tactus: /dev/ttyACM-nobody: there is no such port"),
      0U);
  EXPECT_NE(refusal("/dev/null", "1", "usb2can").find("write ID:MODEL"), std::string::npos);
  EXPECT_NE(refusal("/dev/null", "1:DM1", "usb2can").find("'DM1' is not one of DM3507"), std::string::npos);
  EXPECT_NE(refusal("/dev/null", "1:DM4310", "fax").find("'fax' is not one of usb2can"), std::string::npos);
  EXPECT_NE(refusal("/dev/null", "1:DM4310,1:DM4310", "usb2can").find("two motors have this identifier"),
            std::string::npos);
}

}  // namespace device_test
}  // namespace tactus::cli
