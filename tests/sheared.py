"""Base flows that are no polynomials, with U'' for the references of `collocation`; run as a script, their table.

    python tests/sheared.py > tests/tables/recomputed_base_flows.csv
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import mpmath as mp
import numpy as np
from collocation import wave_speed

from stability import spectrum
from stability.equations.layer import Layer, Profile
from stability.flows.base import Flow, parameter

_COUNTS = 160, 224, 288, 384, 512, 640  # of collocation points
_AGREE = 2e-15
_LAST_DIGIT = 1e-18  # of extended precision
RANDOM = 60  # random profiles in the table
_STEP, _ORDER, _END = 0.25, 24, 14.0  # of the Taylor series of the boundary layer: beyond _END, U = 1 to 20 digits


@dataclass(frozen=True)
class Sheared(Flow):
    """A viscous fluid of velocity `shape(z)` = U, U', U'' for low <= z <= high.

    The `edge` is a "wall", or "slip" on lids without stress, or a wall below and "far" above: unbounded.
    """

    scales: ClassVar[str] = "those of the profile"
    edge: ClassVar[str] = "wall"

    Re: float = parameter(100.0, 0, meaning="Reynolds number")

    def layers(self, names):
        thickness = self.high - self.low

        def profile(s):
            U, dU, _ = self.shape(self.low + thickness * s)
            return Profile(dz=thickness, U=U, dU=dU, eta=1 / self.Re, beta=1 / self.Re)

        return (Layer("fluid", profile),)

    def conditions(self, edges, names):
        low, high = edges.fluid
        if self.edge == "slip":
            return low.w, low.t, high.w, high.t
        k = names.k
        far = high.v + k * high.w, high.t - 2 / self.Re * k**2 * high.w
        return low.v, low.w, *(far if self.edge == "far" else (high.v, high.w))

    @property
    def bottom(self):
        return self.low

    def reference(self, k, guess, count):
        """The wave speed next to the guess, by collocation in extended precision."""
        return wave_speed(lambda z: self.shape(z)[0], lambda z: self.shape(z)[2], self.low, self.high, self.Re, k,
                          guess, count, self.edge)


@dataclass(frozen=True)
class ShearLayer(Sheared):
    """U = tanh z between lids without stress at z = -width and z = width."""

    name: ClassVar[str] = "shear_layer"
    title: ClassVar[str] = "shear layer"
    edge: ClassVar[str] = "slip"

    width: float = parameter(10.0, 0, meaning="half the distance of the lids")

    @property
    def low(self):
        return -self.width

    @property
    def high(self):
        return self.width

    def shape(self, z):
        return layer(z)


@dataclass(frozen=True)
class Jet(ShearLayer):
    """U = sech^2 z between lids without stress."""

    name: ClassVar[str] = "jet"
    title: ClassVar[str] = "plane jet"

    def shape(self, z):
        return jet(z)


@dataclass(frozen=True)
class BoundaryLayer(Sheared):
    """Blasius flow between a wall and a lid at 40 displacement thicknesses, in which lengths are measured."""

    name: ClassVar[str] = "boundary_layer"
    title: ClassVar[str] = "boundary layer on a plate"
    low: ClassVar[float] = 0.0
    high: ClassVar[float] = 40.0

    def shape(self, z):
        return blasius(z)


@dataclass(frozen=True)
class OpenBoundaryLayer(BoundaryLayer):
    """Blasius flow without a lid."""

    name: ClassVar[str] = "open_boundary_layer"
    edge: ClassVar[str] = "far"
    high: ClassVar[float] = 10.0


@dataclass(frozen=True)
class RandomShear(Sheared):
    """Sums of shear layers, jets and a cubic between walls at z = -1 and z = 1, drawn from a seed."""

    name: ClassVar[str] = "random_shear"
    title: ClassVar[str] = "random profile between walls"
    low: ClassVar[float] = -1.0
    high: ClassVar[float] = 1.0

    seed: float = parameter(0.0, 0, closed=True, meaning="seed of the random numbers")

    def shape(self, z):
        rng = np.random.default_rng(int(self.seed))
        a, b, c, d = rng.standard_normal(4)
        total = [a * z + b * z**2 + c * z**3, a + 2 * b * z + 3 * c * z**2, 2 * b + 6 * c * z]
        for kind in (layer, jet, layer, jet)[: rng.integers(1, 5)]:
            height, centre, width = rng.standard_normal(), rng.uniform(-0.8, 0.8), 10 ** rng.uniform(-1.3, 0)
            for order, part in enumerate(kind((z - centre) / width)):
                total[order] = total[order] + height * part / width**order
        return total

    @classmethod
    def draw(cls, seed):
        """A profile with its Reynolds number, and a wavenumber."""
        rng = np.random.default_rng([1908, seed])
        return cls(Re=float(f"{10 ** rng.uniform(1, 4):.3g}"), seed=seed), float(f"{10 ** rng.uniform(-0.5, 0.5):.3g}")


def layer(z):
    t = np.tanh(z)
    return t, 1 - t**2, -2 * t * (1 - t**2)


def jet(z):
    t, s = np.tanh(z), 1 / np.cosh(z) ** 2
    return s, -2 * s * t, s * (4 * t**2 - 2 * s)


def blasius(z):
    """U, U' and U'' at heights in displacement thicknesses."""
    taylor, thickness = _blasius()
    eta = z * thickness.astype(z.dtype)
    index = np.minimum(eta / _STEP, len(taylor) - 1).astype(int)
    offset = np.minimum(eta, _END) - (index * _STEP + _STEP / 2)
    found = []
    for order in range(1, 4):
        value = 0 * eta
        for power in range(_ORDER, order - 1, -1):
            factor = float(np.prod(np.arange(power - order + 1, power + 1, dtype=float)))
            value = value * offset + factor * taylor[index, power].astype(z.dtype)
        rest = 1.0 if order == 1 else 0.0
        found.append(np.where(eta < _END, value, rest) * thickness.astype(z.dtype) ** (order - 1))
    return found


@lru_cache(maxsize=1)
def _blasius():
    """Taylor coefficients (steps, order + 1) of f, 2 f''' + f f'' = 0, about the middles of steps; then eta - f."""
    with mp.workdps(40):
        state, unit = (mp.mpf(0), mp.mpf(0), mp.mpf(1)), mp.mpf(1)
        for _ in range(2):  # with f''(0) = 1, then with what makes f' = 1 far away
            rows, state = [], (mp.mpf(0), mp.mpf(0), unit)
            for _ in range(round(_END / _STEP) if unit != 1 else 80):
                middle = _moved(_taylor(state), mp.mpf(_STEP) / 2)
                rows.append(_taylor(middle))
                state = _moved(rows[-1], mp.mpf(_STEP) / 2)
            unit = state[1] ** mp.mpf("-1.5")
        table = np.array([[_longdouble(value) for value in row[: _ORDER + 1]] for row in rows])
        return table, _longdouble(_END - state[0])


def _taylor(state, order=40):
    """Taylor coefficients of f from f, f' and f''."""
    f = [state[0], state[1], state[2] / 2]
    for n in range(order - 2):
        total = sum(f[j] * (n - j + 2) * (n - j + 1) * f[n - j + 2] for j in range(n + 1))
        f.append(-total / (2 * (n + 3) * (n + 2) * (n + 1)))
    return f


def _moved(f, step):
    """f, f' and f'' at a distance from where its Taylor series is given."""
    return tuple(sum(mp.ff(n, order) * a * step ** (n - order) for n, a in enumerate(f) if n >= order)
                 for order in range(3))


def _longdouble(value):
    high = float(value)
    return np.longdouble(high) + np.longdouble(float(value - high))


CASES = {"shear_layer": (ShearLayer(width=10.0), 0.4, 0.4363j, (256, 320)),
         "thick_shear_layer": (ShearLayer(width=40.0), 0.4, 0.43665j, (768, 900)),
         "jet": (Jet(width=20.0), 0.5, 0.29321 + 0.23765j, (400, 480)),
         "boundary_layer": (BoundaryLayer(Re=998.0), 0.308, 0.36412 + 0.00796j, (256, 320)),
         "open_boundary_layer": (OpenBoundaryLayer(Re=998.0), 0.308, 0.36412 + 0.00796j, (128, 160))}


def _row(name, flow, k, guess, counts=_COUNTS):
    """A line of the table: from the first two numbers of points that agree."""
    before, error = np.inf, np.inf
    for count in counts:
        value = flow.reference(k, guess, count)
        before, error = value, max(float(abs(value - before)), _LAST_DIGIT)
        if error < _AGREE:
            return f"{name},{flow.Re:g},{k:g},{_digits(value.real)},{_digits(value.imag)},{error:.0e}"
    raise ArithmeticError(f"{name}: numbers of points differ by {error:.1e}")


def _digits(value):
    return np.format_float_positional(value, precision=20, fractional=True, trim="0")


def _write():
    print("# source: recomputed in extended precision by collocation (Orr-Sommerfeld equation), tests/collocation.py,")
    print("#   at two numbers of points, which agree to the last column; written by tests/sheared.py")
    print("# table: least stable modes where the profile is no polynomial; a number is the seed of a random profile")
    print("# scaling: those of the profiles; exp(i k (x - c t)); Re and k are the binary numbers nearest to those here")
    print("# digits: up to the last column")
    print("# known misprints: none")
    print("flow,Re,k,c_real,c_imag,error")
    for name, case in CASES.items():
        print(_row(name, *case), flush=True)
    for seed in range(RANDOM):
        flow, k = RandomShear.draw(seed)
        print(_row(seed, flow, k, spectrum(flow, k, 1).modes[0].c), flush=True)


if __name__ == "__main__":
    _write()
