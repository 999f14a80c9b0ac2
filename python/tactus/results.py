# SPDX-License-Identifier: Apache-2.0
"""Results as records: members as attributes, lists of numbers as arrays."""

from __future__ import annotations

from typing import Any, Dict, Iterator, List, Mapping

__all__ = ["Record"]


class Record(Mapping[str, Any]):
    """An object of a JSON document. `record.force_gain` and `record["force_gain"]` are the same.

    An object in it is a `Record`. A list of numbers is an array of shape (n,), a list of such lists of equal length an
    array of shape (m, n); any other list is a list. `to_dict` has everything as it was written.
    """

    __slots__ = ("_members",)

    def __init__(self, members: Dict[str, Any]) -> None:
        self._members = members

    def __getitem__(self, name: str) -> Any:
        return _shown(self._members[name])

    def __getattr__(self, name: str) -> Any:
        if name in Record.__slots__ or name not in self._members:
            raise AttributeError(f"the results have no member {name!r}")
        return self[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._members)

    def __len__(self) -> int:
        return len(self._members)

    def __dir__(self) -> List[str]:
        return [*super().__dir__(), *self._members]

    def __repr__(self) -> str:
        return f"Record({self._members!r})"

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Record):
            return self._members == other._members
        return self._members == other

    def to_dict(self) -> Dict[str, Any]:
        """The object as JSON has it: dictionaries, lists, numbers, texts, None."""
        return self._members

    def frame(self, member: str) -> Any:
        """A list of objects as a data frame of pandas, one row each; members of members are dotted columns."""
        import pandas

        return pandas.json_normalize(self._members[member])


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def _shown(value: Any) -> Any:
    if isinstance(value, dict):
        return Record(value)
    if not isinstance(value, list):
        return value
    if value and all(_is_number(one) for one in value):
        import numpy

        return numpy.asarray(value, dtype=numpy.float64)
    is_matrix = (
        bool(value)
        and all(isinstance(row, list) and len(row) == len(value[0]) and len(row) > 0 for row in value)
        and all(_is_number(one) for row in value for one in row)
    )
    if is_matrix:
        import numpy

        return numpy.asarray(value, dtype=numpy.float64)
    return [_shown(one) for one in value]
