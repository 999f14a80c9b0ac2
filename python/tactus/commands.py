# SPDX-License-Identifier: Apache-2.0
"""The commands of tactus as functions. Each returns what the command prints with `--json`."""

from __future__ import annotations

import contextlib
import ctypes
import json
import os
import tempfile
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, Iterator, List, Mapping, Sequence, Union

from . import _library
from ._words import Path, file_word, options, paths, repeated, set_texts, vary_texts
from .errors import TactusError
from .results import Record

if TYPE_CHECKING:
    import pandas
    from numpy.typing import ArrayLike

    Recording = Union[Path, Mapping[str, ArrayLike], pandas.DataFrame]

__all__ = [
    "Output", "Result", "advise", "command", "diagnose", "estimate", "faults", "identify", "reference", "results_schema",
    "run", "schema", "stability",
]

Progress = Callable[[float], Any]
Section = Mapping[str, Any]


@dataclass(frozen=True)
class Output:
    """What a command prints.

    Attributes:
        exit_status: 0, or what a command means by another number without an error, as `replay --check` does.
        results: its standard output.
        messages: its standard error: notes, and where a report is.
    """

    exit_status: int
    results: str
    messages: str


@dataclass(frozen=True)
class Result:
    """What a command found, with what made it.

    Attributes:
        version: of tactus.
        command: the command line that makes the same.
        seed: that draws what is random; None if nothing is.
        configuration: all keys of the experiment, defaults included, or the options of the command.
        values: the members of the command's results; names end in their unit. `result.values.runs[0].metrics`.
        messages: notes that the command prints.
    """

    version: str
    command: str
    seed: int | None
    configuration: Record
    values: Record
    messages: str

    def to_dict(self) -> Dict[str, Any]:
        """The JSON document of the command."""
        head = {"version": self.version, "command": self.command, "seed": self.seed}
        return {**head, "configuration": self.configuration.to_dict(), **self.values.to_dict()}

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self.values, name)


def _run(words: Sequence[str], progress: Progress | None, stop: threading.Event) -> Output:
    """Runs a command in this thread; `stop` ends it at its next report of progress."""
    library = _library.library()
    raised: List[BaseException] = []

    def report(done: float, _user: Any) -> int:
        try:
            return 1 if stop.is_set() or (progress is not None and progress(done) is False) else 0
        except BaseException as error:  # nothing may pass through the library
            raised.append(error)
            return 1

    given = _library.CommandOptions()
    given.progress = _library.Progress(report)
    outcome = ctypes.c_uint64()
    try:
        _library.call(
            library.tactus_command, _library.texts(list(words)), len(words), ctypes.byref(given), ctypes.byref(outcome)
        )
    except TactusError:
        if raised:
            raise raised[0] from None
        raise
    try:
        view = _library.OutcomeView()
        _library.check(library.tactus_outcome_read(outcome, ctypes.byref(view)))
        return Output(
            exit_status=int(view.exit_status),
            results=ctypes.string_at(view.results, view.results_size).decode("utf-8", "replace"),
            messages=ctypes.string_at(view.messages, view.messages_size).decode("utf-8", "replace"),
        )
    finally:
        library.tactus_outcome_release(outcome)


def command(*words: str, progress: Progress | None = None) -> Output:
    """Runs a command as `tactus WORDS...` does, and returns what it prints.

    Args:
        words: for instance "run", "tapping.toml", "--json".
        progress: called now and then with the share of the work that is done, 0 to 1, in the thread of the command; if it
            returns False, the command ends and `Interrupted` is raised. What it raises is raised here. Commands that take
            no time do not call it.

    Other Python threads run meanwhile; commands of several threads run one after the other. Ctrl-C ends a command that
    reports progress before its next piece of work, and others when they are done.

    Raises:
        RequestError, JobError: with the command's own message.
        Interrupted: `progress` returned False.
    """
    stop = threading.Event()
    if threading.current_thread() is not threading.main_thread():
        return _run(words, progress, stop)
    # Python raises Ctrl-C in the main thread, and in a callback of the library it would be lost. So the main thread waits.
    done: List[Output] = []
    failed: List[BaseException] = []

    def work() -> None:
        try:
            done.append(_run(words, progress, stop))
        except BaseException as error:  # raised again in the thread that called
            failed.append(error)

    worker = threading.Thread(target=work, name="tactus", daemon=True)
    worker.start()
    try:
        worker.join()
    except BaseException:
        stop.set()
        worker.join()
        raise
    if failed:
        raise failed[0]
    return done[0]


def _result(words: List[str], progress: Progress | None = None) -> Result:
    output = command(*words, "--json", progress=progress)
    document = json.loads(output.results)
    head = {name: document.pop(name) for name in ("version", "command", "seed", "configuration")}
    return Result(
        version=head["version"],
        command=head["command"],
        seed=head["seed"],
        configuration=Record(head["configuration"]),
        values=Record(document),
        messages=output.messages,
    )


def _experiment_words(
    name: List[str], experiment: Path, with_: Path | Sequence[Path], set: Section | None, sections: Mapping[str, Section]
) -> List[str]:
    return (
        name + [file_word(experiment)] + repeated("with", paths(with_)) + repeated("set", set_texts(set, sections))
    )


def _output_words(out: Path | None, overwrite: bool) -> List[str]:
    return options({"out": out, "overwrite": overwrite})


def run(
    experiment: Path,
    *,
    with_: Path | Sequence[Path] = (),
    set: Section | None = None,
    vary: Mapping[str, Iterable[Any] | str] | None = None,
    out: Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
    **sections: Section,
) -> Result:
    """Runs an experiment in virtual time: `tactus run EXPERIMENT`.

        result = tactus.run("experiments/tapping.toml", control={"force_gain": 3.0}, vary={"control.cancellation": ["off", "on"]})
        result.runs[1].metrics.settled_percent

    Args:
        experiment: file in TOML.
        with_: files whose keys take the place of the experiment's, as an identified model.
        set: overrides by dotted key, {"control.force_gain": 3.0}.
        vary: values of keys, which run in all combinations, {"control.force_gain": [1, 3, 15]}.
        out: folder for the report, the figures and the log.
        overwrite: replace what an earlier run left there.
        progress: see `command`.
        sections: overrides as sections of the file, control={"force_gain": 3.0}.
    """
    words = _experiment_words(["run"], experiment, with_, set, sections)
    words += repeated("vary", vary_texts(vary)) + _output_words(out, overwrite)
    return _result(words, progress)


def advise(
    experiment: Path,
    *,
    with_: Path | Sequence[Path] = (),
    set: Section | None = None,
    out: Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
    **sections: Section,
) -> Result:
    """Method and force gain to start with, what limits it, and what to measure next: `tactus advise EXPERIMENT`."""
    words = _experiment_words(["advise"], experiment, with_, set, sections)
    return _result(words + _output_words(out, overwrite), progress)


def stability(
    what: str,
    experiment: Path,
    *,
    with_: Path | Sequence[Path] = (),
    set: Section | None = None,
    vary: Mapping[str, Iterable[Any] | str] | None = None,
    out: Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
    **options_: Any,
) -> Result:
    """How much force gain is safe: `tactus stability WHAT EXPERIMENT`.

    Args:
        what: "margins", "limit", "map", "scorecard" or "two-port".
        vary: axes of a map.
        options_: options of the command, friction_speed=0.1 for `--friction-speed 0.1`, and sections of the file, as in `run`.
    """
    sections = {name: value for name, value in options_.items() if isinstance(value, Mapping)}
    others = {name: value for name, value in options_.items() if name not in sections}
    words = _experiment_words(["stability", what], experiment, with_, set, sections)
    words += repeated("vary", vary_texts(vary)) + options(others) + _output_words(out, overwrite)
    return _result(words, progress)


def faults(
    experiment: Path | None = None,
    *,
    with_: Path | Sequence[Path] = (),
    set: Section | None = None,
    out: Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
    **sections: Section,
) -> Result:
    """The table of faults that a supervised pair must survive, in virtual time: `tactus faults [EXPERIMENT]`."""
    words = ["faults"] + ([file_word(experiment)] if experiment is not None else [])
    words += repeated("with", paths(with_)) + repeated("set", set_texts(set, sections))
    return _result(words + _output_words(out, overwrite), progress)


@contextlib.contextmanager
def _as_file(recording: Recording) -> Iterator[str]:
    """The name of a file; columns of a mapping or data frame are written into one."""
    if isinstance(recording, (str, os.PathLike)):
        yield file_word(recording)
        return
    import numpy

    names = [str(name) for name in recording.keys()]
    columns = [numpy.asarray(recording[name], dtype=numpy.float64) for name in recording.keys()]
    if not columns or any(column.shape != columns[0].shape or column.ndim != 1 for column in columns):
        shapes = ", ".join(f"{name} {column.shape}" for name, column in zip(names, columns))
        raise ValueError(f"columns of a recording have equal shapes (n,), and these have {shapes or 'none'}: cut them")
    with tempfile.TemporaryDirectory(prefix="tactus-") as folder:
        file = os.path.join(folder, "recording.csv")
        table = numpy.column_stack(columns)
        numpy.savetxt(file, table, fmt="%.17g", delimiter=",", header=",".join(names), comments="")
        yield file


def diagnose(
    recording: Recording, *, out: Path | None = None, overwrite: bool = False, **options_: Any
) -> Result:
    """Why does it shake? Oscillations in a recording and the loop that makes them: `tactus diagnose RECORDING`.

    Args:
        recording: a file, or its columns by name, {"time_s": t, "master_position_m": x, ...}, each of shape (n,), or a
            data frame. Names end in their unit.
        options_: options of the command, tip_force="f_z", tip_force_sign=-1, time_unit="ms".
    """
    with _as_file(recording) as file:
        return _result(["diagnose", file] + options(options_) + _output_words(out, overwrite))


def identify(
    what: str,
    *recordings: Recording,
    out: Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
    **options_: Any,
) -> Result:
    """A model from recordings or from a simulated bench: `tactus identify WHAT RECORDING...`.

    Args:
        what: "arm", "excitation", "frf", "inverse", "isolate", "operator", "prediction" or "quick".
        recordings: as in `diagnose`; those after `what` on the command line.
        options_: options of the command, urdf="arm.urdf", time="time", position="2:4", effort="8:10".
    """
    files = contextlib.ExitStack()
    try:
        names = [files.enter_context(_as_file(recording)) for recording in recordings]
        return _result(["identify", what] + names + options(options_) + _output_words(out, overwrite), progress)
    finally:
        files.close()


def estimate(
    what: str, recording: Recording, *, out: Path | None = None, overwrite: bool = False, **options_: Any
) -> Result:
    """What no sensor measures: `tactus estimate WHAT RECORDING`.

    Args:
        what: "force" of one axis, or "torque" at the joints of an arm.
        recording: as in `diagnose`.
        options_: options of the command, model="model.toml", compare="force_N". With `out` the folder has the signal as
            a table, which `read_log` reads.
    """
    with _as_file(recording) as file:
        return _result(["estimate", what, file] + options(options_) + _output_words(out, overwrite))


def schema(kind: str = "tapping") -> Dict[str, Any]:
    """JSON Schema of the files of a kind of experiment: `tactus schema KIND`."""
    document: Dict[str, Any] = json.loads(command("schema", kind).results)
    return document


def results_schema(*words: str) -> Dict[str, Any]:
    """JSON Schema of a command's results: `results_schema("stability", "margins")`."""
    document: Dict[str, Any] = json.loads(command("schema", "--results", *words).results)
    return document


def reference(kind: str = "tapping") -> str:
    """The keys of a kind of experiment in Markdown: `tactus schema KIND --reference`."""
    return command("schema", kind, "--reference").results
