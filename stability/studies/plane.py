"""One mode over the plane of wavenumber k and one parameter of a flow.

Moving from point to point keeps to the mode: the rate is predicted from its gradient, and old and new eigenvectors must
be biorthogonal partners, as in `modes.tracking`.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isinf
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import ModeLost, ParameterError
from ..modes.solver import Solver
from ..numerics.walker import Pace, Walker
from .sensitivity import Derivative

if TYPE_CHECKING:
    from ..flows.base import Flow
    from ..modes.accuracy import Accuracy

_OVERLAP = 0.5  # largest deviation of the overlap of one step from 1
_HALVINGS = 12
_KEPT = 8  # solvers of neighbouring values


@dataclass(frozen=True)
class Point:
    """A mode at wavenumber k and parameter `value`, in its `plane`."""

    plane: Any
    k: float
    value: float
    mode: Any

    @property
    def growth(self) -> float:
        return self.mode.growth_rate

    @cached_property
    def by_value(self) -> complex:
        """d sigma / d value."""
        return complex(self.plane.derivative(self.value)(self.mode))

    @property
    def trend(self) -> float:
        """Derivative of the growth rate in the logarithm of the value."""
        return self.value * self.by_value.real

    @property
    def by_k(self) -> float:
        """Slope of the growth rate in log k."""
        return self.k * self.mode.slope.real

    @property
    def gradient(self) -> np.ndarray:
        """Of the growth rate in (log k, value)."""
        return np.array([self.by_k, self.by_value.real])


class Plane:
    """Modes of one symmetry class of `flow` at any wavenumber and any value of its parameter `vary`.

    `half` tells which of `flow.halves()` is meant; error bars are computed with `bars`.
    """

    def __init__(self, flow: "Flow", vary: str, accuracy: "Accuracy", half: int = 0, bars: bool = True) -> None:
        if isinf(getattr(flow, vary)):
            raise ParameterError(f"{flow.name}: {vary} = inf cannot be varied; start from a finite {vary}")
        self.flow, self.vary, self.half = flow, vary, half
        self.accuracy, self._bars = accuracy, bars
        self.power = 2 if flow.has_surface_mode() else 0  # growth of long waves is of the order of k^power
        self._solvers, self._derivatives = {}, {}

    def rough(self, tolerance: float) -> "Plane":
        """The same plane, no more accurate than this."""
        return Plane(self.flow, self.vary, self.accuracy.rougher(tolerance), self.half, bars=False)

    def flow_at(self, value: float) -> "Flow":
        """The whole flow at a value; raises ParameterError where there is none."""
        return replace(self.flow, **{self.vary: value})

    def solver(self, value: float) -> Solver:
        """The solver at this value; the last few are kept."""
        if value not in self._solvers:
            flow = self.flow_at(value).halves()[self.half]
            last = next(reversed(self._solvers.values()), None)
            assembly = last.assembly.serving(flow) if last else None
            if len(self._solvers) == _KEPT:
                self._solvers.pop(next(iter(self._solvers)))
            self._solvers[value] = Solver(flow, self.accuracy, assembly, self._bars)
        return self._solvers[value]

    def derivative(self, value: float) -> Derivative:
        """The `Derivative` with respect to the parameter at this value; the last few are kept."""
        if value not in self._derivatives:
            if len(self._derivatives) == _KEPT:
                self._derivatives.pop(next(iter(self._derivatives)))
            self._derivatives[value] = Derivative(self.solver(value), self.vary)
        return self._derivatives[value]

    def point(self, k: Any, value: Any, mode: Any) -> Any:
        return Point(self, k, value, mode)

    def adopt(self, point: "Point") -> "Point":
        """The point of another plane of this flow, with the accuracy of this one."""
        mode = point.mode
        solver = self.solver(point.value)
        return self.point(point.k, point.value, solver.solve(point.k, mode.rate, (mode.degree, mode.x, mode.y)))

    def move(self, start: Any, k: Any, value: Any, halvings: Any = _HALVINGS) -> Any:
        """The mode of `start` at another point; in several steps, halved so often, where one would not be safe."""
        walk = _Move(self, start, k, value, 0.5**halvings)
        for _ in range(4 * halvings):
            ahead = min(1.0, walk.reached + walk.step)
            if walk.stride(ahead, ahead - walk.reached) and ahead == 1:
                return walk.now
            if walk.stuck:
                break
        raise ModeLost(f"{start.mode.flow}: the mode is lost between k = {start.k:.6g} and {k:.6g}, "
                       f"{self.vary} = {start.value:.6g} and {value:.6g}")


class _Move(Walker):
    """The way from a point of a plane to another one, 0 to 1 of it."""

    checks = ("overlaps",)

    def __init__(self, plane: "Plane", start: "Point", k: float, value: float, smallest: float) -> None:
        super().__init__(Pace(1.0, inf, smallest, 2.0))
        self.plane, self.start, self.end = plane, start, (k, value)
        self.now, self.reached = start, 0.0

    def foresee(self, to: float) -> tuple[float, float, complex]:
        """k, value and sigma at a part of the way."""
        start, (k, value), now = self.start, self.end, self.now
        if to < 1:
            k, value = start.k * (k / start.k) ** to, start.value + (value - start.value) * to
        change = now.mode.slope * (k - now.k)
        if value != now.value:
            change += now.by_value * (value - now.value)
        return k, value, now.mode.sigma + change

    def correct(self, to: float, guess: tuple[float, float, complex]) -> "Point":
        k, value, sigma = guess
        solver, old = self.plane.solver(value), self.now.mode
        degree = old.degree if old.degree in solver.degrees else solver.degrees[-1]
        mode = solver.solve(k, sigma / solver.width(k), (old.degree, old.x, old.y), degree)
        return self.plane.point(k, value, mode)

    def overlaps(self, new: "Point", guess: tuple[float, float, complex]) -> bool:
        """Whether old and new eigenvectors are biorthogonal partners."""
        return abs(self.plane.solver(new.value).overlap(self.now.mode, new.mode) - 1) < _OVERLAP

    def accept(self, to: float, new: "Point") -> None:
        self.now, self.reached = new, to
