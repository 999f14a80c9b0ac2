# SPDX-License-Identifier: Apache-2.0
"""A running pair, with arms whose driver is written in Python."""

import ctypes
import importlib.util
import json
import time
import unittest

import numpy

import arms
import tactus
from programs import ROOT, InAFolder

JOINT = """
[arm.{side}.{name}]
motor = {motor}
lower_rad = -1.5
upper_rad = 1.5
velocity_limit_rad_per_s = 3.0
torque_limit_Nm = 2.5
torque_rate_limit_Nm_per_s = 100.0
"""
# Longer than the machine of a test may keep a thread waiting.
RELAXED = {"supervision": {"longest_stall_s": 0.5, "watchdog": {"timeout_s": 0.5}, "overload": {"missed_share": 0.9}}}


class Running(InAFolder):
    def rig(self, leader, follower, watchdog_s=0.2):
        text = ""
        for side, bus in (("leader", leader), ("follower", follower)):
            text += f'[arm.{side}]\nbus = "{bus}"\nport = "{side}"\nwatchdog_s = {watchdog_s}\n'
            text += "".join(JOINT.format(side=side, name=name, motor=motor)
                            for motor, name in ((1, "shoulder"), (2, "elbow")))
        return self.write("rig.toml", text)

    def pair(self, rig, **more):
        made = tactus.Teleoperator(ROOT / "examples" / "rigs" / "joints.toml", rig, control=RELAXED, **more)
        self.addCleanup(made.close)
        return made

    def follow(self, pair):
        pair.press("arm")
        pair.wait_until("active")
        return pair

    def test_arms_in_python_are_coupled_and_every_cycle_is_in_the_log(self):
        tactus.register_device("stand-in", arms.StandIn)
        pair = self.follow(self.pair(self.rig("stand-in", "stand-in"), log_folder="log"))
        self.assertEqual((pair.joints, pair.turns), (("shoulder", "elbow"), (True, True)))
        pair.press("start")
        first = pair.newest()
        time.sleep(0.5)
        pair.press("keep")
        time.sleep(0.1)
        second = pair.newest()
        self.assertGreater(second.time_ns, first.time_ns)
        self.assertLess(abs(second.time_ns - time.monotonic_ns()), 1e9)
        self.assertEqual(second.follower.position.shape, (2,))
        numpy.testing.assert_allclose(second.follower.position, second.leader.position, atol=0.1)
        pair.press("release")
        pair.wait_until("armed")
        pair.press("press")
        pair.wait_until("active")
        report = pair.stop()
        self.assertEqual((report.armings, report.log_dropped), (2, 0), "armed, and again when the switch was released")
        self.assertGreater(report.active_cycles, 250)
        self.assertFalse(pair.state().running)
        with self.assertRaisesRegex(tactus.JobError, "start it again"):
            pair.press("arm")
        log = tactus.read_log("log")
        self.assertEqual(len(log["/slave/joint_2"].times_ns), report.cycles)
        self.assertEqual(len(log["/episodes"].times_ns), 2)
        self.assertEqual(int(log["/episodes"].times_ns[0]) < int(log["/episodes"].times_ns[1]), True)
        with self.subTest("the figure of an episode"):
            self.expect_figure("log", log)

    def expect_figure(self, folder, log):
        """The figure of the longest episode shows what the log has."""
        if importlib.util.find_spec("matplotlib") is None:
            self.skipTest("install python3-matplotlib to run this")
        import matplotlib

        matplotlib.use("Agg")
        tables = [one for one in json.loads(tactus.command("export", folder, "--wide", "--out", "episodes",
                                                           "--json").results)["episodes"] if one["file"]]
        longest = max(tables, key=lambda one: one["to_s"] - one["from_s"])
        axes = tactus.plot.episode(folder, number=longest["number"]).axes
        self.assertEqual([ax.get_ylabel().split("\n")[0] for ax in axes if "position" in ax.get_ylabel()],
                         ["shoulder", "elbow"])
        leader, follower = axes[0].get_lines()
        self.assertEqual((leader.get_label(), follower.get_label()), ("leader", "follower"))
        self.assertAlmostEqual(leader.get_xdata()[-1], longest["to_s"] - longest["from_s"], delta=0.021)
        for line, topic in ((leader, "/master/joint_1"), (follower, "/slave/joint_1")):
            there = log[topic]["position_rad"]
            self.assertTrue((line.get_ydata() >= there.min()).all() and (line.get_ydata() <= there.max()).all())
        with self.assertRaisesRegex(ValueError, "has no table of episode 99; episodes with a table: "):
            tactus.plot.episode(folder, number=99)

    def held_by(self, kind, own_process=False, watchdog_s=0.2):
        """A follower that fails once it follows: both hold."""
        tactus.register_device("stand-in", arms.StandIn)
        tactus.register_device("fails", kind, own_process=own_process)
        pair = self.pair(self.rig("stand-in", "fails", watchdog_s))
        pair.press("arm")
        end = time.monotonic() + 30.0
        while time.monotonic() < end:
            now = pair.state()
            if now.follower in ("hold", "fault"):
                break
            time.sleep(0.01)
        self.assertIn(now.follower, ("hold", "fault"), now.line)
        end = time.monotonic() + 2.0  # forces fall at the rate limits of the gates
        while time.monotonic() < end and any(pair.newest().leader.command):
            time.sleep(0.02)
        sample = pair.newest()
        numpy.testing.assert_array_equal(sample.leader.command, 0.0)
        numpy.testing.assert_array_equal(sample.follower.command, 0.0)
        end = time.monotonic() + 3.0  # the line is that of the last whole second
        while f"follower {now.follower}" not in pair.state().line and time.monotonic() < end:
            time.sleep(0.05)
        return pair

    def test_a_driver_that_raises_ends_in_hold_with_its_reason(self):
        pair = self.held_by(arms.Throws)
        self.assertIn("arm.follower: OSError: the robot reported a collision", pair.state().line)

    def test_a_driver_that_sleeps_ends_in_hold_with_the_reason(self):
        pair = self.held_by(arms.Sleeps, watchdog_s=0.1)
        self.assertRegex(pair.state().line, r"follower: \w+ not responding for")

    def test_a_driver_that_is_killed_ends_in_hold_with_the_reason(self):
        pair = self.held_by(arms.Dies, own_process=True)
        self.assertIn("arm.follower: the process of the device ended (exit status -9): start it again",
                      pair.state().line)

    def test_what_is_wrong_is_refused_before_anything_runs(self):
        tactus.register_device("stand-in", arms.StandIn)
        joints = ROOT / "examples" / "rigs" / "joints.toml"
        with self.assertRaisesRegex(tactus.RequestError, "no-such.toml"):
            tactus.Teleoperator(joints, "no-such.toml")
        with self.assertRaisesRegex(tactus.RequestError, "drives a rig"):
            tactus.Teleoperator(ROOT / "experiments" / "contest.toml", self.rig("stand-in", "stand-in"))
        with self.assertRaisesRegex(tactus.RequestError, "no emulated motors"):
            tactus.Teleoperator(joints, self.rig("stand-in", "stand-in"), rehearsal=True)
        with self.assertRaises(tactus.RequestError):
            tactus.register_device("damiao", arms.StandIn)
        pair = self.pair(self.rig("stand-in", "stand-in"))
        with self.assertRaisesRegex(tactus.RequestError, "arm, press, release"):
            pair.press("fly")
        pair.close()
        pair.close()
        with self.assertRaises(tactus.ReleasedError):
            pair.state()

    def test_a_device_that_cannot_be_opened_is_named(self):
        class Absent(arms.StandIn):
            def open(self):
                raise ConnectionError(f"no robot answers at {self.port}: switch it on")

        tactus.register_device("absent", Absent)
        with self.assertRaisesRegex(tactus.JobError, "no robot answers at leader: switch it on"):
            tactus.Teleoperator(ROOT / "examples" / "rigs" / "joints.toml", self.rig("absent", "absent"))


class Structs(unittest.TestCase):
    def test_a_struct_of_another_size_is_refused(self):
        from tactus import _library

        options = _library.TeleoperatorOptions()
        options.struct_size = 8
        made = ctypes.c_uint64(5)
        with self.assertRaisesRegex(tactus.RequestError, "another size"):
            _library.call(_library.library().tactus_teleoperator_start, ctypes.byref(options), ctypes.byref(made))
        self.assertEqual(made.value, 0)


if __name__ == "__main__":
    unittest.main()
