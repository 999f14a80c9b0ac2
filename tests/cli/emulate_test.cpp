// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <string>

#include "tests/cli/command.hpp"

namespace tactus::cli {
namespace emulate_test {

/// Started and stopped by a shell, which reads from a pipe what a person would read from a terminal.
class Emulate : public Command {
 protected:
  void shell(const std::string& script) {
    write("script", R"(
      # Damiao's adapter: ask motor 1 for its register 22; its answer of 16 bytes, hexadecimal.
      ask() { printf '\125\252\036\003\001\000\000\000\012\000\000\000\000\377\007\000\000\000\010\000\000\001\000\063\026\000\000\000\000\000' >&3
              timeout 20 head -c 16 <&3 | od -An -tx1 | tr -d ' \n'; }
      )" + script);
    setenv("TACTUS", TACTUS_COMMAND, 1);
    ASSERT_EQ(std::system(("cd '" + folder().string() + "' && sh script").c_str()), 0) << content("emulate.log");
  }
};

TEST_F(Emulate, DamiaoPrintsItsPathAtOnceAnswersOneClientAfterAnotherAndEndsOnASignal) {
  shell(R"(
    mkfifo said
    $TACTUS emulate damiao >said 2>emulate.log </dev/null & peer=$!
    trap "kill -KILL $peer 2>/dev/null" EXIT
    read -r path <said || exit 3
    [ -c "$path" ] || exit 4
    for client in 1 2; do
      exec 3<>"$path"
      ask >answer$client
      exec 3>&-
    done
    kill -TERM $peer
    wait $peer || exit 5
  )");
  // VMAX of a DM4310: 30.0F is 41f00000.
  EXPECT_EQ(content("answer1"),
            "aa11081100000001003316"
            "0000f041"
            "55");
  EXPECT_EQ(content("answer2"), content("answer1"));
  EXPECT_EQ(content("emulate.log"), "");
}

TEST_F(Emulate, ServosAnswerWithTheBytesOfTheirMakersPages) {
  shell(R"(
    for kind in dynamixel feetech; do
      mkfifo $kind
      $TACTUS emulate $kind >$kind 2>>emulate.log </dev/null & peer=$!
      read -r path <$kind || exit 3
      for client in 1 2; do
        exec 3<>"$path"
        if [ $kind = dynamixel ]; then
          printf '\377\377\375\000\001\007\000\002\204\000\004\000\035\025' >&3
          timeout 20 head -c 15 <&3 | od -An -tx1 | tr -d ' \n' >$kind$client
        else
          printf '\377\377\001\002\001\373' >&3
          timeout 20 head -c 6 <&3 | od -An -tx1 | tr -d ' \n' >$kind$client
        fi
        exec 3>&-
      done
      kill -TERM $peer
      wait $peer || exit 5
    done
  )");
  // Position 0 of servo 1; its CRC by long division.
  EXPECT_EQ(content("dynamixel1"), "fffffd00010800550000000000bfb8");
  EXPECT_EQ(content("dynamixel2"), content("dynamixel1"));
  EXPECT_EQ(content("feetech1"), "ffff010200fc");
  EXPECT_EQ(content("feetech2"), content("feetech1"));
  EXPECT_EQ(content("emulate.log"), "");
}

TEST_F(Emulate, Inverse3PrintsItsAddressAtOnceAndAnswersThere) {
  shell(R"sh(
    mkfifo said
    $TACTUS emulate inverse3 --port 0 --dialect 3.1 >said 2>emulate.log </dev/null & peer=$!
    read -r url <said || exit 3
    python3 -c "
import sys, urllib.request
print(urllib.request.urlopen('http' + sys.argv[1][2:] + '/version', timeout=20).read().decode())" $url >answer || exit 4
    kill -TERM $peer
    wait $peer || exit 5
  )sh");
  EXPECT_EQ(content("answer"), R"({"data":{"version":"3.1.0"},"ok":true})"
                               "\n");
  EXPECT_EQ(content("emulate.log"), "");
}

TEST_F(Emulate, LiveMotorsTakeFaultsFromTheInputAndSayWhenTheirPowerChanges) {
  shell(R"(
    mkfifo said faults
    $TACTUS emulate feetech --model hls3625 --live >said 2>emulate.log <faults & peer=$!
    trap "kill -KILL $peer 2>/dev/null" EXIT
    exec 5<said 4>faults
    read -r path <&5 || exit 3
    exec 3<>"$path"
    # Torque enable of servo 2: 1, then 0, which it ignores from the fault on until that is another one.
    printf '\377\377\002\004\003\050\001\315' >&3
    read -r on <&5 || exit 4
    echo ignores-disable:2 >&4; echo hicups >&4
    heard() { for try in $(seq 200); do grep -q $1 emulate.log && return; sleep 0.05; done; }
    heard hicups
    printf '\377\377\002\004\003\050\000\316' >&3
    timeout 20 head -c 12 <&3 >/dev/null
    echo error=0x24:2 >&4; echo sneezes >&4; heard sneezes
    printf '\377\377\002\004\003\050\000\316' >&3
    read -r off <&5 || exit 6
    echo "$on" >changes; echo "$off" >>changes
    kill -TERM $peer
    wait $peer || exit 5
  )");
  const std::string changes = content("changes");
  EXPECT_EQ(changes.find("power 2 on "), 0U) << changes;
  EXPECT_NE(changes.find("\npower 2 off "), std::string::npos) << changes;
  EXPECT_NE(content("emulate.log").find("'hicups': there is no such fault"), std::string::npos);
}

TEST_F(Emulate, AFaultOfServosIsReadOrRefusedWithWhatThereIs) {
  for (const char* kind : {"dynamixel", "feetech"}) {
    const Outcome unknown = tactus({"emulate", kind, "--fault", "hicups:1"});
    EXPECT_EQ(unknown.status, 2);
    EXPECT_NE(unknown.err.find("--fault: 'hicups:1': there is no such fault (corrupt, "), std::string::npos);
    const Outcome nobody = tactus({"emulate", kind, "--fault", "hot:3"});
    EXPECT_EQ(nobody.status, 2);
    EXPECT_NE(nobody.err.find("--fault: 'hot:3': the ids go from 1 to 2"), std::string::npos) << nobody.err;
  }
}

TEST_F(Emulate, AnUnknownKindOrFaultIsRefusedWithWhatThereIs) {
  const Outcome nobody = tactus({"emulate", "nobody"});
  EXPECT_EQ(nobody.status, 2);
  const Outcome fault = tactus({"emulate", "damiao", "--fault", "hicups:1"});
  EXPECT_EQ(fault.status, 2);
  EXPECT_NE(fault.err.find("--fault: 'hicups:1': there is no such fault (silence, "), std::string::npos) << fault.err;
  const Outcome model = tactus({"emulate", "damiao", "--model", "DM1"});
  EXPECT_EQ(model.status, 2);
  EXPECT_NE(model.err.find("DM4310"), std::string::npos) << model.err;
}

}  // namespace emulate_test
}  // namespace tactus::cli
