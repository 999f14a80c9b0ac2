// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"

namespace tactus::cli {

/// A pair of arms that are emulated, driven at the real clock.
class RigRun : public Command {
 protected:
  /// One side, all joints alike, at the port `@1` or `@2`.
  static std::string side(const std::string& name, const std::string& port, const std::string& bus,
                          const std::string& model, int joints, const std::string& more) {
    std::string text = "[arm." + name + "]\nbus = \"" + bus + "\"\nport = \"" + port + "\"\n";
    if (bus == "damiao") text += "reply_timeout_s = 0.05\nwatchdog_s = 1.0\n";
    for (int i = 1; i <= joints; ++i) {
      const std::string number = std::to_string(i);
      text += "[arm." + name + ".joint_" + number + "]\nmotor = " + number + "\nmodel = \"" + model +
              "\"\nlower_rad = -3.0\nupper_rad = 3.0\nvelocity_limit_rad_per_s = 8.0\ntorque_limit_Nm = "
              "1.5\ntorque_rate_limit_Nm_per_s = 500.0\n" +
              more;
    }
    return text;
  }
  static std::string pair(const std::string& bus, const std::string& model, int joints, const std::string& of_leader,
                          const std::string& of_both = {}) {
    return side("leader", "@1", bus, model, joints, of_leader + of_both) +
           side("follower", "@2", bus, model, joints, of_both);
  }
  /// How far a joint is from its leader's at most at this second, in rad; infinity where the run has no such line.
  static double apart(const std::string& said, const std::string& second) {
    const std::string words = "farthest apart ";
    const auto line = said.find("\n" + second + " s: ");
    const auto at = line == std::string::npos ? line : said.find(words, line);
    if (at == std::string::npos) return std::numeric_limits<double>::infinity();
    return std::atof(said.c_str() + at + words.size());
  }
  /// The peers at `@1` and `@2`, then the rest of the script, in which `$RUN` drives the rig.
  std::string shell(const std::string& leader, const std::string& follower, const std::string& rig,
                    const std::string& rest) {
    write("rig.in", rig);
    write("script", R"sh(
      cat rig.in >rig.toml; rm -f said1 said2; mkfifo said1 said2
      $TACTUS emulate )sh" +
                        leader + R"sh( >said1 2>emulate.err </dev/null & peers=$!
      $TACTUS emulate )sh" +
                        follower + R"sh( >said2 2>emulate.err </dev/null & peers="$peers $!"
      trap 'kill -KILL $peers 2>/dev/null' EXIT
      read -r leader <said1; read -r follower <said2
      sed -i "s|@1|$leader|; s|@2|$follower|" rig.toml
      mkfifo hands; exec 9<>hands; rm hands
      RUN="$TACTUS run $JOINTS --realtime --device rig.toml"
      )sh" + rest);
    setenv("TACTUS", TACTUS_COMMAND, 1);
    setenv("JOINTS", TACTUS_EXAMPLE_FOLDER "/rigs/joints.toml", 1);
    EXPECT_EQ(std::system(("cd '" + folder().string() + "' && sh script >out 2>err").c_str()), 0) << content("err");
    return content("out") + content("err");
  }
  using Holds = std::function<bool(const std::string& said)>;
  /// The same, up to three times until all `signs` are in what it says and `holds` it. A machine that does other things
  /// too may keep a motor unheard for longer than it may be, or a joint that is probed from going as far as it should;
  /// then both hold. Or the probe's force goes on for some ticks, and the joint stays where that leaves it: a leader is
  /// followed from there.
  std::string shell_until(const std::vector<std::string>& signs, const std::string& leader, const std::string& follower,
                          const std::string& rig, const std::string& rest, const Holds& holds = {}) {
    std::string said;
    for (int tries = 0; tries < 3; ++tries) {
      said = shell(leader, follower, rig, rest);
      const auto shows = [&said](const std::string& sign) { return said.find(sign) != std::string::npos; };
      if (std::all_of(signs.begin(), signs.end(), shows) && (!holds || holds(said))) break;
    }
    return said;
  }
};

}  // namespace tactus::cli
