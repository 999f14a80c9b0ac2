# SPDX-License-Identifier: Apache-2.0
"""Keyword arguments as the words of a command line."""

from __future__ import annotations

import os
from typing import Any, Dict, Iterable, Iterator, List, Mapping, Sequence, Tuple, Union

Path = Union[str, "os.PathLike[str]"]
Scalar = Union[bool, int, float, str]
Section = Mapping[str, Any]


def written(value: Any) -> str:
    """A value as it is written in a file: true, 0.02, total-velocity."""
    if isinstance(value, (bool,)) or type(value).__name__ == "bool_":
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    if isinstance(value, os.PathLike):
        return str(os.fspath(value))
    if hasattr(value, "item") and not hasattr(value, "__len__"):
        value = value.item()  # a number of NumPy
    if isinstance(value, (int, float)):
        return repr(value)
    raise TypeError(f"{value!r} is no value of a key: write a number, a text, True or False")


def assignments(values: Mapping[str, Any], under: str = "") -> Iterator[Tuple[str, Any]]:
    """The keys of nested sections, dotted: {"control": {"force_gain": 3}} is control.force_gain, 3."""
    for key, value in values.items():
        path = f"{under}.{key}" if under else key
        if isinstance(value, Mapping):
            yield from assignments(value, path)
        else:
            yield path, value


def set_texts(set: Mapping[str, Any] | None, sections: Mapping[str, Any]) -> List[str]:
    """Each override as `key=value`, those of `set` last."""
    both: List[Tuple[str, Any]] = []
    for name, section in sections.items():
        if not isinstance(section, Mapping):
            raise TypeError(
                f"{name}={section!r} is no section of a file: write for instance {name}={{'key': value}}, "
                "or set={'section.key': value}"
            )
        both.extend(assignments({name: section}))
    both.extend(assignments(set or {}))
    return [f"{key}={written(value)}" for key, value in both]


def vary_texts(vary: Mapping[str, Iterable[Any] | str] | None) -> List[str]:
    """Each variation as `key=a,b,c`."""
    texts = []
    for key, values in (vary or {}).items():
        listed = values if isinstance(values, str) else ",".join(written(value) for value in values)
        texts.append(f"{key}={listed}")
    return texts


def option(name: str, value: Any) -> List[str]:
    """One option: nothing for None and False, a flag for True, once for each value of a list."""
    dashed = "--" + name.rstrip("_").replace("_", "-")
    if value is None or value is False:
        return []
    if value is True:
        return [dashed]
    if isinstance(value, (list, tuple)):
        return [word for one in value for word in option(name, one)]
    text = written(value)
    return [f"{dashed}={text}"] if text.startswith("-") else [dashed, text]


def options(values: Mapping[str, Any]) -> List[str]:
    return [word for name, value in values.items() for word in option(name, value)]


def file_word(file: Path) -> str:
    """A file as a word that no command takes for an option."""
    name = os.fspath(file)
    return "./" + name if name.startswith("-") else name


def paths(files: Path | Sequence[Path]) -> List[str]:
    several = [files] if isinstance(files, (str, os.PathLike)) else list(files)
    return [file_word(file) for file in several]


def repeated(name: str, values: Iterable[str]) -> List[str]:
    return [word for value in values for word in option(name, value)]


Options = Dict[str, Any]
