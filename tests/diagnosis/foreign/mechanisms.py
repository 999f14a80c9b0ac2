# SPDX-License-Identifier: Apache-2.0
"""Rigs that oscillate for one reason, and rigs that people lead. Shares no code with tactus.

What makes a rig oscillate is raised over a ladder of levels; with that taken away the same rig must be still. The
recording is of the lowest level that oscillates, or of one beyond it.
"""
import numpy as np

from simulator import (DURATION_S, POSITION_FORCE, POSITION_POSITION, RECORDED_EVERY, STEP_S, VIRTUAL_WALL, Path,
                       plain_rig, simulate, tremor_noise)

RATE_HZ = 1.0 / (STEP_S * RECORDED_EVERY)
LEVELS = 7


def moves_then_rests(random, end_m, farthest_m):
    path = Path(random.uniform(-0.05, -0.02))
    while path.now_s < 1.8:
        path.reach(random.uniform(-0.06, farthest_m), random.uniform(0.35, 0.8), random.uniform(0.0, 0.3))
    path.reach(end_m, random.uniform(0.4, 0.7))
    return path


def leads_about(random, farthest_m):
    size = random.uniform(0.006, 0.015)
    path = Path(farthest_m - 1.5 * size)
    path.sway(random, size, random.uniform(0.25, 0.5), 0.3)
    return path


def induced_motion(random, rig):
    rig.update(hand_N_per_m=rig["hand_N_per_m"], leader_limit_N=random.uniform(2.0, 8.0))
    ladder = np.geomspace(0.4, 12.0, LEVELS)
    return moves_then_rests(random, random.uniform(0.003, 0.01), -0.004), [{"force_gain": g} for g in ladder], \
        {"force_gain": 0.1}, "leader_m", 1e-4


def follower_servo(random, rig):
    rig.update(wall_m=0.6, follower_limit_N=random.uniform(2.0, 8.0), late=1.0,
               follower_steps=int(random.choice([10, 20, 20, 50])), velocity_Hz=random.uniform(30.0, 150.0))
    path = moves_then_rests(random, -0.02, -0.01) if random.random() < 0.6 else leads_about(random, 0.0)
    ladder = rig["servo_N_per_m"] * np.geomspace(1.5, 200.0, LEVELS)
    damping = rig["servo_N_s_per_m"] * random.uniform(0.3, 1.0)
    return path, [{"servo_N_per_m": k, "servo_N_s_per_m": damping} for k in ladder], {}, "follower_m", 1e-4


def delay(random, rig):
    stiffness = rig["servo_N_per_m"] * random.uniform(0.3, 2.0)
    damping = 2.0 * random.uniform(0.15, 0.5) * np.sqrt(stiffness * rig["follower_kg"])
    rig.update(architecture=POSITION_POSITION, wall_m=0.6, coupling_N_per_m=stiffness, coupling_N_s_per_m=random.uniform(0.1, 0.4) * damping,
               leader_viscous=random.uniform(0.05, 0.3), follower_viscous=random.uniform(0.05, 0.4),
               servo_N_per_m=stiffness, servo_N_s_per_m=damping, feed_velocity=float(random.integers(0, 2)),
               leader_coulomb_N=random.uniform(0.01, 0.05), follower_coulomb_N=random.uniform(0.02, 0.08),
               hand_N_per_m=random.uniform(5.0, 60.0), hand_N_s_per_m=random.uniform(0.3, 2.0),
               leader_limit_N=random.uniform(1.0, 20.0), follower_limit_N=random.uniform(1.0, 30.0))
    path = moves_then_rests(random, -0.02, -0.01) if random.random() < 0.7 else leads_about(random, 0.0)
    ladder = (np.geomspace(6e-3, 0.2, LEVELS) / STEP_S).astype(int)
    share = random.uniform(0.35, 0.65)
    return path, [{"there_steps": int(2 * share * d), "back_steps": int(2 * (1 - share) * d)} for d in ladder], \
        {"there_steps": 0, "back_steps": 0}, "follower_m", 3e-4


def quantisation(random, rig):
    stiff = rig["follower_kg"] * (2.0 * np.pi * random.uniform(12.0, 25.0)) ** 2
    rig.update(wall_m=0.6, follower_coulomb_N=random.uniform(0.03, 0.12), follower_static=1.0, servo_N_per_m=stiff,
               servo_N_s_per_m=random.uniform(0.5, 1.0) * np.sqrt(stiff * rig["follower_kg"]),
               velocity_Hz=random.uniform(40.0, 150.0))
    ladder = np.geomspace(3e-5, 3e-3, LEVELS)
    return moves_then_rests(random, -0.02, -0.01), [{"follower_count_m": c} for c in ladder], \
        {"follower_count_m": 1e-6}, "follower_N", 0.05


def stick_slip(random, rig):
    hunts = random.random() < 0.5
    stiff = rig["follower_kg"] * (2.0 * np.pi * random.uniform(3.0, 7.0)) ** 2
    rig.update(wall_m=0.6, follower_coulomb_N=random.uniform(0.2, 0.5), stribeck_mps=random.uniform(2e-3, 8e-3),
               bristle_N_per_m=6e4, servo_N_per_m=stiff,
               servo_N_s_per_m=random.uniform(0.5, 1.0) * np.sqrt(stiff * rig["follower_kg"]))
    if hunts:
        rig["servo_N_per_m_s"] = stiff * random.uniform(6.0, 15.0)
        path = moves_then_rests(random, -0.02, -0.01)
    else:
        path = Path(-0.05)
        speed = random.uniform(4e-3, 1.2e-2)
        while path.now_s < DURATION_S:
            path.glide(-0.05 if path.now_m > -0.03 else -0.01, 0.04 / speed)
    return path, [{"follower_static": r} for r in np.geomspace(1.2, 6.0, LEVELS)], {"follower_static": 1.0}, \
        "follower_N", 0.03


def tremor(random, rig):
    kind = random.random()
    if kind < 0.3:
        rig.update(architecture=POSITION_POSITION, wall_m=0.6, coupling_N_per_m=0.3 * rig["servo_N_per_m"],
                   coupling_N_s_per_m=1.0)
    path = moves_then_rests(random, random.uniform(0.002, 0.006) if kind > 0.7 else -0.02, -0.004)
    rig["force_gain"] = random.uniform(0.1, 0.4)
    return path, [{"tremor_N": f} for f in np.geomspace(0.05, 2.0, LEVELS)], {"tremor_N": 0.0}, "leader_m", 1.5e-4


def virtual_wall(random, rig):
    on_off = random.random() < 0.4
    steps = int(random.choice([20, 50, 100, 100, 200]))
    rig.update(architecture=VIRTUAL_WALL, wall_m=0.6, virtual_steps=steps, leader_limit_N=random.uniform(4.0, 12.0),
               hand_N_per_m=random.uniform(40.0, 200.0), hand_N_s_per_m=random.uniform(0.5, 3.0))
    if on_off:
        ladder = [{"virtual_N": f} for f in np.geomspace(0.5, 8.0, LEVELS)]
    else:
        ladder = [{"virtual_N_per_m": k} for k in np.geomspace(100.0, 2e4, LEVELS)]
    return moves_then_rests(random, random.uniform(0.003, 0.01), -0.004), ladder, {}, "leader_m", 2e-4


MECHANISMS = {"induced-motion": induced_motion, "slave-servo": follower_servo, "delay": delay,
              "quantisation": quantisation, "stick-slip": stick_slip, "tremor": tremor, "virtual-wall": virtual_wall}


def fast_part(values, corner_Hz=1.5):
    """Less its moving average over the corner's period, taken twice."""
    width = int(RATE_HZ / corner_Hz) | 1
    kernel = np.ones(width) / width
    padded = np.pad(values, width, mode="edge")
    slow = np.convolve(np.convolve(padded, kernel, "same"), kernel, "same")[width:-width]
    return values - slow


def oscillation_of(values):
    """Size, growth and main frequency of the last three seconds, and how regular it is (0 to 1)."""
    fast = fast_part(values.astype(float))[int(-3.2 * RATE_HZ):int(-0.2 * RATE_HZ)]
    half = fast.size // 2
    size, growth = fast.std(), fast[half:].std() / max(fast[:half].std(), 1e-12)
    spectrum = np.abs(np.fft.rfft(fast * np.hanning(fast.size))) ** 2
    frequency_Hz = np.fft.rfftfreq(fast.size, 1.0 / RATE_HZ)
    seen = frequency_Hz > 1.8
    main = frequency_Hz[seen][np.argmax(spectrum[seen])]
    lines = np.zeros(frequency_Hz.size, dtype=bool)
    for harmonic in range(1, 7):
        lines |= np.abs(frequency_Hz - harmonic * main) < max(0.6, 0.05 * main)
    return size, growth, main, spectrum[seen & lines].sum() / max(spectrum[seen].sum(), 1e-30)


def recordings_of(mechanism, count, seed, rigs=24):
    """Yields rig, signals at 5 kHz (time, signal) and main frequency of `count` recordings at most."""
    random = np.random.default_rng([seed, sorted(MECHANISMS).index(mechanism)])
    lanes, paths, tremors, heads = [], [], [], []
    for _ in range(rigs):
        rig = plain_rig(random)
        path, ladder, without, column, threshold = MECHANISMS[mechanism](random, rig)
        shake = tremor_noise(random, path.time_s.size, random.uniform(4.5, 11.0), random.uniform(0.3, 0.9))
        if rig["tremor_N"] == 0.0 and mechanism != "tremor":
            rig["tremor_N"] = random.uniform(0.002, 0.02)
        heads.append((len(lanes), column, threshold))
        for change in [without] + ladder:
            lanes.append({**rig, **change})
            paths.append(path)
            tremors.append(shake)
    out = simulate(lanes, paths, tremors, seed)
    names = ["leader_m", "follower_m", "displayed_N", "tip_N", "hand_N", "follower_N"]
    made = 0
    for first, column, threshold in heads:
        found = [oscillation_of(out[:, names.index(column), first + i]) for i in range(LEVELS + 1)]
        runs_away = [np.abs(out[:, :2, first + i]).max() > 0.3 for i in range(LEVELS + 1)]
        regular = 0.4 if mechanism == "tremor" else 0.6
        good = [i for i in range(1, LEVELS + 1) if found[i][0] > max(threshold, 4.0 * found[0][0]) and found[i][1] > 0.7 and found[i][3] > regular
                and not runs_away[i] and 1.9 < found[i][2] < 220.0]
        if not good:
            continue
        near = made % 2 == 0 or len(good) == 1
        level = good[0] if near else int(random.choice(good[1:]))
        if mechanism == "tremor" and found[level][0] > 1.5e-3:
            continue
        yield lanes[first + level], out[:, :, first + level], found[level][2]
        made += 1
        if made >= count:
            return


def led_recordings(count, seed):
    """People who lead at 0.5 to 3 Hz with every architecture, in contact or not: nothing oscillates by itself."""
    random = np.random.default_rng([seed, 99])
    lanes, paths, tremors = [], [], []
    for i in range(count):
        rig = plain_rig(random)
        frequency_Hz = np.exp(random.uniform(np.log(0.5), np.log(3.0)))
        size = random.uniform(0.01, 0.04) / max(1.0, frequency_Hz)
        in_contact = random.random() < 0.3
        if i % 3 == 1:
            rig.update(architecture=POSITION_POSITION, coupling_N_per_m=0.2 * rig["servo_N_per_m"], coupling_N_s_per_m=1.0,
                       there_steps=int(random.integers(0, 40)), back_steps=int(random.integers(0, 40)))
        # With coarse counts some of these rigs really chatter by one count while they wait: a limit cycle.
        rig.update(leader_count_m=1e-6, follower_count_m=1e-6)
        rig.update(wall_m=0.0 if in_contact else 0.6, force_gain=random.uniform(0.0, 0.3), wall_N_per_m=random.uniform(300, 1500),
                   hand_N_per_m=random.uniform(200.0, 600.0), hand_N_s_per_m=random.uniform(8.0, 20.0),
                   tremor_N=random.uniform(0.003, 0.03))
        path = Path(-0.8 * size if in_contact else random.uniform(-0.1, 0.0))
        path.sway(random, size, frequency_Hz, random.uniform(0.0, 1.5), random.uniform(0.01, 0.15))
        lanes.append(rig)
        paths.append(path)
        tremors.append(tremor_noise(random, path.time_s.size, random.uniform(6.0, 11.0), 0.8))
    out = simulate(lanes, paths, tremors, seed)
    for i in range(count):
        yield lanes[i], out[:, :, i], 3.0
