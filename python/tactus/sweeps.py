# SPDX-License-Identifier: Apache-2.0
"""Experiments over many combinations of keys, on the workers of a Dask cluster or one after the other."""

from __future__ import annotations

import contextlib
import itertools
import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Dict, Generator, Iterable, Iterator, List, Mapping, Sequence, Tuple

from ._words import Path, Section, assignments, paths
from .commands import Progress, run
from .errors import Interrupted
from .results import Record

if TYPE_CHECKING:
    import distributed
    import pandas

__all__ = ["Sweep", "SweepRun", "sweep"]

Settings = Dict[str, Any]
Computed = Generator[Tuple[int, Dict[str, Any]], None, None]


@dataclass(frozen=True)
class SweepRun:
    """One combination of a sweep.

    Attributes:
        settings: value of each varied key.
        values: what `tactus.run` finds with these settings; members as in `Result.values`.
    """

    settings: Settings
    values: Record


class Sweep(Sequence[SweepRun]):
    """All combinations of a sweep, the first key slowest."""

    def __init__(self, runs: Sequence[SweepRun]) -> None:
        self._runs = list(runs)

    def __len__(self) -> int:
        return len(self._runs)

    def __getitem__(self, index: Any) -> Any:
        return self._runs[index]

    def __iter__(self) -> Iterator[SweepRun]:
        return iter(self._runs)

    def frame(self, table: str = "runs") -> pandas.DataFrame:
        """A data frame of this table of the results, `values.frame(table)`, with the settings of each row in front."""
        import pandas

        frames: List[pandas.DataFrame] = []
        for one in self._runs:
            frame = one.values.frame(table)
            for position, (key, value) in enumerate(one.settings.items()):
                frame.insert(position, key, value)
            frames.append(frame)
        return pandas.concat(frames, ignore_index=True)


def _combinations(vary: Mapping[str, Iterable[Any] | str]) -> List[Settings]:
    values = [one.split(",") if isinstance(one, str) else list(one) for one in vary.values()]
    return [dict(zip(vary, combination)) for combination in itertools.product(*values)]


def _run_task(experiment: str, with_: Sequence[str], set: Settings) -> Dict[str, Any]:
    """A task: one combination. The arguments are its key; equal arguments give equal values in any process."""
    return run(experiment, with_=with_, set=set).values.to_dict()


def _computed_here(tasks: Sequence[Sequence[Any]]) -> Computed:
    for number, task in enumerate(tasks):
        yield number, _run_task(*task)


def _computed_by(client: Any, tasks: Sequence[Sequence[Any]]) -> Computed:
    import distributed

    as_completed: Any = distributed.as_completed  # it has no types
    # Not `pure`: a file may have another content than in an earlier sweep.
    futures = [client.submit(_run_task, *task, pure=False) for task in tasks]
    numbers = {future.key: number for number, future in enumerate(futures)}
    try:
        for future in as_completed(futures):
            yield numbers[future.key], future.result()
    finally:
        client.cancel(futures)


def sweep(
    experiment: Path,
    vary: Mapping[str, Iterable[Any] | str],
    *,
    client: distributed.Client | None = None,
    with_: Path | Sequence[Path] = (),
    set: Section | None = None,
    progress: Progress | None = None,
    **sections: Section,
) -> Sweep:
    """Runs an experiment in virtual time for each combination of the varied keys, each as a task of its own.

        from distributed import Client
        found = tactus.sweep("experiments/tapping.toml", {"control.force_gain": [1, 3, 15]}, client=Client())
        found[0].settings, found[0].values.runs[0].metrics.verdict

    Args:
        experiment: file in TOML. Each worker reads it, and the files of `with_`, by the absolute name that it has here.
        vary: values of keys, {"control.force_gain": [1, 3, 15]}.
        client: `distributed.Client` of a Dask cluster, whose workers run the tasks. If a worker dies, Dask runs its tasks
            again on another one; results are equal bit for bit. None: this process runs the tasks one after the other.
        with_: files whose keys take the place of the experiment's.
        set: overrides by dotted key.
        progress: called with the share of the tasks that is done, 0 to 1; if it returns False, the sweep ends and
            `Interrupted` is raised.
        sections: overrides as sections of the file, control={"force_limit_N": 2.0}.

    Raises:
        RequestError, JobError: of the first task that fails; the others are cancelled.
        Interrupted: `progress` returned False.
    """
    combinations = _combinations(vary)
    files = [os.path.abspath(file) for file in paths(with_)]
    fixed = dict(assignments(sections))
    fixed.update(assignments(set or {}))
    tasks = [(os.path.abspath(experiment), files, {**fixed, **settings}) for settings in combinations]
    found: Dict[int, Dict[str, Any]] = {}
    computed = _computed_here(tasks) if client is None else _computed_by(client, tasks)
    with contextlib.closing(computed):
        for number, values in computed:
            found[number] = values
            if progress is not None and progress(len(found) / len(tasks)) is False:
                raise Interrupted("interrupted: run it again", kind="interrupted")
    return Sweep([SweepRun(settings, Record(found[number])) for number, settings in enumerate(combinations)])
