"""The same question for several values of one parameter: one table, and a curve for each value in every panel."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..output.panels import merged
from ..output.record import Record
from ..output.symbols import assigned, title_of
from ..output.text import Row
from ..status import INTERRUPTED


@dataclass(frozen=True, repr=False)
class Family(Record):
    """Results of one kind, `members`, for the flows of a sweep over the parameter `each` of `flow`.

    Values in `missing` were not reached. Columns are those of the members, one below the other, after one of `each`.
    """

    flow: Any
    each: str
    members: tuple[Any, ...]
    missing: tuple[float, ...] = ()

    @property
    def values(self) -> list[float]:
        """The value of the parameter in each member."""
        return [getattr(member.flow, self.each) for member in self.members]

    @property
    def method(self) -> str:  # type: ignore[override]
        return str(self.members[0].method)

    @property
    def dimension(self) -> str:
        return "row"

    @property
    def swept(self) -> tuple[str | None, ...]:
        return (self.each, *self.members[0].swept)

    @property
    def bounded(self) -> str:
        return str(self.members[0].bounded)

    @property
    def settings(self) -> Mapping[str, Any]:  # type: ignore[override]
        return _common([member.settings for member in self.members])

    @property
    def title(self) -> str:
        return title_of(self.flow, self.swept) + self.members[0].subtitle

    def rows(self) -> list[Row]:
        rows = [{self.each: value, **row} for value, member in zip(self.values, self.members, strict=True)
                for row in member.rows()]
        return rows + [dict.fromkeys(rows[0]) | {self.each: value, "status": INTERRUPTED} for value in self.missing]

    def columns(self) -> dict[str, np.ndarray]:
        """Return the columns of the members, one below the other; lists padded with nan to the longest."""
        parts = [member.columns() for member in self.members]
        counts = [len(member.rows()) for member in self.members]
        names = list(dict.fromkeys(name for part in parts for name in part))
        columns = {self.each: np.repeat(self.values, counts)}
        for name in names:
            columns[name] = _stacked([part.get(name) for part in parts], counts)
        return {name: _extended(name, values, self.missing if name == self.each else len(self.missing))
                for name, values in columns.items()}

    def notes(self) -> list[str]:
        return list(dict.fromkeys(note for member in self.members for note in member.notes()))

    def about(self) -> dict[str, Any]:
        return {**_common([member.about() for member in self.members]), "each": self.each}

    def panels(self) -> tuple[Any, ...]:
        """The panels of the members, with a labelled curve for each value."""
        labels = [assigned(self.flow, self.each, value) for value in self.values]
        return merged([member.panels() for member in self.members], labels)


def _common(parts: list[Any]) -> dict[str, Any]:
    """What all dicts say; where they differ, all of it."""
    found = {name: list(dict.fromkeys(part[name] for part in parts if name in part))
             for name in dict.fromkeys(name for part in parts for name in part)}
    return {name: values[0] if len(values) == 1 else ", ".join(map(str, values)) for name, values in found.items()}


def _stacked(parts: list[np.ndarray], counts: list[int]) -> np.ndarray:
    """Arrays (rows, ...) one below the other; nan where a member has none, or shorter lists."""
    kinds = [part for part in parts if part is not None]
    width = max(part.shape[1] if part.ndim > 1 else 0 for part in kinds)
    if any(part.dtype.kind == "U" for part in kinds):
        return np.concatenate([np.full(count, "") if part is None else part.astype(str)
                               for part, count in zip(parts, counts, strict=True)])
    blank = complex(np.nan, np.nan) if any(part.dtype.kind == "c" for part in kinds) else np.nan
    whole = all(part is not None and part.dtype.kind == "i" for part in parts)
    stacked = np.full((sum(counts), width) if width else sum(counts), 0 if whole else blank)
    row = 0
    for part, count in zip(parts, counts, strict=True):
        if part is not None:
            stacked[(slice(row, row + count), slice(part.shape[1])) if width else slice(row, row + count)] = part
        row += count
    return stacked


def _extended(name: str, values: np.ndarray, missing: Any) -> np.ndarray:
    """A column with the rows of the values that were not reached."""
    count = missing if isinstance(missing, int) else len(missing)
    if not count:
        return values
    if not isinstance(missing, int):
        return np.concatenate((values, missing))
    if values.dtype.kind == "U":
        return np.concatenate((values, np.full(count, INTERRUPTED if name == "status" else "")))
    return np.concatenate((values.astype(complex if values.dtype.kind == "c" else float),
                           np.full((count, *values.shape[1:]), np.nan)))
