# SPDX-License-Identifier: Apache-2.0
"""What tactus raises. The text of an exception is what the `tactus` command prints."""

from __future__ import annotations

__all__ = ["TactusError", "RequestError", "JobError", "Interrupted", "ReleasedError"]


class TactusError(Exception):
    """An error that tactus reports: `place: parameter: message`.

    Attributes:
        kind: what went wrong, for instance "out-of-bounds".
        place: where the value was written, "model.toml:3:11" or "--set control.force_gain=-1"; or empty.
        parameter: the key, "control.force_gain"; or empty.
        message: one sentence, without the place.
        value: the value that was refused, with its unit; or empty.
        bounds: what the value may be; or empty.
        remedy: what to do about it; or empty.
        exit_status: of the command: 1 the job failed, 2 the request was wrong.
    """

    def __init__(
        self,
        line: str,
        *,
        kind: str = "failed",
        place: str = "",
        parameter: str = "",
        message: str = "",
        value: str = "",
        bounds: str = "",
        remedy: str = "",
        exit_status: int = 1,
    ) -> None:
        super().__init__(line)
        self.kind = kind
        self.place = place
        self.parameter = parameter
        self.message = message or line
        self.value = value
        self.bounds = bounds
        self.remedy = remedy
        self.exit_status = exit_status


class RequestError(TactusError, ValueError):
    """The request was wrong: a file, a key, a value or an option. Nothing was computed."""


class JobError(TactusError, RuntimeError):
    """The request was understood and the job failed, or its results could not be written."""


class Interrupted(TactusError):
    """The progress callback returned False. There are no results."""


class ReleasedError(TactusError):
    """An object was used after it was closed."""


_KINDS = [
    "ok", "out-of-bounds", "wrong-type", "unknown-key", "missing", "syntax", "inconsistent", "unwritable", "failed",
    "interrupted", "released", "bad-argument",
]
_LINES = {
    1: "a position or a force is not a finite number: correct it; no cycle was computed",
    10: "the object was closed and cannot be used any more: make another",
    11: "an argument is missing: pass all that the function needs",
}


def exception_of(status: int) -> tuple[type[TactusError], str, str]:
    """What is raised for a status of the C library, its kind, and what it says if the library reports no more."""
    kind = _KINDS[status] if 0 <= status < len(_KINDS) else "failed"
    chosen: type[TactusError] = RequestError
    if kind in ("failed", "unwritable"):
        chosen = JobError
    elif kind == "interrupted":
        chosen = Interrupted
    elif kind == "released":
        chosen = ReleasedError
    return chosen, kind, _LINES.get(status, "the library reported no reason: free some memory and try again")
