"""What a velocity U(z) may be given as: the name of a known one, a function, or a table.

Each is a value: frozen, hashable, comparable, and it travels to the processes that share the work of a map.
"""

import os
import pickle
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from hashlib import sha256
from math import inf
from typing import Any

import numpy as np

from ..checks import shown
from ..errors import ParameterError
from .measured import DIGEST, DataTable, from_arrays, from_file

_WALL_SLOPE = 0.33205733621519630  # f''(0) of 2 f''' + f f'' = 0, f' = 1 far away
_STEP, _ORDER, _END = 0.25, 26, 14.0  # of its Taylor series; beyond _END, f' = 1 to all digits


@dataclass(frozen=True)
class Named:
    """A known velocity: U and U' as functions of z, the edges `low`, `high` of its fluid, its `limits` at infinity."""

    name: str
    low: float
    high: float
    limits: tuple[float | None, float | None]

    data = None  # no measured values

    def __repr__(self) -> str:
        return repr(self.name)

    def text(self, heights: np.ndarray) -> str:
        """What tells it from others in a file."""
        return self.name

    def U(self, z: np.ndarray) -> np.ndarray:
        return _NAMED[self.name](z)[0]

    def dU(self, z: np.ndarray) -> np.ndarray:
        return _NAMED[self.name](z)[1]


@dataclass(frozen=True)
class Function:
    """A velocity given as a function of heights (points,), of a fluid whose edges are given elsewhere."""

    function: Callable[..., Any]
    low = -inf
    high = inf
    limits = None, None
    data = None
    dU = None  # from the series of U

    def __repr__(self) -> str:
        return getattr(self.function, "__qualname__", type(self.function).__name__)

    def __reduce__(self) -> Any:
        try:
            pickle.dumps(self.function)
        except Exception as reason:  # whatever a function's own parts raise
            raise ParameterError(f"shear: profile: {self!r} cannot be sent to other processes ({reason}): use a "
                                 "function of a module") from None
        return Function, (self.function,)

    def text(self, heights: np.ndarray) -> str:
        """What tells it from others in a file: its name, and a digest of its values."""
        return f"{self!r} (sha256 {sha256(self.U(heights).tobytes()).hexdigest()[:DIGEST]})"

    def U(self, z: np.ndarray) -> np.ndarray:
        try:
            with np.errstate(all="ignore"):
                values = np.asarray(self.function(z))
        except Exception as reason:  # somebody else's function: say which, and what it was asked
            raise ParameterError(f"shear: profile: {self!r} fails for an array of {len(z)} heights from {z.min():.4g} "
                                 f"to {z.max():.4g}: {type(reason).__name__}: {shown(reason)}") from reason
        if values.shape != z.shape or values.dtype.kind not in "fiu":
            raise ParameterError(f"shear: profile: {self!r} must return a real number for each of an array of heights "
                                 f"(got {values.dtype}, shape {values.shape}, for shape {z.shape})")
        return values.astype(float)


def read(name: str, value: Any) -> Any:
    """Return the velocity that a value stands for: a name, a path, a function or arrays; raises ParameterError."""
    if isinstance(value, Named | Function | DataTable):
        return value
    if isinstance(value, str) and value in NAMES:
        return NAMES[value]
    if isinstance(value, str | os.PathLike):
        return from_file(name, value, list(NAMES))
    if callable(value) and not isinstance(value, type):
        return Function(value)
    if isinstance(value, tuple | list) and len(value) in (2, 3):
        return from_arrays(name, *value)
    raise ParameterError(f"{name} must be one of {', '.join(NAMES)}, the path of a CSV file, a function U(z), or "
                         f"arrays (z, U) or (z, U, U_error) (got {shown(value)})")


def _poiseuille(z: Any) -> Any:
    return 1 - z**2, -2 * z


def _bickley(z: Any) -> Any:
    fall = np.exp(-2 * np.abs(z))
    U = 4 * fall / (1 + fall) ** 2
    return U, -2 * U * np.tanh(z)


def _tanh(z: Any) -> Any:
    return np.tanh(z), _bickley(z)[0]


def _blasius(z: Any) -> Any:
    """f' and its slope, with eta = z * displacement thickness in units of sqrt(nu x / U)."""
    taylor, thickness = _blasius_series()
    eta = np.minimum(z * thickness, _END)
    index = np.minimum(eta / _STEP, len(taylor) - 1).astype(int)
    offset = eta - (index + 0.5) * _STEP
    U, dU = np.zeros_like(eta), np.zeros_like(eta)
    for power in range(_ORDER, 0, -1):
        U = U * offset + power * taylor[index, power]
        if power > 1:
            dU = dU * offset + power * (power - 1) * taylor[index, power]
    inside = eta < _END
    return np.where(inside, U, 1.0), np.where(inside, dU * thickness, 0.0)


@lru_cache(maxsize=1)
def _blasius_series() -> Any:
    """Taylor coefficients (steps, order + 1) of f about the middles of steps, and the displacement thickness."""
    rows, state = [], (0.0, 0.0, _WALL_SLOPE)
    for _ in range(round(_END / _STEP)):
        rows.append(_taylor(_moved(_taylor(state), _STEP / 2)))
        state = _moved(rows[-1], _STEP / 2)
    return np.array(rows), _END - state[0]


def _taylor(state: Any) -> Any:
    """Taylor coefficients of f from f, f' and f''."""
    f = [state[0], state[1], state[2] / 2]
    for n in range(_ORDER - 2):
        total = sum(f[j] * (n - j + 2) * (n - j + 1) * f[n - j + 2] for j in range(n + 1))
        f.append(-total / (2 * (n + 3) * (n + 2) * (n + 1)))
    return f


def _moved(f: Any, step: Any) -> Any:
    """f, f' and f'' at a distance from where its Taylor series is given."""
    series = np.polynomial.Polynomial(f)
    return tuple(float(series.deriv(order)(step)) if order else float(series(step)) for order in range(3))


_NAMED = {"poiseuille": _poiseuille, "bickley": _bickley, "tanh": _tanh, "blasius": _blasius}
NAMES = {one.name: one for one in (
    Named("poiseuille", -1.0, 1.0, (None, None)), Named("bickley", -inf, inf, (0.0, 0.0)),
    Named("tanh", -inf, inf, (-1.0, 1.0)), Named("blasius", 0.0, inf, (None, 1.0)))}
