# SPDX-License-Identifier: Apache-2.0
"""The plug-in in a small stand-in for LeRobot's recording loop, with the emulated motors of two arms in the place of real
ones. Each motor turns a joint of its own, without weight, and nobody moves the leader.

TACTUS_EPISODES and TACTUS_EPISODE_S: how many episodes of how many seconds; for a long run by hand 10 and 10.
"""

import importlib.metadata
import os
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest

import numpy

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent.parent
EPISODES, EPISODE_S = int(os.environ.get("TACTUS_EPISODES", "2")), float(os.environ.get("TACTUS_EPISODE_S", "1.5"))
FPS = 60

if "TACTUS_REAL_LEROBOT" not in os.environ:
    sys.path.insert(0, str(HERE / "stand_in"))
sys.path.insert(0, str(HERE.parent))

import tactus  # noqa: E402
from lerobot_robot_tactus import TactusLeader, TactusLeaderConfig, TactusRobot, TactusRobotConfig  # noqa: E402

ARMS = {"experiment": str(ROOT / "examples" / "rigs" / "joints.toml"),
        "rig": str(ROOT / "examples" / "rigs" / "openarm-arms.toml"), "rehearsal": True}
JOINTS = [*(f"joint_{i}" for i in range(1, 8)), "gripper"]


class Features(unittest.TestCase):
    def test_they_are_known_before_anything_is_connected(self):
        robot = TactusRobot(TactusRobotConfig(**ARMS))
        leader = TactusLeader(TactusLeaderConfig(**ARMS, use_velocity_and_torque=True))
        self.assertEqual(list(robot.action_features), [f"{joint}.pos" for joint in JOINTS])
        self.assertEqual(len(robot.observation_features), 4 * len(JOINTS))
        self.assertIn("joint_3.external_torque", robot.observation_features)
        self.assertEqual(len(leader.action_features), 3 * len(JOINTS))
        self.assertFalse(robot.is_connected)
        with self.assertRaisesRegex(RuntimeError, "not connected"):
            robot.get_observation()

    def test_both_are_registered_under_their_word(self):
        self.assertIs(type(TactusRobotConfig(**ARMS)).choices["tactus"], TactusRobotConfig)
        self.assertIs(type(TactusLeaderConfig(**ARMS)).choices["tactus"], TactusLeaderConfig)

    def test_the_installed_distribution_has_the_name_that_lerobot_imports(self):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder) / "source"
            # Only what is packed: a build leaves files in its folder.
            for file in ("pyproject.toml", "setup.py", *(f"lerobot_robot_tactus/{one.name}" for one in
                                                         (HERE.parent / "lerobot_robot_tactus").glob("*.py"))):
                (source / file).parent.mkdir(parents=True, exist_ok=True)
                (source / file).write_bytes((HERE.parent / file).read_bytes())
            done = subprocess.run([sys.executable, "-m", "pip", "install", "--no-index", "--no-build-isolation",
                                   "--no-deps", "--target", f"{folder}/installed", str(source)],
                                  capture_output=True, text=True, check=False)
            if "No module named pip" in done.stderr:
                self.skipTest("install python3-pip to run this")
            self.assertEqual(done.returncode, 0, done.stderr)
            names = [one.metadata["Name"] for one in importlib.metadata.distributions(path=[f"{folder}/installed"])]
            self.assertEqual(names, ["lerobot_robot_tactus"], "LeRobot compares the raw name, underscores included")
            self.assertTrue((pathlib.Path(folder) / "installed" / names[0] / "__init__.py").exists())


class Connecting(unittest.TestCase):
    def test_after_an_error_nothing_is_connected(self):
        from lerobot.cameras import CameraConfig

        cameras = {"wrist": CameraConfig(), "top": CameraConfig()}
        robot = TactusRobot(TactusRobotConfig(**ARMS, cameras=cameras))

        def fail():
            raise OSError("no such camera")

        robot.cameras["top"].connect = fail
        with self.assertRaisesRegex(OSError, "no such camera"):
            robot.connect()
        self.assertFalse(robot.cameras["wrist"].is_connected)
        robot = TactusRobot(TactusRobotConfig(**{**ARMS, "rig": "none.toml"}, cameras=cameras))
        with self.assertRaisesRegex(tactus.RequestError, "none.toml"):
            robot.connect()
        self.assertFalse(robot.cameras["wrist"].is_connected)
        with self.assertRaisesRegex(RuntimeError, "not connected"):
            robot.disconnect()


class Recording(unittest.TestCase):
    def test_episodes_are_recorded_while_the_servo_thread_drives_both_arms(self):
        from lerobot.cameras import CameraConfig

        with tempfile.TemporaryDirectory() as folder:
            pair = {**ARMS, "log_folder": f"{folder}/log"}
            robot = TactusRobot(TactusRobotConfig(**pair, cameras={"wrist": CameraConfig()}))
            leader = TactusLeader(TactusLeaderConfig(**pair))
            robot.connect()
            leader.connect()
            self.assertTrue(robot.is_connected and leader.is_connected)
            frames, skews_s = [], []
            for _episode in range(EPISODES):
                start = time.monotonic()
                for frame in range(round(EPISODE_S * FPS)):
                    observation = robot.get_observation()
                    sent = robot.send_action(leader.get_action())
                    sample = robot._pair.running.newest()
                    skews_s.append(abs(observation["wrist"] - sample.time_ns) * 1e-9)
                    frames.append({**observation, **{f"action.{key}": value for key, value in sent.items()}})
                    time.sleep(max(0.0, start + (frame + 1) / FPS - time.monotonic()))
            report = robot._pair.running.stop()
            leader.disconnect()
            robot.disconnect()
            log = tactus.read_log(f"{folder}/log")
        self.assertEqual(len(frames), EPISODES * round(EPISODE_S * FPS))
        features = {**robot.observation_features, **{f"action.{key}": kind for key, kind in robot.action_features.items()}}
        self.assertEqual(set(frames[0]), set(features))
        for key, kind in features.items():
            if kind is float:
                self.assertTrue(all(numpy.isfinite(frame[key]) for frame in frames), key)
        led = numpy.array([[frame[f"action.{joint}.pos"] for joint in JOINTS] for frame in frames])
        followed = numpy.array([[frame[f"{joint}.pos"] for joint in JOINTS] for frame in frames])
        print(f"{len(frames)} frames; the follower at most {numpy.abs(led - followed).max():.2f} degrees from its leader; "
              f"camera apart by {1e3 * numpy.median(skews_s):.2f} ms, at most {1e3 * max(skews_s):.2f} ms; {report}")
        self.assertLess(numpy.abs(led - followed).max(), 5.0)
        self.assertEqual(report.log_dropped, 0)
        self.assertEqual(report.armings, 1)
        self.assertEqual(len(log["/slave/site"].times_ns), report.cycles)


if __name__ == "__main__":
    unittest.main()
