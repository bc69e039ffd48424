"""What a map is asked for: a quantity over a grid of one to three parameters, and the pieces it falls into.

A piece is a fixed part of the grid, a stretch of its innermost parameter, so that results depend neither on the
number of workers nor on the order in which they finish, nor on interruptions.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from itertools import product
from math import prod
from typing import Any

import numpy as np

from ..checks import check_options, check_wavenumbers, flat, shown
from ..errors import ParameterError
from ..flows.base import check_flow, check_parameter_name
from ..flows.rules import check_parameter
from ..flows.sources import origin
from ..modes.accuracy import Accuracy
from ..output.text import measured
from .choices import QUANTITIES, check_quantity

_COLUMNS = {
    "k_max": ("k_max", "growth_rate", "phase_speed", "error", "growth_error", "maxima", "second_k_max",
              "second_growth_rate", "status"),
    "growth_rate": ("growth_rate", "phase_speed", "error", "degree", "status"),
    "neutral": ("k", "phase_speed", "error", "k_error", "status"),  # headed by the parameter that is solved for
}
_PIECE = {"k_max": 4, "growth_rate": 1, "neutral": 16}  # flows of a piece, neighbours along the innermost parameter
_MOST_POINTS = 1_000_000


@dataclass(frozen=True)
class Request:
    """What a map is asked for: `over` {parameter: values}, the first outermost; k belongs to "growth_rate", `vary` to
    "neutral". Raises ParameterError where that makes no map."""

    flow: Any
    over: Any = field(hash=False)
    quantity: str
    k: Any = None
    vary: str | None = None
    accuracy: Accuracy = Accuracy()

    def __post_init__(self) -> None:
        check_flow(self.flow)
        check_options("quantity", self.quantity, QUANTITIES)
        if not isinstance(self.over, Mapping):
            raise ParameterError(f"over must be a dict {{parameter: values}} (got {shown(self.over)})")
        if self.vary is not None:
            check_parameter_name(self.flow, self.vary)
        self._set(quantity=check_quantity(self.quantity, self.over, self.k, self.vary))
        self._set(over={name: self._values(name, values) for name, values in self.over.items()})
        if self.k is not None:
            self._set(k=tuple(check_wavenumbers(self.k).tolist()))
        if not 1 <= self.size <= _MOST_POINTS:
            raise ParameterError(f"over: a map has 1 to {_MOST_POINTS} points (got {self.size}): coarsen or split it")

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def _values(self, name: str, values: list[float]) -> tuple[Any, ...]:
        check_parameter_name(self.flow, name)
        (item,) = (item for item in fields(self.flow) if item.name == name)
        return tuple(check_parameter(self.flow.name, item, value) for value in flat(values, f"over: {name}"))

    @property
    def axes(self) -> dict[str, np.ndarray]:
        """{name: values (count,)}, outermost first; k is the innermost."""
        axes = self.over if self.k is None else {**self.over, "k": self.k}
        return {name: np.array(values) for name, values in axes.items()}

    @property
    def shape(self) -> tuple[int, ...]:
        return tuple(len(values) for values in self.axes.values())

    @property
    def size(self) -> int:
        """How many points there are."""
        return prod(self.shape)

    @property
    def results(self) -> tuple[Any, ...]:
        """Names of the results at each point; the last is the status."""
        names = list(_COLUMNS[self.quantity])
        place = names.index("error") + 1
        names[place:place] = measured(self.flow, *(("growth_data_error",) if self.quantity == "k_max" else ()))
        return (() if self.vary is None else (self.vary,)) + tuple(names)

    def pieces(self) -> tuple[Any, ...]:
        """The pieces of the grid, in its order."""
        *outer, (name, inner) = self.over.items()
        lines = product(*(values for _, values in outer))
        stretches = [inner[first: first + _PIECE[self.quantity]]
                     for first in range(0, len(inner), _PIECE[self.quantity])]
        names = (*(outer_name for outer_name, _ in outer), name)
        return tuple(GridPiece(index, self.quantity, tuple(self._at(names, (*line, value)) for value in stretch),
                               self.k, self.vary, self.accuracy, len(self.results))
                     for index, (line, stretch) in enumerate(product(lines, stretches)))

    def _at(self, names: Any, values: Any) -> Any:
        """The flow at a point, or the reason (a string) why there is none."""
        try:
            return replace(self.flow, **dict(zip(names, values, strict=True)))
        except ParameterError as reason:
            return str(reason)

    def description(self) -> dict[str, Any]:
        """All that the results depend on, as plain values."""
        from .. import __version__

        fixed = {name: value for name, value in self.flow.stated().items() if name not in self.over}
        return {"version": __version__, "flow": self.flow.name, **origin(type(self.flow)), "parameters": fixed,
                "over": [[name, list(values)] for name, values in self.over.items()], "quantity": self.quantity,
                "k": self.k and list(self.k), "vary": self.vary,
                **self.accuracy.settings}


@dataclass(frozen=True)
class GridPiece:
    """Neighbouring points that are computed together: a flow, or why there is none (a string), at each."""

    index: int
    quantity: str
    flows: tuple
    k: tuple | None
    vary: str | None
    accuracy: Accuracy
    width: int  # results of a point

    @property
    def points(self) -> int:
        return len(self.flows) * len(self.k or (None,))
