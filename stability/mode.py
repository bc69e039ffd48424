"""One mode: a two-sided inverse iteration with Rayleigh quotient, its error bar and its slope in k.

One LU factorisation of A - rate B near the eigenvalue serves both eigenvectors x and y. The two-sided
Rayleigh quotient is then wrong only by the product of their errors, and the pair (y, x) yields

    d sigma / d anything = - y^H (d residual matrix) x / (y^H B x),

hence the slope in k, the truncation error (y against the residual beyond the truncation) and the
rounding error (y against a random rounding of every matrix entry).
"""

from dataclasses import dataclass, field
from math import sqrt
from typing import Any

import numpy as np

from .bordered import Factors
from .errors import ModeLost, NotResolved, ParameterError
from .pencil import Pencil
from .system import System

DEGREES = (8, 10, 12, 14, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 128, 160, 192, 256, 320,
           384, 512)
TOLERANCE = 1e-10  # default bound on error / |sigma| for a resolved mode

_EPS = np.finfo(float).eps
_ROUNDING = 3.0  # standard deviations of the accumulated rounding that the error bar spans
_FACTORISATIONS = 12
_TINY = np.finfo(float).tiny


@dataclass(frozen=True)
class Mode:
    """An eigenvalue with error bar and eigenvectors.

    `sigma` complex growth rate, `error` bound of its absolute error, `slope` d sigma/dk, `truncation` and
    `rounding` the parts of the error, `degree` of the series, `status` "resolved" or what failed. `x`, `y`
    (size,) hold the right and left eigenvector in the pencil of that degree, with y^H B x = 1; `bx` and
    `by` are B x and y^H B.
    """

    flow: Any
    k: float
    sigma: complex
    error: float
    slope: complex
    degree: int
    status: str
    truncation: float
    rounding: float
    rate: complex = field(repr=False)
    rate_slope: complex = field(repr=False)
    x: np.ndarray = field(repr=False)
    y: np.ndarray = field(repr=False)
    bx: np.ndarray = field(repr=False)
    by: np.ndarray = field(repr=False)

    @property
    def growth_rate(self):
        return self.sigma.real

    @property
    def c(self):
        """Complex wave speed i sigma / k."""
        return 1j * self.sigma / self.k

    @property
    def phase_speed(self):
        return self.c.real + 0.0  # no negative zero


class Assembly:
    """The pencils of a system of equations, each degree assembled when first asked for."""

    def __init__(self, flow):
        self.system = System(flow)
        self._pencils = {}

    def pencil(self, degree):
        if degree not in self._pencils:
            self._pencils[degree] = Pencil(self.system, degree)
        return self._pencils[degree]

    def serving(self, flow):
        """Return this assembly if its equations are those of `flow` too, else a new one.

        Parameters that enter only through functions of k leave the matrices alone.
        """
        other = Assembly(flow)
        return self if other.system == self.system else other


class Solver:
    """Refines modes of one flow to a relative tolerance, within a largest degree.

    The degree is raised until the truncation error is below `margin` * tolerance, or below rounding.
    """

    def __init__(self, flow, tolerance=TOLERANCE, max_degree=DEGREES[-1], assembly=None, margin=1e-5):
        self.flow = flow
        self.tolerance = tolerance
        self.margin = margin
        self.degrees = tuple(d for d in DEGREES if d <= max_degree) or (max_degree,)
        self.assembly = assembly or Assembly(flow)
        self.pencil = self.assembly.pencil
        self._symbols = {}

    def prepare(self, k):
        """Evaluate the flow's functions of k for a whole array (count,) at once."""
        functions = self.flow.evaluate(k)
        for i, value in enumerate(k):
            self._symbols[float(value)] = _symbols(value, {name: [part[i] for part in parts]
                                                          for name, parts in functions.items()})

    def symbols(self, k):
        if float(k) not in self._symbols:
            self.prepare(np.array([k], dtype=float))
        return self._symbols[float(k)]

    def weights(self, k, degree):
        return self.pencil(degree).weights(self.symbols(k))

    def width(self, k):
        """sigma / rate at wavenumber k."""
        return k ** (1 + self.flow.order)

    def solve(self, k, rate, vectors=None, degree=None):
        """Return the mode next to `rate`, at the first degree that resolves it.

        `vectors` is (degree, x, y) of a nearby mode, if known. Raises ModeLost where the iteration
        does not settle; a mode still unresolved at the largest degree is returned with that status.
        """
        start = self.degrees.index(degree or (vectors[0] if vectors else self.degrees[min(2, len(self.degrees) - 1)]))
        for degree in self.degrees[start:]:
            pencil = self.pencil(degree)
            x, y = transfer(self, vectors, degree) if vectors else (None, None)
            eigen = _refine(pencil, self.weights(k, degree), rate, x, y)
            mode = self._mode(k, degree, eigen)
            if mode.truncation <= max(mode.rounding, self.margin * self.tolerance * abs(mode.sigma)):
                break
            rate, vectors = eigen.rate, (degree, eigen.x, eigen.y)
        return mode

    def next_degree(self, mode):
        """The degree to try first near this mode: one rung lower where it is over-resolved."""
        rung = self.degrees.index(mode.degree)
        return self.degrees[rung - 1] if rung and mode.truncation < 1e-7 * mode.rounding else mode.degree

    def _mode(self, k, degree, eigen):
        width = self.width(k)
        sigma = width * eigen.rate
        rounding = width * _ROUNDING * eigen.rounding + width * eigen.spread + _EPS * abs(sigma)
        truncation = width * eigen.truncation
        error = truncation + rounding
        status = "resolved"
        if error > self.tolerance * abs(sigma):
            status = f"error {error:.1e} exceeds tolerance at degree {degree}"
        slope = width * eigen.slope + (1 + self.flow.order) * sigma / k
        return Mode(self.flow, float(k), complex(sigma), float(error), complex(slope), degree, status,
                    float(truncation), float(rounding), eigen.rate, eigen.slope, eigen.x, eigen.y,
                    eigen.bx, eigen.by)


def check_wavenumbers(k):
    """Return k as a flat float array (points,), or raise a ParameterError."""
    wavenumbers = np.atleast_1d(np.asarray(k, dtype=float)).ravel()
    wrong = wavenumbers[~((wavenumbers > 0) & np.isfinite(wavenumbers))]
    if len(wrong):
        raise ParameterError(f"k must be positive and finite (got {wrong[0]:g})")
    return wavenumbers


def require(mode):
    """Return the mode if it is resolved, else raise NotResolved."""
    if mode.status != "resolved":
        raise NotResolved(f"{mode.flow}, k={mode.k:g}: {mode.status}; raise max_degree or loosen the tolerance")
    return mode


def transfer(solver, vectors, degree):
    """Eigenvectors (degree, x, y) of one degree as vectors of another: series are padded or cut."""
    old, x, y = vectors
    if old == degree:
        return x, y
    source, target = solver.pencil(old), solver.pencil(degree)
    return _fit(x, source.columns, target.columns, target.size), _fit(y, source.rows, target.rows, target.size)


def _fit(vector, source, target, size):
    fitted = np.zeros(size, vector.dtype)
    for name, places in source.items():
        count = min(len(places), len(target[name]))
        fitted[target[name][:count]] = vector[places[:count]]
    return fitted


@dataclass(frozen=True)
class _Eigen:
    rate: complex
    slope: complex
    truncation: float
    rounding: float
    spread: float
    x: np.ndarray
    y: np.ndarray
    bx: np.ndarray
    by: np.ndarray


def _refine(pencil, weights, rate, x, y):
    """Two-sided inverse iteration from `rate` (and vectors, if known) until the quotient has settled."""
    b = pencil.b(weights)
    x = _start(pencil.size) if x is None else x
    y = _start(pencil.size) if y is None else y.conj()  # y^H, a row vector, from here on
    if pencil.real and np.imag(rate) == 0:
        rate, x, y = float(np.real(rate)), x.real, y.real
    for _ in range(_FACTORISATIONS):
        try:
            lu = Factors(pencil.shifted(weights, rate))
        except np.linalg.LinAlgError:
            rate = rate * (1 + 4 * _EPS) + _TINY
            continue
        x, x_error = _iterate(lambda v: lu.solve(b @ v), x)  # noqa: B023
        y, y_error = _iterate(lambda v: lu.solve_left(v @ b), y)  # noqa: B023
        eigen = _quotient(pencil, weights, x, y, b)
        if not np.isfinite(eigen.rate):
            break
        if x_error * y_error < 0.1 * _EPS and max(x_error, y_error) < 1e-6:
            return eigen
        rate = eigen.rate
    raise ModeLost(f"inverse iteration near rate {complex(rate):.6g} did not settle")


def _start(size):
    return np.random.default_rng(1).standard_normal(size)


def _iterate(step, vector):
    """Two inverse iterations with one factorisation; return the vector and an estimate of its error.

    Vectors are scaled by one component. The second step shrinks what the first one changed by the
    ratio of the distances to the wanted and the next eigenvalue, and so will the next.
    """
    pivot = np.argmax(np.abs(vector))
    first = step(vector)
    first = first / first[pivot]
    second = step(first)
    second = second / second[pivot]
    change = _norm(second - first)
    ratio = change / (_norm(first - vector / vector[pivot]) + _TINY)
    return second, min(1.0, ratio) * change / _norm(second) + _EPS


def _norm(vector):
    return sqrt(np.vdot(vector, vector).real)  # a third of the time of np.linalg.norm


def _quotient(pencil, weights, x, y, b):
    """Rayleigh quotient of the pair (y a row vector), its slope in k and its errors."""
    first = pencil.first_b
    rows = pencil.matrices.left(y)  # (parts, size)
    c = rows @ x
    value = weights.value * c
    norm = -value[first:].sum()  # y B x
    rate = value[:first].sum() / norm
    power = pencil.powers(rate)
    y = y / norm
    slope = (weights.slope * c * power).sum() / norm
    spread = (weights.spread * np.abs(c * power)).sum() / abs(norm)
    entries = pencil.squares.combine(np.abs(weights.value * power) ** 2)
    variance = entries.left(np.abs(y) ** 2) @ np.abs(x) ** 2  # of matrix entries
    variance += (np.abs(value * power) ** 2).sum() / abs(norm) ** 2  # of the weights, common to a part
    beyond = np.abs(pencil.beyond(weights.value * power, x)).reshape(len(pencil.last), -1).sum(axis=1)
    truncation = beyond @ np.abs(y[pencil.last]).max(axis=1)
    return _Eigen(rate, slope, truncation, _EPS * np.sqrt(variance), spread, x, y.conj(), b @ x, y @ b)


def _symbols(k, functions):
    return {"k": (k, 1.0, 0.0), **functions}
