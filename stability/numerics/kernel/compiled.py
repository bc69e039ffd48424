"""The arithmetic of a pencil by compiled code: the same iterations and products as with numpy, point by point.

Where the matrix of a point is uneven or singular nothing is done in C: one point is given to numpy then, many are
left as they are, not settled.
"""

import ctypes
from typing import Any

import numpy as np

from ..arithmetic import Arithmetic, Iterated
from ..bordered import UNEVEN
from .library import LinesInC

_START = ctypes.c_char


class Packed:
    """A stack of sparse matrices as kernel.c wants it; parts from `first_part` on are those of -B."""

    def __init__(self, stack: Any, places: Any, parts: int, first_part: int) -> None:
        lines, data = stack.lines, stack.data
        self.values = {"re": np.ascontiguousarray(data.real), "im": np.ascontiguousarray(data.imag)}
        self._places = lines  # kept, since its addresses are
        self.lines = LinesInC(places.interior, places.border, places.lower, places.upper, parts, first_part,
                              len(lines.part), int(np.searchsorted(lines.part, first_part)), *lines.addresses,
                              *(part.ctypes.data for part in self.values.values()))


class Compiled(Arithmetic):
    """The numbers of one `pencil` by the functions of a `library`."""

    def __init__(self, pencil: Any, library: Any) -> None:
        super().__init__(pencil)
        self._library = library

    def iterate(self, weights: np.ndarray, rate: Any, x: np.ndarray, y: np.ndarray, accuracy: float) -> "Iterated":
        kind, many = self._kind(weights, rate, x, y), x.ndim > 1
        vectors = np.empty((4, *x.shape[::-1]), kind)  # x, y and their steps
        vectors[0], vectors[1] = x.T, y.T
        sizes, flags = np.empty((*x.shape[1:], 2, 3)), np.empty(x.shape[1:], np.intc)
        self._call("iterate", kind, self._pencil.packed, x[0].size, UNEVEN, accuracy,
                   np.array(weights.T, kind, order="C"), np.array(rate, kind), vectors, sizes, flags)
        if not many and flags:
            return super().iterate(weights, rate, x, y, accuracy)
        x, y, dx, dy = vectors.transpose(0, 2, 1) if many else vectors
        return Iterated((x, y), (dx, dy), sizes.T, flags == 1 if many else False)

    def brackets(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return self._brackets(x, y)[0][0]

    def changes(self, x: np.ndarray, y: np.ndarray, dx: np.ndarray, dy: np.ndarray) -> tuple[np.ndarray, ...]:
        return self._brackets(x, y, dx, dy)

    def _brackets(self, *vectors: np.ndarray) -> tuple[np.ndarray, ...]:
        """Brackets (1 or 3, parts, ...) and squares (parts, ...)."""
        kind, shape, parts = self._kind(*vectors), vectors[0].shape[1:], len(self._pencil.parts)
        given = [np.ascontiguousarray(one.T, kind) for one in vectors] + [None] * (4 - len(vectors))
        brackets, squares = np.empty((*shape, len(vectors) - 1 | 1, parts), kind), np.empty((*shape, parts))
        self._call("brackets", kind, self._pencil.packed, vectors[0][0].size, *given, brackets, squares)
        return brackets.transpose(1, 2, 0) if shape else brackets, squares.T

    def beyond(self, weights: np.ndarray, x: np.ndarray) -> np.ndarray:
        kind, rows = self._kind(weights, x), self._pencil.tail.lines.rows
        beyond = np.empty((*x.shape[1:], rows), kind)
        self._call("beyond", kind, self._pencil.packed_tail, x[0].size, rows, np.ascontiguousarray(weights.T, kind),
                   np.ascontiguousarray(x.T, kind), beyond)
        return beyond.T

    def _kind(self, *values: Any) -> type:
        return float if self._pencil.real and not any(map(np.iscomplexobj, values)) else complex

    def _call(self, name: str, kind: type, packed: "Packed", *arguments: Any) -> None:
        function = getattr(self._library, f"{name}_{'complex' if kind is complex else 'real'}")
        if function(packed.lines, *[_place(one) if isinstance(one, np.ndarray) else one for one in arguments]) == 0:
            raise MemoryError


def _place(array: Any) -> Any:
    """A pointer to the numbers of an array of ours, which lie one behind the other (or this fails)."""
    return ctypes.byref(_START.from_buffer(array))
