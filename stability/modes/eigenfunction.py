"""The eigenfunction of a mode in physical units, at any height of its flow.

The series of a mode hold scaled unknowns (see `equations.layer`). Scaled back, they are perturbations of velocity
and stress proportional to exp(i k x + sigma t), for a unit amplitude of the first surface.
"""

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np

from ..checks import as_number, shown
from ..equations.layer import FIELDS, resolved
from ..errors import ParameterError
from ..numerics import chebyshev
from .accuracy import DEGREES
from .mode import Mode
from .solver import Solver

_POINTS = 1537  # of a layer, among which |u| is largest
_BISECTIONS = 60
_ROUNDING = 1e-12  # of the thickness of the flow: heights this little outside lie on the edge
_AT_REST = 1e-10  # amplitude / max |u| below which a surface does not take part in a mode


@dataclass(frozen=True, eq=False)
class Fields:
    """A mode at heights z: perturbations of velocity u (along the wave), w (normal to the flow), shear stress t,
    normal stress n and pressure p, complex arrays of the shape of z, and the amplitudes of the `surfaces`.

    The amplitude of the first surface is 1; where there is none or it stays at rest, u = 1 where |u| is largest. An
    interface between two layers counts to the lower one. Lengths, velocities and stresses are in the scales
    of the flow; in a steady layer (the fluid over a dune) in its own, those of its profile. Stresses are positive as
    tension is: n = -p + 2 eta dw/dz with the effective viscosity eta. t acts along the wave on a face of normal z
    and is positive as the shear stress of a base flow with U' > 0.
    """

    z: np.ndarray
    u: np.ndarray
    w: np.ndarray
    t: np.ndarray
    n: np.ndarray
    p: np.ndarray
    surfaces: dict[str, complex]


def sharpened(solver: Solver, mode: Mode) -> Mode:
    """The mode with vectors as accurate as its eigenvalue: refined once more, at the next degree.

    The error of an eigenvalue is the product of those of its vectors, which may therefore lack half its digits.
    """
    degree = next((degree for degree in DEGREES if degree > mode.degree), mode.degree)
    return solver.solve(mode.k, mode.rate, (mode.degree, mode.x, mode.y), degree)


class Eigenfunction:
    """A mode as functions of height: `edges` (layers+1,) bound its layers, `low` .. `high` what it covers."""

    def __init__(self, mode: Mode) -> None:
        flow, solver = mode.flow, Solver(mode.flow)
        mode = sharpened(solver, mode)
        pencil = solver.pencil(mode.degree)
        self.k, self.degree, self.order = mode.k, mode.degree, flow.order
        self.layers = flow.layers(SimpleNamespace(**{name: value[0] for name, value in solver.symbols(mode.k).items()}))
        self._base = [resolved(flow, self.layers, index, _velocities) for index in range(len(self.layers))]
        thickness = [float(layer.height(np.array(1.0))) for layer in self.layers]
        self.edges = flow.lowest + np.concatenate(([0.0], np.cumsum(thickness)))
        self.low, self.high = self.edges[0], self.edges[-1]
        self._slack = _ROUNDING * (self.high - self.low)
        self._series = [np.array([pencil.field(mode.x, f"{layer.name}.{field}") for field in FIELDS]).T
                        for layer in self.layers]
        amplitudes = {name: complex(mode.x[pencil.columns[name]][0]) for name in flow.surfaces}
        self._scale = 1 / self._reference(next(iter(amplitudes.values()), 0.0))
        self.surfaces = {name: value * self._scale for name, value in amplitudes.items()}

    def _reference(self, amplitude: complex) -> complex:
        """The amplitude, or the u of largest modulus where the amplitude is 0."""
        self._scale = 1.0
        s = np.linspace(0, 1, _POINTS)
        u = np.concatenate([self._at(index, s)[0] for index in range(len(self.layers))])
        largest = complex(u[np.argmax(np.abs(u))])
        return amplitude if abs(amplitude) > _AT_REST * abs(largest) else largest

    def at(self, z: Any) -> Fields:
        """Return the `Fields` at heights z, a number or an array; raises ParameterError outside the layers."""
        heights, parts = self.placed(z)
        values = np.zeros((5, heights.size), complex)
        for index, here, s in parts:
            values[:, here] = self._at(index, s)
        u, w, t, n, p = values.reshape(5, *heights.shape)
        return Fields(heights, u, w, t, n, p, self.surfaces)

    def placed(self, z: Any) -> tuple[np.ndarray, list[tuple[int, np.ndarray, np.ndarray]]]:
        """Heights as an array; for each layer its number, which heights lie in it and where, 0 <= s <= 1, both flat.
        Raises ParameterError outside the layers."""
        heights = _heights(z)
        flat = heights.ravel()
        outside = flat[~((flat >= self.low - self._slack) & (flat <= self.high + self._slack))]
        if len(outside):
            low, high = (round(edge / self._slack) * self._slack for edge in (self.low, self.high))
            raise ParameterError(f"z must lie in the layers of the flow, [{low:g}, {high:g}] (got {outside[0]:g})")
        layer_of = np.searchsorted(self.edges[1:-1], flat - self._slack)
        masks = [layer_of == index for index in range(len(self.layers))]
        return heights, [(index, here, self._s(index, flat[here])) for index, here in enumerate(masks)]

    def profiles(self, count: int = 401) -> list[Fields]:
        """The fields on each layer from edge to edge, at `count` heights."""
        lower = np.array([self.low, *(self.edges[1:-1] + 2 * self._slack)])
        return [self.at(np.linspace(*ends, count)) for ends in zip(lower, self.edges[1:], strict=True)]

    def _s(self, index: int, z: np.ndarray) -> np.ndarray:
        """The points 0 <= s <= 1 of a layer at heights z, by bisection."""
        layer, bottom, top = self.layers[index], self.edges[index], self.edges[index + 1]
        low, high = np.zeros_like(z), np.ones_like(z)
        for _ in range(_BISECTIONS):
            middle = (low + high) / 2
            below = bottom + layer.height(middle) < z
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.where(z <= bottom, 0.0, np.where(z >= top, 1.0, low))

    def _at(self, index: int, s: np.ndarray) -> np.ndarray:
        """u, w, t, n, p (5, points) at the points s of a layer."""
        v, w, t, n = (chebyshev.at(s, self.degree) @ self._series[index]).T
        g, viscosity, stress = self._base[index].at(s)
        along = 1j * self.k**self.order
        viscous = viscosity * (along * v)  # eta u: finite where eta is not
        stresses = stress * np.array((along * t, n, -n - 2j * self.k * viscous))
        velocities = g * (along * v), self.k ** (1 + self.order) * w
        return self._scale * np.array((*velocities, *stresses), dtype=complex)


def _heights(z: Any) -> np.ndarray:
    """Heights as a float array of the shape of z."""
    array = z if isinstance(z, np.ndarray) else np.asarray(z, dtype=object)
    values = array.ravel().tolist()
    numbers = [as_number(value) for value in values]
    if None in numbers:
        raise ParameterError(f"z must be a number or an array of numbers (got {shown(values[numbers.index(None)])})")
    return np.array(numbers, dtype=float).reshape(array.shape)


def _velocities(base: Any, s: Any) -> Any:
    """What turns scaled unknowns into velocities and viscous stresses."""
    return base.g, base.eta * base.g, base.stress
