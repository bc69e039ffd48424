"""A viscous fluid in parallel flow of any velocity U(z): known by name, given as a function, or measured."""

from dataclasses import dataclass, fields
from functools import lru_cache
from math import inf, isfinite
from typing import Any, ClassVar

import numpy as np

from ..equations.layer import Layer, Profile
from ..errors import NotSmooth, ParameterError
from ..numerics.smooth import Rough, fit
from .base import Flow, choice, parameter, table_parameter
from .measured import DataTable
from .stretch import Stretch, limit, sheared, stretched
from .velocity import NAMES, Function, read
from .velocity_fit import smoothed

_SHOWN = 65  # heights at which a function's values are taken for its digest
_FALLEN = 8.0  # exponent of the fall of vorticity up to a cut, below which a decaying mode is not known to be bound
_WAVES = 6.0  # and wavenumber of vorticity in units of its rate of fall, above which it is not either
_HEIGHTS = 2001  # at which the largest slope of U is sought
_MARGIN = 1.05
_EDGES = ("wall", "free", "decay")


@dataclass(frozen=True)
class Shear(Flow):
    """Perturbations exp(i k x + sigma t) of a viscous fluid of velocity U(z): Orr-Sommerfeld.

    An edge is a wall (no slip), free (flat, without stress: w = t = 0), or at infinity (decay). There the fluid is cut
    where U has become constant. Beyond, vorticity falls like exp(-lambda z), lambda^2 = k^2 + Re (sigma + i k U), and w
    without it like exp(-k z), which the conditions at the cut contain exactly. Vorticity is set to 0 there: what that
    leaves out joins the error bar.

    $$ (U - c) (w'' - k^2 w) - U'' w = (w'''' - 2 k^2 w'' + k^4 w) / (i k Re) $$

    Source: Orszag (1971) for the walls; Drazin and Reid for unbounded shear layers. Scales: see `scales`. Raises
    ParameterError for a parameter outside its range.

    >>> from stability import spectrum
    >>> print(f"{spectrum(Shear('poiseuille', Re=1e4), 1.0, 1).modes[0].c:.8f}")
    0.23752649+0.00373967j
    """

    name: ClassVar[str] = "shear"
    title: ClassVar[str] = "parallel flow of a viscous fluid of any velocity U(z)"
    scales: ClassVar[str] = ("length and velocity: those in which U(z) is given; "
                             "Re: length * velocity / kinematic viscosity; blasius: in displacement thicknesses")

    profile: Any = table_parameter("poiseuille", read, kinds="|".join((*NAMES, "FILE")), meaning=(
        "U(z): a known velocity, or a CSV file with columns z, U and perhaps U_error, the standard error of U"))
    Re: float = parameter(100.0, 0, look=(1.0, 1e5), meaning="Reynolds number of the scales of U(z)")
    bottom: str = choice(  # type: ignore[assignment, misc]
        *_EDGES, meaning="lower edge: no slip, no stress, or at infinity")
    top: str = choice(*_EDGES, meaning="upper edge: no slip, no stress, or at infinity")
    z_low: float = parameter(-inf, None, unbounded=True, look=(0.1, 10.0), meaning=(
        "height of a lower wall or free edge; -inf: where the profile has its own"))
    z_high: float = parameter(inf, None, unbounded=True, look=(0.1, 10.0), meaning=(
        "height of an upper wall or free edge; inf: where the profile has its own"))

    def __post_init__(self) -> None:
        super().__post_init__()
        _fluid(self._key)  # refuses what is no fluid

    @property
    def _key(self) -> Any:
        return self.profile, self.bottom, self.top, self.z_low, self.z_high

    @property
    def _base(self) -> Any:
        return _base(self._key, self.Re)

    @property
    def lowest(self) -> float:
        return self._base.way.low

    @property
    def unbounded(self) -> bool:  # type: ignore[override]
        return "decay" in (self.bottom, self.top)

    @property
    def data(self) -> Any:  # type: ignore[override]
        return _fluid(self._key).curve.data

    @property
    def chopped(self) -> float:  # type: ignore[override]
        return self._base.cut

    def heights(self, s: Any) -> Any:
        """z at the points 0 <= s <= 1 of the layer."""
        return self._base.way.z(s)

    def stated(self) -> dict[str, Any]:
        fluid = _fluid(self._key)
        low, high = fluid.part.ends
        heights = np.linspace(low, high, _SHOWN)
        return {item.name: self.profile.text(heights) if item.name == "profile" else getattr(self, item.name)
                for item in fields(self)}

    def layers(self, names: Any) -> Any:
        base = self._base
        return (Layer("fluid", lambda s: profile(s, base, self.Re)),)

    def conditions(self, edges: Any, names: Any) -> Any:
        """Two at each edge; see the class."""
        bottom, top = edges.fluid
        return *self._edge(self.bottom, bottom, -1, names), *self._edge(self.top, top, 1, names)

    def _edge(self, kind: Any, edge: Any, side: Any, names: Any) -> Any:
        """At a cut: no vorticity, t = 2 k^2 w, and the velocity w ~ exp(-k z) of a fluid without."""
        if kind == "wall":
            return edge.v, edge.w
        if kind == "free":
            return edge.w, edge.t
        k = names.k
        return edge.t - 2 * k**2 * edge.w, edge.v + side * k * edge.w

    def left_out(self, edges: Any, names: Any, k: Any, sigma: Any) -> Any:
        """What makes the conditions at a cut exact.

        With w = a exp(-k z) + b exp(-lambda z) and vorticity f = w'' - k^2 w they are f + f'/lambda = 0 and
        w' + k w - f'/(lambda (lambda + k)) = 0; f' is that of the momentum along.
        """
        found = {}
        for index, (kind, edge, side, U) in enumerate(zip((self.bottom, self.top), edges.fluid, (-1, 1),
                                                          self._base.speeds, strict=True)):
            if kind == "decay":
                inertia = self.Re * (sigma + 1j * k * U)
                slope = side * ((inertia + 2 * k**2) * edge.v - k * edge.n)
                fall = _fall(k, inertia)
                found |= {2 * index: slope / fall, 2 * index + 1: -side * slope / (fall * (fall + k))}
        return found

    def shortest(self) -> Any:
        """The energy of a perturbation grows no faster than max |U'| - 2 k^2/Re."""
        base = self._base
        s = np.linspace(0, 1, _HEIGHTS)
        return float(np.sqrt(0.5 * self.Re * np.abs(base.dU(s, base.way.z(s))).max()) * _MARGIN)

    def bound(self, k: Any, sigma: Any) -> Any:
        """Those that grow, and those whose vorticity falls by exp(-8) at least on the way to a cut, in a few waves."""
        base, sigma = self._base, np.asarray(sigma, dtype=complex)
        inside = np.ones(sigma.shape, dtype=bool)
        for kind, U, way in zip((self.bottom, self.top), base.speeds, base.ways, strict=True):
            if kind == "decay":
                fall = _fall(k, self.Re * (sigma + 1j * k * U))
                inside &= (sigma.real >= 0) | (fall.real * way > _FALLEN) & (np.abs(fall.imag) < _WAVES * fall.real)
        return inside


def _fall(k: Any, inertia: Any) -> Any:
    """The rate lambda at which vorticity falls where U is constant."""
    return np.sqrt(k**2 + inertia + 0j)


def profile(s: Any, base: Any, Re: Any) -> Any:
    """Stresses in viscous units."""
    z = base.way.z(s)
    return Profile(dz=base.way.slope(s), U=base.U(s, z), dU=base.dU(s, z), rho=Re, eta=1.0, beta=1.0, stress=1 / Re)


@dataclass(frozen=True, eq=False)
class _Fluid:
    """The velocity `curve` of a fluid between `low` and `high`, its `limits` at infinity, and where it is sheared."""

    curve: Any
    low: float
    high: float
    limits: tuple[float | None, float | None]
    part: Any


@lru_cache(maxsize=128)
def _fluid(key: Any) -> Any:
    """The fluid of profile, edges and heights; raises ParameterError where they make none."""
    velocity, bottom, top, z_low, z_high = key
    open_ = bottom == "decay", top == "decay"
    curve = smoothed(velocity, *open_, "shear") if isinstance(velocity, DataTable) else velocity
    low, high = (_height(velocity, side, open_[side], value) for side, value in enumerate((z_low, z_high)))
    if not low < high:
        raise ParameterError(f"shear: z_low must be below z_high (got {low:g} and {high:g})")
    start = low if isfinite(low) else high if isfinite(high) else 0.0
    limits: Any = tuple(_limit(curve, side, start) if open_[side] else None for side in (0, 1))
    return _Fluid(curve, low, high, limits, sheared(curve.U, low, high, limits))


def _limit(curve: Any, side: Any, start: Any) -> Any:
    known = curve.limits[side]
    if known is None and not isinstance(curve, Function):
        raise ParameterError(f"shear: {('bottom', 'top')[side]} = decay: {curve.name} has a wall or a free edge there")
    return known if known is not None else limit(curve.U, start, (-1, 1)[side], f"shear: {curve!r}")


def _height(velocity: Any, side: Any, open_: Any, given: Any) -> Any:
    """The height of an edge: infinity, the one given, or that of the profile."""
    name, edge, away = (("z_low", "bottom", -inf), ("z_high", "top", inf))[side]
    own = (velocity.low, velocity.high)[side]
    if given != away and (open_ or isinstance(velocity, DataTable)):
        why = f"{edge} = decay: the fluid has no end there" if open_ else f"the table ends at {own:g}"
        raise ParameterError(f"shear: {name} = {given:g}, but {why}; leave it out")
    if open_:
        return away
    if given in (inf, -inf):
        if not isfinite(own):
            raise ParameterError(f"shear: {edge} must be decay, or its height given: {velocity!r} has no edge there "
                                 f"({edge} = decay, or {name} = a number)")
        return own
    if not velocity.low <= given <= velocity.high:
        raise ParameterError(f"shear: {name} must lie in [{velocity.low:g}, {velocity.high:g}] for {velocity!r} "
                             f"(got {given:g})")
    return given


class _Base:
    """U and U' at the points of a layer: of the velocity, or of its series where its slope is not known.

    `way` maps the points to heights, `ways` are its lengths from the sheared part to the ends, `speeds` (2,) what U is
    at the ends, `cut` bounds what the series leaves out.
    """

    def __init__(self, fluid: Any, Re: Any) -> None:
        self.way: Stretch = stretched(fluid.curve.U, fluid.part, fluid.low, fluid.high, Re)
        self.ways = fluid.part.core[0] - self.way.low, self.way.high - fluid.part.core[1]
        self._curve, self.cut = fluid.curve, 0.0
        ends = [fluid.curve.U(np.array([z]))[0] for z in (self.way.low, self.way.high)]
        self.speeds = tuple(float(end if known is None else known)
                            for end, known in zip(ends, fluid.limits, strict=True))
        if fluid.curve.dU is None:
            self._series, self.cut = _series(self.way, fluid.curve)
            self._slope = np.polynomial.chebyshev.chebder(self._series) * 2

    def U(self, s: Any, z: Any) -> Any:
        if self._curve.dU is None:
            return np.polynomial.chebyshev.chebval(2 * s - 1, self._series)
        return self._curve.U(z)

    def dU(self, s: Any, z: Any) -> Any:
        if self._curve.dU is None:
            return np.polynomial.chebyshev.chebval(2 * s - 1, self._slope) / self.way.slope(s)
        return self._curve.dU(z)


def _series(way: Any, curve: Any) -> Any:
    """The series of U in s, and what it leaves out; raises NotSmooth where it does not end."""
    def sample(s: Any) -> Any:
        values = curve.U(way.z(s))
        if not np.isfinite(values).all():
            z = way.z(s)[~np.isfinite(values)][0]
            raise NotSmooth("shear: layer fluid", f"U is {values[~np.isfinite(values)][0]}", float(z),
                            "the values of U must be finite")
        return values[None]

    try:
        found = fit(sample)
    except Rough as rough:
        raise NotSmooth("shear: layer fluid", "U is not smooth", float(way.z(rough.s)),
                        "take a smooth function, without kink, step or noise") from None
    return found.series[0], float(found.cut[0])


@lru_cache(maxsize=256)
def _base(key: Any, Re: Any) -> Any:
    return _Base(_fluid(key), Re)
