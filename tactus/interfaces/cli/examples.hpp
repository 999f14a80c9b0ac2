// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string_view>

namespace tactus::cli {

/// What help shows of a command in addition to its options.
struct Example {
  std::string_view command;  ///< with its parent command: `identify frf`
  std::string_view group;    ///< heading under which `tactus --help` lists it; empty for a subcommand
  std::string_view words;    ///< an example of its use, behind the name of the program
};

/// One for every command. A test compares the options of each example with those of its command.
constexpr std::array examples{
    Example{"run", "Run", "run experiments/tapping.toml --set control.force_gain=2 --out out/tapping"},
    Example{"serve", "Run", "serve --allow-tuning"},
    Example{"plant", "Run", "plant experiments/tapping.toml --name bench"},
    Example{"key", "Run", "key link.key"},
    Example{"relay", "Run",
            "relay experiments/tapping.toml --master 127.0.0.1:7001 --for-master 127.0.0.1:7011 "
            "--slave 127.0.0.1:7002 --for-slave 127.0.0.1:7012 --duration-s 60"},
    Example{"doctor", "Run", "doctor --rate-Hz 1000 --duration-s 10"},
    Example{"diagnose", "Understand", "diagnose examples/recordings/shaking-contact.csv --out out/diagnosis"},
    Example{"advise", "Understand", "advise experiments/tapping.toml --out out/advice"},
    Example{"stability", "Understand", "stability limit experiments/tapping.toml"},
    Example{"stability limit", "", "stability limit experiments/tapping.toml --uncertainty 0.1"},
    Example{"stability map", "",
            "stability map experiments/stability-map.toml --vary control.force_gain=0.5:30:40[log] "
            "--vary environment.stiffness_N_per_m=1e3:1e5:25[log] --out out/map"},
    Example{"stability margins", "", "stability margins experiments/tapping.toml --preload 2"},
    Example{"stability scorecard", "", "stability scorecard experiments/tapping.toml"},
    Example{"stability two-port", "", "stability two-port experiments/tapping.toml --out out/two-port"},
    Example{"faults", "Understand", "faults --only encoder-slip --seeds 100"},
    Example{"identify", "Identify", "identify inverse examples/recordings/axis-free-motion.csv --out out/model"},
    Example{"identify arm", "",
            "identify arm examples/recordings/arm-free-motion.csv --urdf examples/recordings/three-joints.urdf "
            "--gravity 0,-9.81,0 --time time --position shoulder_1_rad:elbow_rad --effort shoulder_1_N_m:elbow_N_m "
            "--out out/arm"},
    Example{"identify excitation", "",
            "identify excitation --urdf examples/recordings/three-joints.urdf --duration-s 20 --out out/motion"},
    Example{"identify frf", "",
            "identify frf examples/recordings/axis-free-motion.csv --input force_N --output position_m --out out/frf"},
    Example{"identify inverse", "", "identify inverse examples/recordings/axis-free-motion.csv --out out/model"},
    Example{"identify isolate", "", "identify isolate --rig simulated --seed 3 --out out/bench"},
    Example{"identify quick", "", "identify quick --rig simulated --seed 3 --out out/bench"},
    Example{"identify operator", "",
            "identify operator examples/recordings/axis-held.csv --position position_m --force hand_force_N"},
    Example{"identify prediction", "", "identify prediction experiments/inverse-model-chirp.toml --blocks 2"},
    Example{"estimate", "Identify", "estimate force examples/recordings/axis-contact.csv --model out/model/model.toml"},
    Example{"estimate force", "",
            "estimate force examples/recordings/axis-contact.csv --model out/model/model.toml "
            "--compare measured_force_N --out out/force"},
    Example{"estimate torque", "",
            "estimate torque examples/recordings/arm-pushed.csv --model out/arm/model.toml --time time --position 2:4 "
            "--velocity 5:7 --effort 8:10 --out out/torque"},
    Example{"device", "Devices", "device check rig.toml"},
    Example{"device list", "", "device list --probe"},
    Example{"device check", "", "device check rig.toml arm.leader"},
    Example{"device watch", "", "device watch rig.toml arm.leader --duration-s 10"},
    Example{"device zero", "", "device zero rig.toml arm.leader.elbow"},
    Example{"device limits", "", "device limits rig.toml"},
    Example{"device guard", "", "device guard rig.toml arm.leader"},
    Example{"rehearse", "Devices", "rehearse examples/rigs/yam.toml --arm --duration-s 10 --out out/rehearsal"},
    Example{"emulate", "Devices", "emulate damiao --motors 7"},
    Example{"emulate damiao", "", "emulate damiao --motors 7 --fault silence:2@5+0.1"},
    Example{"emulate dynamixel", "", "emulate dynamixel --motors 6 --fault hot:2@5"},
    Example{"emulate feetech", "", "emulate feetech --motors 6 --model hls3625"},
    Example{"emulate inverse3", "", "emulate inverse3 --port 10001"},
    Example{"export", "Data", "export out/tapping --to csv --topic /teleoperator --out taps.csv"},
    Example{"replay", "Data", "replay out/run --check"},
    Example{"schema", "Data", "schema tapping --reference"},
    Example{"completion", "Help", "completion bash"},
    Example{"help", "Help", "help identify frf"}};

}  // namespace tactus::cli
