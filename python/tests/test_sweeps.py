# SPDX-License-Identifier: Apache-2.0
"""Sweeps here and on the workers of a Dask cluster, of which one may die."""

import importlib.util
import unittest

import tactus
from kill_worker import kill_once, local_cluster
from programs import InAFolder

VARY = {"control.force_gain": [1.0, 2.0], "control.cancellation": ["off", "on"]}
needs_dask = unittest.skipIf(importlib.util.find_spec("distributed") is None, "install python3-distributed to run this")


class Sweeps(InAFolder):
    def test_a_sweep_is_what_run_finds_for_each_combination(self):
        shares = []
        found = tactus.sweep(self.quick(), VARY, task={"taps": 2}, progress=shares.append)
        self.assertEqual([list(one.settings.values()) for one in found],
                         [[1.0, "off"], [1.0, "on"], [2.0, "off"], [2.0, "on"]])
        self.assertEqual(shares, [0.25, 0.5, 0.75, 1.0])
        together = tactus.run("quick.toml", vary=VARY, task={"taps": 2})
        for one, row in zip(found, together.runs):
            self.assertEqual(one.values.runs[0].metrics.to_dict(), row.metrics.to_dict())

    def test_an_error_or_the_end_that_progress_wants_ends_it(self):
        with self.assertRaisesRegex(tactus.RequestError, "control.force_gain"):
            tactus.sweep(self.quick(), {"control.force_gain": [1.0, 1e9]})
        shares = []
        with self.assertRaises(tactus.Interrupted):
            tactus.sweep("quick.toml", VARY, progress=lambda share: bool(shares.append(share)))
        self.assertEqual(shares, [0.25])
        self.assertEqual(tactus.sweep("quick.toml", {"control.force_gain": "1.0,2.0"})[1].settings,
                         {"control.force_gain": "2.0"})

    @needs_dask
    def test_a_killed_worker_changes_nothing(self):
        file = self.quick()
        with local_cluster() as client:
            self.assertTrue(kill_once(client, file, after_tasks=2))
            with self.assertRaisesRegex(tactus.RequestError, "control.force_gain"):
                tactus.sweep(file, {"control.force_gain": [1e9]}, client=client)


if __name__ == "__main__":
    unittest.main()
