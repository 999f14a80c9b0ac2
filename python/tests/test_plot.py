# SPDX-License-Identifier: Apache-2.0
"""Figures show the numbers of the results and logs, and their axes have units."""

import csv
import importlib.util
import subprocess
import sys
import unittest

import numpy

import tactus
from programs import EXPERIMENTS, RECORDINGS, InAFolder

MISSING = importlib.util.find_spec("matplotlib") is None

CANCELLATION, GAIN = "control.cancellation", "control.force_gain"


def labels(ax):
    return ax.get_xlabel(), ax.get_ylabel()


def line(ax, label):
    """The data of the only line with this label."""
    found = [one for one in ax.get_lines() if one.get_label() == label]
    if len(found) != 1:
        raise AssertionError(f"{len(found)} lines are labelled {label!r}, of {[one.get_label() for one in ax.get_lines()]}")
    return numpy.asarray(found[0].get_xdata(), float), numpy.asarray(found[0].get_ydata(), float)


class WithoutMatplotlib(unittest.TestCase):
    def python(self, code):
        return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)

    def test_the_error_names_the_package(self):
        done = self.python("import sys; sys.modules['matplotlib'] = None; import tactus\n"
                           "tactus.plot.recording(tactus.read_log(sys.argv[1]) if len(sys.argv) > 1 else "
                           f"tactus.read_log({str(RECORDINGS / 'shaking-contact.csv')!r}))")
        self.assertIn("ImportError: tactus.plot needs Matplotlib, which is not installed: install the package "
                      "python3-matplotlib", done.stderr)

    def test_the_import_of_tactus_does_not_load_it(self):
        self.assertEqual(self.python("import sys, tactus.plot; print('matplotlib' in sys.modules)").stdout, "False\n")


class Words(unittest.TestCase):
    def test_keys_in_words(self):
        from tactus._figures import in_words, label_of, setting_of

        for key, words, unit in (
            ("control.force_gain", "force gain", ""),
            ("environment.stiffness_N_per_m", "environment stiffness", "N/m"),
            ("control.model.hand.damping_N_s_per_m", "hand damping", "N s/m"),
            ("control.model.hand.quintic_stiffness_N_per_m5", "hand quintic stiffness", "N/m⁵"),
            ("servo.rate_Hz", "servo rate", "Hz"),
            ("commanded_torque_Nm", "commanded torque", "N m"),
            ("velocity_rad_per_s", "velocity", "rad/s"),
            ("task.mismatch.mass", "mismatch mass", ""),
            ("decay_per_s", "decay", "1/s"),
            ("m", "m", ""),
        ):
            with self.subTest(key):
                self.assertEqual(in_words(key), (words, unit))
        self.assertEqual(label_of("environment.stiffness_N_per_m"), "environment stiffness (N/m)")
        self.assertEqual(setting_of("control.force_limit_N", 2.5), "force limit 2.5 N")
        self.assertEqual(setting_of(CANCELLATION, "off"), "cancellation off")


@unittest.skipIf(MISSING, "install python3-matplotlib to run this")
class Figures(InAFolder):
    def setUp(self):
        super().setUp()
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        self.pyplot = pyplot
        self.addCleanup(pyplot.close, "all")

    def drawn(self, figure):
        """Everything can be drawn, and the layout leaves every axes its space."""
        figure.canvas.draw()
        for ax in figure.axes:
            self.assertGreater(ax.get_window_extent().width, 40)
            self.assertGreater(ax.get_window_extent().height, 40)
        return figure.axes

    def sweep(self):
        return tactus.run(self.quick(), vary={CANCELLATION: ["off", "on"], GAIN: [1, 4, 15]}, out="run", overwrite=True)

    def test_taps_are_those_of_the_log(self):
        result = self.sweep()
        log = tactus.read_log("run/log")
        axes = self.drawn(tactus.plot.taps(log, result))
        self.assertEqual(len(axes), 4 * 3)
        self.assertEqual([ax.get_title() for ax in axes[:3]], ["force gain 1", "force gain 4", "force gain 15"])
        self.assertEqual(axes[0].get_ylabel(), "cancellation off\nforce (N)")
        self.assertEqual(axes[6].get_ylabel(), "cancellation on\nforce (N)")
        self.assertEqual(labels(axes[9]), ("time since touch (ms)", "position (mm)"))
        self.assertEqual([ax.get_ylim() for ax in axes[0:3]], [axes[6].get_ylim()] * 3, "forces have one scale")
        table = log["/run_5/teleoperator"]  # cancellation on, force gain 4
        touch_s = table["touched_at_s"][table["touched"] > 0.5][0]
        shown = (table["time_s"] >= touch_s - 0.01) & (table["time_s"] < touch_s + 0.15)
        self.assertGreater(shown.sum(), 700)
        for ax, label, name, scale in (
            (axes[7], "force on the hand", "displayed_force_N", 1.0),
            (axes[7], "force sent by the follower", "sent_force_N", 1.0),
            (axes[10], "leader, measured", "master_position_m", 1e3),
            (axes[10], "follower's tip", "tip_position_m", 1e3),
            (axes[10], "follower's command", "command_m", 1e3),
            (axes[10], "induced motion, estimated", "induced_position_m", 1e3),
        ):
            with self.subTest(label):
                time_ms, values = line(ax, label)
                numpy.testing.assert_allclose(time_ms, 1e3 * (table["time_s"][shown] - touch_s), atol=1e-9)
                numpy.testing.assert_array_equal(values, scale * table[name][shown])

    def test_one_tap_in_axes_of_the_caller(self):
        tactus.run(self.quick(), out="run")
        table = tactus.read_log("run/log")["/teleoperator"]
        figure, axes = self.pyplot.subplots(2)
        self.assertIs(tactus.plot.taps(table, axes=axes), figure)
        self.assertEqual([ax.get_ylabel() for ax in axes], ["force (N)", "position (mm)"])
        self.assertIsNotNone(axes[0].get_legend())
        with self.assertRaisesRegex(ValueError, "1 axes were given, and the figure has 2 x 1: pass 2, row by row, or none"):
            tactus.plot.taps(table, axes=axes[0])
        self.assertEqual(len(self.pyplot.get_fignums()), 1, "no figure was made that nobody sees")
        logarithmic = self.pyplot.subplots(2)[1]
        logarithmic[1].set_yscale("log")
        tactus.plot.taps(table, axes=logarithmic)
        self.assertEqual(logarithmic[1].get_yscale(), "log", "axes of the caller keep their look")
        result = self.sweep()
        del result.values.to_dict()["runs"][4:]
        with self.assertRaisesRegex(ValueError, "/run_5/teleoperator has no run in this result, which has 4"):
            tactus.plot.taps(tactus.read_log("run/log"), result)
        with self.assertRaisesRegex(ValueError, "this log has no taps of one axis"):
            tactus.plot.taps(tactus.read_log(RECORDINGS / "shaking-contact.csv"))

    def test_settling_is_that_of_the_result(self):
        result = self.sweep()
        time, share = self.drawn(tactus.plot.settling(result))
        self.assertEqual(labels(time), ("force gain", "settling time (ms)"))
        self.assertEqual(labels(share), ("force gain", "taps that settle (%)"))
        for place, name in ((0, "cancellation off"), (3, "cancellation on")):
            metrics = [run.metrics for run in result.runs[place:place + 3]]
            for ax, label, member, scale in (
                (time, name, "settling_time_median_s", 1e3), (time, f"{name}, 90th percentile", "settling_time_p90_s", 1e3),
                (share, name, "settled_fraction", 100.0),
            ):
                with self.subTest(label):
                    gains, values = line(ax, label)
                    self.assertEqual(gains.tolist(), [1, 4, 15])
                    self.assertEqual(values.tolist(), [scale * one[member] for one in metrics])
        self.assertEqual(set(line(time, "observation")[1]), {150.0})
        with self.assertRaisesRegex(ValueError, "servo.rate_Hz is not varied in this result; varied are control.canc"):
            tactus.plot.settling(result, over="servo.rate_Hz")
        with self.assertRaisesRegex(ValueError, "no key of this result has two numbers or more"):
            tactus.plot.settling(tactus.run(self.quick(), vary={CANCELLATION: ["off", "on"]}))

    def test_settling_of_two_arms_has_no_time(self):
        runs = [{"set": {GAIN: gain}, "metrics": {"settled_fraction": share}} for gain, share in ((2, 0.5), (1, 1.0))]
        result = tactus.Result("", "", None, tactus.Record({}), tactus.Record({"runs": runs}), "")
        (ax,) = self.drawn(tactus.plot.settling(result))
        self.assertEqual([values.tolist() for values in line(ax, "taps that settle")], [[1, 2], [100, 50]])

    def test_a_map_has_limits_and_verdicts(self):
        result = tactus.stability("map", EXPERIMENTS / "stability-map.toml", out="map", vary={
            CANCELLATION: ["off", "on"], GAIN: "0.5:30:6[log]", "environment.stiffness_N_per_m": "1e3:1e5:5[log]"})
        gains = numpy.asarray(result.values["axes"][1]["values"])
        limits = [numpy.nan if limit is None else limit for limit in result.settled_limit]
        for folder in (None, "map"):
            axes = self.drawn(tactus.plot.stability_map(result, folder))
            self.assertEqual([ax.get_title() for ax in axes], ["cancellation off", "cancellation on"])
            self.assertEqual(labels(axes[0]), ("environment stiffness (N/m)", "force gain"))
            self.assertEqual((axes[0].get_xscale(), axes[0].get_yscale()), ("log", "log"))
            for place, ax in enumerate(axes):
                numpy.testing.assert_array_equal(line(ax, "limit of the force gain")[1], limits[5 * place:5 * place + 5])
        with open("map/map.csv", encoding="utf-8") as file:
            verdicts = [row["verdict"] for row in csv.DictReader(file)]
        order = ["settled", "ringing", "limit-cycle", "diverged"]
        self.assertGreater(len(set(verdicts)), 1)
        cells = [ax.collections[0].get_array() for ax in axes]
        self.assertEqual([order[int(cell)] for one in cells for cell in numpy.ravel(one)], verdicts)
        low, high = axes[0].get_ylim()
        self.assertTrue(low < gains[0] and gains[-1] < high, "a cell lies around its values")
        with self.assertRaisesRegex(ValueError, "this map has no plane"):
            tactus.plot.stability_map(tactus.stability("map", EXPERIMENTS / "stability-map.toml", vary={GAIN: [1, 2]}))

    def test_a_map_of_two_arms_has_their_limits(self):
        points = [{"hand": hand, "set": {"task.pose": pose, "control.architecture": "position-force"},
                   "drawn_limit": limit, "drawn_limit_censored": limit == 32.0}
                  for hand, pose, limit in (("own", 1, 3.0), ("own", 0, 2.0), ("light", 0, 1.5), ("light", 1, 32.0))]
        result = tactus.Result("", "", 1, tactus.Record({}), tactus.Record({"points": points}), "")
        (ax,) = self.drawn(tactus.plot.stability_map(result))
        self.assertEqual(labels(ax), ("pose", "limit of the force gain"))
        self.assertEqual(line(ax, "hand own, architecture position-force")[1].tolist(), [2.0, 3.0])
        self.assertEqual(line(ax, "hand light, architecture position-force")[1].tolist(), [1.5, 32.0])
        self.assertEqual([values.tolist() for values in line(ax, "beyond the search")], [[1], [32]])

    def test_an_episode_is_its_table(self):
        time_s = 0.02 * numpy.arange(100)
        leader, follower = numpy.sin(time_s), 0.9 * numpy.sin(time_s)
        columns = {"time_s": time_s, "leader.elbow.position_rad": leader, "follower.elbow.position_rad": follower,
                   "follower.elbow.commanded_position_rad": leader + 0.1, "follower.elbow.external_torque_Nm": 3 * leader,
                   "leader.slide.position_m": leader, "follower.slide.position_m": follower,
                   "follower.slide.commanded_position_m": leader, "follower.slide.external_force_N": -leader}
        with open("episode_1.csv", "w", encoding="utf-8") as file:
            file.write(",".join([*columns, "leader.state", "leader.cause"]) + "\n")
            for row in zip(*columns.values()):
                file.write(",".join([*(repr(float(value)) for value in row), "active", "none"]) + "\n")
        for source in (columns, "episode_1.csv"):
            axes = self.drawn(tactus.plot.episode(source))
            self.assertEqual([ax.get_ylabel() for ax in axes],
                             ["elbow\nposition (rad)", "error (rad)", "torque (N m)",
                              "slide\nposition (m)", "error (m)", "force (N)"])
            self.assertEqual([ax.get_xlabel() for ax in axes[3:]], ["time (s)"] * 3)
            for ax, label, values in ((axes[0], "leader", leader), (axes[0], "follower", follower),
                                      (axes[1], "tracking error", leader + 0.1 - follower),
                                      (axes[2], "external torque", 3 * leader), (axes[5], "external force", -leader)):
                numpy.testing.assert_array_equal(line(ax, label), [time_s, values])
        self.assertEqual(len(tactus.plot.episode(columns, joints=["slide"]).axes), 3)
        with self.assertRaisesRegex(ValueError, "this episode has no joint 'knee'; it has elbow, slide"):
            tactus.plot.episode(columns, joints=["knee"])
        with self.assertRaisesRegex(ValueError, "--wide --out episodes"):
            tactus.plot.episode({"time_s": time_s})
        with self.assertRaisesRegex(tactus.RequestError, "missing"):
            tactus.plot.episode("missing/log")

    def test_a_recording_has_a_panel_for_each_unit_and_its_oscillations(self):
        log = tactus.read_log(RECORDINGS / "shaking-contact.csv")
        table = log["shaking-contact.csv"]
        found = tactus.diagnose(RECORDINGS / "shaking-contact.csv")
        position, force = self.drawn(tactus.plot.recording(log, found))
        self.assertEqual((position.get_ylabel(), *labels(force)), ("position (m)", "time (s)", "force (N)"))
        for ax, label, name in ((position, "leader position", "master_position"), (force, "tip force", "tip_force")):
            numpy.testing.assert_array_equal(line(ax, label), [table["time"], table[name]])
        oscillation = found.oscillations[0]
        band = force.patches[0]
        self.assertEqual(band.get_label(), f"{oscillation.frequency_Hz:.3g} Hz, induced-motion")
        self.assertEqual((min(band.get_xy()[:, 0]), max(band.get_xy()[:, 0])), (oscillation.from_s, oscillation.to_s))
        self.assertEqual(len(tactus.plot.recording(table, columns=["tip_force"]).axes), 1)
        (ax,) = tactus.plot.recording(table, found, columns=["tip_force"], from_s=1.0, to_s=1.2).axes
        time_s, values = line(ax, "tip force")
        self.assertEqual((time_s[0], time_s[-1]), (1.0, 1.2))
        numpy.testing.assert_array_equal(values, table["tip_force"][1000:1201])
        with self.assertRaisesRegex(ValueError, "has no row from 9 s to 3.499 s; it ends at 3.499 s"):
            tactus.plot.recording(table, from_s=9.0)
        with self.assertRaisesRegex(ValueError, "has no column 'farce'; it has time, "):
            tactus.plot.recording(table, columns=["farce"])


if __name__ == "__main__":
    unittest.main()
