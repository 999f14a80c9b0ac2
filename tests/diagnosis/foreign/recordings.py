#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""recordings.py SEED COUNT LED FOLDER: writes COUNT recordings of rigs that oscillate for a known reason, mechanisms in
turn, and LED of people who lead and nothing else, as tables in the styles that people use, and FOLDER/truth.json."""
import json
import pathlib
import sys

import numpy as np

from mechanisms import MECHANISMS, RATE_HZ, led_recordings, recordings_of
from simulator import SIGNALS

OPTIONS = ("--master-position", "--slave-position", "--displayed-force", "--tip-force", "--hand-force", "--slave-force")
# Names of the time and of the six signals, separator, whether the decimal sign is a comma, factor of the time; whether the
# axis is rotary, and whether the columns are found by their names.
STYLES = (
    (("time_s", "master_position_m", "slave_position_m", "displayed_force_N", "tip_force_N", "hand_force_N",
      "slave_force_N"), ",", False, 1.0, False, True),
    (("t", "leader_position_m", "follower_position_m", "leader_motor_force_N", "contact_force_N", "operator_force_N",
      "follower_motor_force_N"), ",", False, 1.0, False, True),
    (("stamp [s]", "x_m [m]", "x_s [m]", "F_motor [N]", "F_tip [N]", "F_hand [N]", "F_act [N]"), ",", False, 1.0, False, False),
    (("time [ms]", "q_m [rad]", "q_s [rad]", "tau_m [N.m]", "tau_ext [N.m]", "tau_h [N.m]", "tau_s [N.m]"), "\t", False,
     1e3, True, False),
    (("Time [s]", "leader angle [deg]", "follower angle [deg]", "leader torque [Nm]", "contact torque [Nm]",
      "operator torque [Nm]", "follower torque [Nm]"), ";", True, 1.0, True, False),
)
RATES_HZ = (100.0, 125.0, 200.0, 250.0, 500.0, 1000.0, 2000.0, 5000.0)


def write(random, file, rig, signals, fastest_Hz, needed, rates):
    """Returns the options of `tactus diagnose` for this file."""
    names, separator, comma, time_factor, rotary, found_by_name = STYLES[int(random.integers(len(STYLES)))]
    enough = [rate for rate in rates if rate >= 5.0 * fastest_Hz]
    rate_Hz = float(random.choice(enough))
    seconds = np.arange(0.0, (signals.shape[0] - 1) / RATE_HZ, 1.0 / rate_Hz)
    table = signals[np.minimum(np.round(seconds * RATE_HZ).astype(int), signals.shape[0] - 1)].astype(float)
    arm_m = random.uniform(0.05, 0.12)
    force_step = float(random.choice([2e-3, 5e-3, 1e-2]))
    in_steps = random.random() < 0.6
    for i in (2, 5):
        if in_steps:
            table[:, i] = np.round(table[:, i] / force_step) * force_step
    if rotary:
        table[:, :2] *= 57.29577951308232 / arm_m if "[deg]" in names[1] else 1.0 / arm_m
        table[:, 2:] *= arm_m
    used = [i for i in range(6) if i in needed or random.random() < 0.9]
    digits = "%.7g" if random.random() < 0.7 else "%.6f"
    lines = [separator.join([names[0]] + [names[i + 1] for i in used])]
    for time_s, row in zip(seconds, table):
        lines.append(separator.join(["%.6f" % (time_s * time_factor)] + [digits % row[i] for i in used]))
    text = "\n".join(lines) + "\n"
    file.write_text(text.replace(".", ",") if comma else text)
    options = []
    if not found_by_name:
        options += ["--time", names[0].split(" [")[0]]
        for i in used:
            options += [OPTIONS[i], names[i + 1].split(" [")[0]]
    return {"file": file.name, "options": options, "rate_Hz": rate_Hz, "signals": [SIGNALS[i] for i in used]}


def main():
    seed, count, led, folder = int(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), pathlib.Path(sys.argv[4])
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng([seed, 7])
    truth = []
    kinds = list(MECHANISMS)
    for i, kind in enumerate(kinds):
        wanted = len(range(i, count, len(kinds)))
        made, batch = 0, 0
        while made < wanted and batch < 6:
            for rig, signals, frequency_Hz in recordings_of(kind, wanted - made, 1000 * seed + batch, 40):
                needed = (0, 2) if kind == "virtual-wall" else (0, 1)
                one = write(random, folder / f"{kind}-{made}.csv", rig, signals, frequency_Hz, needed, RATES_HZ)
                truth.append({"mechanism": kind, "frequency_Hz": float(frequency_Hz), **one})
                made += 1
            batch += 1
        print(f"{kind}: {made}", flush=True)
    for i, (rig, signals, frequency_Hz) in enumerate(led_recordings(led, seed) if led else []):
        one = write(random, folder / f"led-{i}.csv", rig, signals, frequency_Hz, (0, 1), (30.0, 50.0, 60.0) + RATES_HZ)
        truth.append({"mechanism": "none", **one})
    (folder / "truth.json").write_text(json.dumps(truth, indent=1))


if __name__ == "__main__":
    main()
