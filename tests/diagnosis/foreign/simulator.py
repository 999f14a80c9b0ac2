# SPDX-License-Identifier: Apache-2.0
"""Teleoperators with one axis that oscillate for a known reason, simulated without any code of tactus.

Many rigs ("lanes") are simulated at once, a number of each array for each lane. Two masses with LuGre friction are driven
by motors with a first-order lag; the operator is a spring and a damper to a moving point, with a tremor that is a force;
the wall is a spring and a damper. The controllers are sampled: position-force, position-position, or a virtual wall at
the leader alone. Integration is semi-implicit Euler at 10 kHz; the friction state is updated implicitly.

LuGre friction: Canudas de Wit, Olsson, Astrom and Lischinsky, A new model for control of systems with friction, IEEE
Transactions on Automatic Control 40(3), 1995.
"""
import numpy as np

STEP_S = 1e-4
RECORDED_EVERY = 2  # steps: signals are kept at 5 kHz
TICK = 5  # steps: controllers and delays are multiples of 0.5 ms
DURATION_S = 8.0
RING = 1024
POSITION_FORCE, POSITION_POSITION, VIRTUAL_WALL = 0, 1, 2
SIGNALS = ("leader_m", "follower_m", "displayed_N", "tip_N", "hand_N", "follower_N")


def minimum_jerk(s):
    s = np.clip(s, 0.0, 1.0)
    return s**3 * (10.0 - 15.0 * s + 6.0 * s**2)


class Path:
    """Where the operator wants the hand: reaches, sines and glides, at 1 kHz."""

    def __init__(self, start_m):
        self.time_s = np.arange(0.0, DURATION_S + 2e-3, 1e-3)
        self.at_m = np.full(self.time_s.size, start_m)
        self.now_s, self.now_m = 0.3, start_m

    def reach(self, to_m, takes_s, rest_s=0.0):
        self.at_m += (to_m - self.now_m) * minimum_jerk((self.time_s - self.now_s) / takes_s)
        self.now_s, self.now_m = self.now_s + takes_s + rest_s, to_m

    def glide(self, to_m, takes_s):
        self.at_m += (to_m - self.now_m) * np.clip((self.time_s - self.now_s) / takes_s, 0.0, 1.0)
        self.now_s, self.now_m = self.now_s + takes_s, to_m

    def sway(self, random, size_m, frequency_Hz, from_s=0.0, spread=0.08):
        """To and fro at nearly one frequency, as people do: period and size of each stroke differ a little."""
        phase = np.cumsum(2e-3 * np.pi * frequency_Hz * (1.0 + spread * slow_noise(random, self.time_s.size, 0.7)))
        size = size_m * (1.0 + 2.0 * spread * slow_noise(random, self.time_s.size, 0.5))
        fade = minimum_jerk((self.time_s - from_s) / 0.5)
        self.at_m += fade * size * np.sin(phase + random.uniform(0, 6.28))


def slow_noise(random, count, corner_Hz):
    """Noise of standard deviation 1 below a corner, at 1 kHz."""
    frequency = np.fft.rfftfreq(count, 1e-3)
    spectrum = (random.normal(size=frequency.size) + 1j * random.normal(size=frequency.size)) / (
        1.0 + (frequency / corner_Hz) ** 4)
    noise = np.fft.irfft(spectrum, count)
    return noise / max(noise.std(), 1e-12)


def tremor_noise(random, count, frequency_Hz, width_Hz):
    """Noise of standard deviation 1 in a band, at 1 kHz."""
    frequency = np.fft.rfftfreq(count, 1e-3)
    spectrum = (random.normal(size=frequency.size) + 1j * random.normal(size=frequency.size)) * np.exp(
        -0.5 * ((frequency - frequency_Hz) / width_Hz) ** 2)
    noise = np.fft.irfft(spectrum, count)
    return noise / max(noise.std(), 1e-12)


def plain_rig(random):
    """A rig that is sound: every value by name, drawn."""

    def about(value, factor):
        return value * np.exp(random.uniform(-np.log(factor), np.log(factor)))

    follower_kg = about(0.25, 1.6)
    servo_N_per_m = follower_kg * (2.0 * np.pi * random.uniform(5.0, 12.0)) ** 2
    return {
        "leader_kg": about(0.2, 1.7), "follower_kg": follower_kg,
        "leader_viscous": about(0.4, 1.6), "follower_viscous": about(0.6, 1.6),
        "leader_coulomb_N": about(0.06, 1.8), "leader_static": 1.15,
        "follower_coulomb_N": about(0.1, 1.8), "follower_static": 1.1,
        "stribeck_mps": 4e-3, "bristle_N_per_m": 3e4,
        "hand_N_per_m": about(120.0, 2.5), "hand_N_s_per_m": about(4.0, 1.8), "tremor_N": 0.0,
        "wall_m": 0.0, "wall_N_per_m": about(8000.0, 2.5), "wall_N_s_per_m": about(6.0, 1.8),
        "architecture": POSITION_FORCE, "force_gain": 0.2, "coupling_N_per_m": 0.0, "coupling_N_s_per_m": 0.0,
        "virtual_m": 0.0, "virtual_N_per_m": 0.0, "virtual_N": 0.0, "virtual_steps": 10,
        "servo_N_per_m": servo_N_per_m, "servo_N_s_per_m": 1.4 * np.sqrt(servo_N_per_m * follower_kg),
        "servo_N_per_m_s": 0.0, "velocity_Hz": random.uniform(60.0, 250.0), "feed_velocity": 1.0,
        "leader_count_m": about(1e-5, 2.5), "follower_count_m": about(1e-5, 2.5),
        "there_steps": int(random.integers(0, 20)), "back_steps": int(random.integers(0, 20)),
        "leader_steps": int(random.choice([5, 10, 10, 20])), "follower_steps": int(random.choice([5, 10, 10, 20])),
        "leader_limit_N": about(6.0, 2.0), "follower_limit_N": about(15.0, 2.0),
        "motor_lag_s": random.uniform(3e-4, 2e-3), "late": float(random.integers(0, 2)),
        "noise_N": about(6e-3, 3.0),
    }


def simulate(rigs, paths, tremors, seed):
    """Signals of each lane at 5 kHz: an array of time, signal and lane, in SI units, forces as tactus defines them."""
    lanes = len(rigs)
    p = {name: np.array([float(rig[name]) for rig in rigs]) for name in rigs[0]}
    whole = {name: p[name].astype(int) for name in p if name.endswith("_steps")}
    random = np.random.default_rng(seed)
    path = np.stack([one.at_m for one in paths])
    shake = np.stack(tremors) * p["tremor_N"][:, None]
    steps = int(round(DURATION_S / STEP_S))
    out = np.zeros((steps // RECORDED_EVERY, len(SIGNALS), lanes), dtype=np.float32)
    each = np.arange(lanes)
    ring_leader, ring_follower, ring_tip = (np.zeros((RING, lanes)) for _ in range(3))
    x, v = path[:, 0].copy(), np.zeros(lanes)
    y, w = path[:, 0].copy(), np.zeros(lanes)
    ring_leader[:] = x
    ring_follower[:] = y
    bend_x, bend_y = np.zeros(lanes), np.zeros(lanes)
    leader_N, follower_N = np.zeros(lanes), np.zeros(lanes)
    leader_next, follower_next = np.zeros(lanes), np.zeros(lanes)
    leader_told, follower_told = np.zeros(lanes), np.zeros(lanes)
    leader_speed, follower_speed = np.zeros(lanes), np.zeros(lanes)
    leader_old, follower_old = x.copy(), y.copy()
    asked_speed, asked_old = np.zeros(lanes), x.copy()
    sum_N, virtual_N, tip_seen = np.zeros(lanes), np.zeros(lanes), np.zeros(lanes)
    architecture = p["architecture"].astype(int)
    is_pf, is_pp, is_vw = (architecture == kind for kind in (POSITION_FORCE, POSITION_POSITION, VIRTUAL_WALL))
    lag = np.minimum(1.0, STEP_S / p["motor_lag_s"])
    leader_dt, follower_dt = whole["leader_steps"] * STEP_S, whole["follower_steps"] * STEP_S
    leader_pass = 1.0 - np.exp(-2.0 * np.pi * p["velocity_Hz"] * leader_dt)
    follower_pass = 1.0 - np.exp(-2.0 * np.pi * p["velocity_Hz"] * follower_dt)
    bristle_damping = 0.3 * np.sqrt(p["bristle_N_per_m"] * p["follower_kg"])

    def counted(values, count):
        return np.round(values / count) * count

    def friction(speed, bend, coulomb, ratio, mass):
        size = coulomb * (1.0 + (ratio - 1.0) * np.exp(-(speed / p["stribeck_mps"]) ** 2))
        stiffness = p["bristle_N_per_m"]
        new = (bend + STEP_S * speed) / (1.0 + STEP_S * stiffness * np.abs(speed) / size)
        return stiffness * new + bristle_damping * (new - bend) / STEP_S * 0.1, new

    for n in range(steps):
        into = np.maximum(0.0, y - p["wall_m"])
        tip = np.where(into > 0.0, np.maximum(0.0, p["wall_N_per_m"] * into + p["wall_N_s_per_m"] * w), 0.0)
        if n % RECORDED_EVERY == 0:
            noise = random.normal(size=(2, lanes)) * p["noise_N"]
            tip_seen = tip + noise[0]
        if n % TICK == 0:
            now = n // TICK % RING
            ring_leader[now] = counted(x, p["leader_count_m"])
            ring_follower[now] = counted(y, p["follower_count_m"])
            ring_tip[now] = tip_seen
            # The leader's controller.
            at = n % whole["leader_steps"] == 0
            seen = ring_leader[now]
            speed = leader_speed + leader_pass * ((seen - leader_old) / leader_dt - leader_speed)
            leader_speed = np.where(at, speed, leader_speed)
            leader_old = np.where(at, seen, leader_old)
            late_back = (n - whole["back_steps"]) // TICK % RING
            pf = -p["force_gain"] * ring_tip[late_back, each]
            pp = p["coupling_N_per_m"] * (ring_follower[late_back, each] - seen) - p["coupling_N_s_per_m"] * leader_speed
            at_wall = n % whole["virtual_steps"] == 0
            deep = np.maximum(0.0, seen - p["virtual_m"])
            virtual_N = np.where(at_wall, -(p["virtual_N_per_m"] * deep + p["virtual_N"] * (deep > 0.0)), virtual_N)
            wanted = np.clip(np.where(is_pf, pf, np.where(is_pp, pp, virtual_N)), -p["leader_limit_N"], p["leader_limit_N"])
            leader_told = np.where(at, np.where(p["late"] > 0.0, leader_next, wanted), leader_told)
            leader_next = np.where(at, wanted, leader_next)
            # The follower's.
            at = n % whole["follower_steps"] == 0
            late_there = (n - whole["there_steps"]) // TICK % RING
            asked, seen_y = ring_leader[late_there, each], ring_follower[now]
            speed = follower_speed + follower_pass * ((seen_y - follower_old) / follower_dt - follower_speed)
            follower_speed = np.where(at, speed, follower_speed)
            speed = asked_speed + follower_pass * ((asked - asked_old) / follower_dt - asked_speed)
            asked_speed = np.where(at, speed, asked_speed)
            follower_old, asked_old = np.where(at, seen_y, follower_old), np.where(at, asked, asked_old)
            error = asked - seen_y
            wanted = (p["servo_N_per_m"] * error + p["servo_N_s_per_m"] * (p["feed_velocity"] * asked_speed - follower_speed)
                      + sum_N)
            limited = np.clip(wanted, -p["follower_limit_N"], p["follower_limit_N"])
            growing = np.where(limited == wanted, follower_dt * p["servo_N_per_m_s"] * error, 0.0)
            sum_N = np.where(at, sum_N + growing, sum_N)
            follower_told = np.where(at, np.where(p["late"] > 0.0, follower_next, limited), follower_told)
            follower_next = np.where(at, limited, follower_next)
        # The bodies.
        leader_N += lag * (leader_told - leader_N)
        follower_N += lag * (follower_told - follower_N)
        k, part = n // 10, (n % 10) / 10.0
        hand_at = path[:, k] * (1.0 - part) + path[:, k + 1] * part
        hand_v = (path[:, k + 1] - path[:, k]) * 1e3
        hand = (p["hand_N_per_m"] * (hand_at - x) + p["hand_N_s_per_m"] * (hand_v - v)
                + shake[:, k] * (1.0 - part) + shake[:, k + 1] * part)
        rub, bend_x = friction(v, bend_x, p["leader_coulomb_N"], p["leader_static"], p["leader_kg"])
        v += STEP_S * (hand + leader_N - p["leader_viscous"] * v - rub) / p["leader_kg"]
        x += STEP_S * v
        rub, bend_y = friction(w, bend_y, p["follower_coulomb_N"], p["follower_static"], p["follower_kg"])
        w += STEP_S * (follower_N - tip - p["follower_viscous"] * w - rub) / p["follower_kg"]
        y += STEP_S * w
        # A rig that runs away is stopped, and is not used.
        lost = (np.abs(x) > 0.5) | (np.abs(y) > 0.5)
        if lost.any():
            x[lost], y[lost], v[lost], w[lost] = 0.4, 0.4, 0.0, 0.0
        if n % RECORDED_EVERY == 0:
            out[n // RECORDED_EVERY] = (counted(x, p["leader_count_m"]), counted(y, p["follower_count_m"]), -leader_told,
                                        tip_seen, hand + noise[1], follower_told)
    return out
