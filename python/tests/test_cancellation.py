# SPDX-License-Identifier: Apache-2.0
"""A cancellation from Python is the loop of the C++ library."""

import math
import os
import pathlib
import random
import subprocess
import threading
import time
import unittest

import numpy

import tactus
from programs import LOOP, ROOT, InAFolder

MODEL = (ROOT / "examples" / "cancellation-loop" / "model.toml").read_text(encoding="utf-8")
CYCLE_S = 200e-6


def cycles(count):
    generator = numpy.random.default_rng(7)
    position_m = 0.02 * numpy.sin(1e-3 * numpy.arange(count)) + 1e-5 * generator.normal(size=count)
    force_N = numpy.where(numpy.arange(count) % 500 < 60, -numpy.abs(generator.normal(size=count)), 0.0)
    return position_m, force_N


class Cancelling(InAFolder):
    def loop(self, position_m, force_N):
        """What the C++ loop makes of the cycles, and the time of one in s."""
        model = self.write("model.toml", MODEL)
        numpy.column_stack([position_m, force_N]).tofile("cycles")
        done = subprocess.run([LOOP, model, repr(CYCLE_S), "cycles", "intended"], capture_output=True, text=True,
                              check=True)
        return numpy.fromfile("intended"), 1e-9 * float(done.stdout)

    def test_an_array_and_single_steps_are_the_cxx_loop_bit_for_bit(self):
        position_m, force_N = cycles(20000)
        expected, _ = self.loop(position_m, force_N)
        whole = tactus.Cancellation("model.toml", sample_time_s=CYCLE_S).step(position_m, force_N)
        one = tactus.Cancellation("model.toml", sample_time_s=CYCLE_S)
        single = [one.step(float(x), float(f)) for x, f in zip(position_m, force_N)]
        two = tactus.Cancellation("model.toml", sample_time_s=CYCLE_S)
        halves = []
        for x, f in zip(position_m.tolist(), force_N.tolist()):
            halves.append(two.intended(x))
            two.advance(f)
        numpy.testing.assert_array_equal(whole, expected)
        numpy.testing.assert_array_equal(single, expected)
        numpy.testing.assert_array_equal(halves, expected)
        self.assertFalse(numpy.array_equal(expected, position_m))
        self.assertEqual(one.induced_position_m, two.induced_position_m)

    def test_keywords_are_the_files_keys(self):
        self.write("model.toml", MODEL)
        position_m, force_N = cycles(2000)
        of_file = tactus.Cancellation("model.toml", sample_time_s=CYCLE_S).step(position_m, force_N)
        by_sections = tactus.Cancellation(
            sample_time_s=CYCLE_S, control={"model": {"motor": {"mass_kg": 0.02}}})
        by_set = tactus.Cancellation(
            sample_time_s=CYCLE_S, set={"control.model.motor.mass_kg": 0.02})
        numpy.testing.assert_array_equal(by_sections.step(position_m, force_N), of_file)
        numpy.testing.assert_array_equal(by_set.step(position_m, force_N), of_file)
        other = tactus.Cancellation("model.toml", sample_time_s=CYCLE_S, control={"cancellation_model": "second-order"})
        self.assertFalse(numpy.array_equal(other.step(position_m, force_N), of_file))
        with self.assertRaises(tactus.RequestError) as caught:
            tactus.Cancellation("model.toml", sample_time_s=CYCLE_S, set={"control.model.motor.mass_kg": -1})
        self.assertEqual(caught.exception.parameter, "control.model.motor.mass_kg")
        with self.assertRaises(tactus.RequestError) as caught:
            tactus.Cancellation("missing.toml", sample_time_s=CYCLE_S)
        self.assertEqual(caught.exception.kind, "missing")
        with self.assertRaises(tactus.RequestError) as caught:
            tactus.Cancellation(sample_time_s=0.0)
        self.assertEqual(caught.exception.parameter, "sample_time_s")

    def test_shapes(self):
        one = tactus.Cancellation(sample_time_s=CYCLE_S)
        self.assertEqual(one.step(0, 0), 0.0)
        self.assertEqual(one.step(numpy.float64(0.01), numpy.int32(0)), 0.01)
        self.assertEqual(one.step([0.01, 0.02], 0.0).tolist(), [0.01, 0.02])
        self.assertEqual(one.step(numpy.array([]), numpy.array([])).shape, (0,))
        strided = numpy.arange(10.0)[::2]
        self.assertEqual(one.step(strided, numpy.zeros(5)).tolist(), strided.tolist())
        for wrong in (numpy.zeros(3), numpy.zeros((2, 1))):
            with self.assertRaisesRegex(ValueError, r"both of shape \(n,\)"):
                one.step(numpy.zeros(2), wrong)

    def test_a_number_that_is_not_finite_is_refused_and_changes_nothing(self):
        one, same = tactus.Cancellation(sample_time_s=CYCLE_S), tactus.Cancellation(sample_time_s=CYCLE_S)
        for bad in (float("nan"), float("inf")):
            for use in (lambda: one.step(bad, 0.0), lambda: one.step(0.0, bad), lambda: one.intended(bad),
                        lambda: one.advance(bad), lambda: one.step(numpy.array([0.01, bad]), 0.0)):
                with self.assertRaisesRegex(tactus.RequestError, "not a finite number") as caught:
                    use()
                self.assertEqual(caught.exception.kind, "out-of-bounds")
        self.assertEqual(one.step(0.01, -0.5), same.step(0.01, -0.5))
        self.assertEqual(one.step(0.01, 0.0), same.step(0.01, 0.0))

    def test_a_file_name_with_a_zero_byte_is_refused(self):
        with self.assertRaisesRegex(ValueError, "zero byte"):
            tactus.Cancellation("a\0b", sample_time_s=CYCLE_S)

    def test_after_close_every_use_is_an_error(self):
        with tactus.Cancellation(sample_time_s=CYCLE_S) as one:
            copy = one.copy()
        one.close()
        for use in (lambda: one.step(0.0, 0.0), lambda: one.step(numpy.zeros(2), numpy.zeros(2)),
                    lambda: one.intended(0.0), lambda: one.advance(0.0), one.reset, one.copy,
                    lambda: one.induced_position_m):
            with self.assertRaises(tactus.ReleasedError):
                use()
        self.assertEqual(copy.step(0.01, 0.0), 0.01)

    def test_random_calls(self):
        generator = random.Random(5)
        live, closed = [tactus.Cancellation(sample_time_s=CYCLE_S)], []
        for _ in range(20000):
            lives = not closed or generator.random() < 0.7
            one = generator.choice(live if lives else closed)
            use = generator.choice([lambda: one.step(0.001, -0.1), one.reset, lambda: one.advance(-0.1), one.copy,
                                    one.close])
            if not lives and use != one.close:
                with self.assertRaises(tactus.ReleasedError):
                    use()
                continue
            made = use()
            if isinstance(made, tactus.Cancellation):
                live.append(made) if len(live) < 100 else made.close()
            if use == one.close and lives:
                live.remove(one)
                closed.append(one)
                if not live:
                    live.append(tactus.Cancellation(sample_time_s=CYCLE_S))

    def test_time(self):
        """An array takes little more than the C++ loop, a single step some microseconds. The least of several tries."""
        position_m, force_N = cycles(200000)
        ratios, single_s = [], []
        for _ in range(7):
            _, loop_s = self.loop(position_m, force_N)
            one = tactus.Cancellation("model.toml", sample_time_s=CYCLE_S)
            start = time.process_time()
            one.step(position_m, force_N)
            ratios.append((time.process_time() - start) / len(position_m) / loop_s)
            start = time.process_time()
            for _ in range(10000):
                one.step(0.001, -0.1)
            single_s.append((time.process_time() - start) / 10000 - loop_s)
            if min(ratios) <= 1.2 and min(single_s) <= 2e-6:
                break
        print(f"array over loop {min(ratios):.2f}, one step {1e6 * min(single_s):.2f} us above it")
        self.assertLessEqual(min(ratios), 2.0)
        self.assertLessEqual(min(single_s), 10e-6)

    def test_other_threads_run_meanwhile(self):
        position_m, force_N = cycles(1000000)
        one, seen, done = tactus.Cancellation(sample_time_s=CYCLE_S), [0], threading.Event()

        def count():
            while not done.is_set():
                seen[0] += 1
                time.sleep(0.001)

        counter = threading.Thread(target=count)
        counter.start()
        before = seen[0]
        one.step(position_m, force_N)
        after = seen[0]
        done.set()
        counter.join()
        self.assertGreater(after, before + 2)


if __name__ == "__main__":
    unittest.main()
