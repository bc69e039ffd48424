"""Friction laws mu(I): shear stress over pressure as a function of the inertial number I = (shear rate) d/sqrt(p/rho).

A law is a value, `Saturating(mu1=0.4, mu2=0.6, I0=0.3)`, that a granular flow takes as its `law`. A law of one's own
is a frozen dataclass with parameters and mu(I):

    @dataclass(frozen=True)
    class Root(Law):
        name: ClassVar[str] = "root"
        mu1: float = parameter(0.4, 0, meaning="friction at rest")

        def mu(self, I):
            return self.mu1 * np.sqrt(1 + I)

Its derivative (by a complex step) and its inverse (by bisection and Newton steps) follow; what is given all the same,
`slope(I)` and `inverse(mu)`, is compared with mu(I), and refused where it contradicts it.
"""

from dataclasses import dataclass, fields
from functools import lru_cache
from math import exp, inf, radians, tan
from typing import Any, ClassVar

import numpy as np

from ..errors import ParameterError
from . import sources
from .base import check_parameter, parameter

_AT_REST, _RAPID = 1e-200, 1e200  # inertial numbers that stand for 0 and for infinity
_STEP = 1e-30  # of the imaginary part by which mu(I) is differentiated
_HALVINGS, _NEWTON = 100, 4  # of log I, then steps to rounding
_LOOK = np.geomspace(1e-4, 10.0, 61)  # inertial numbers at which a law of one's own is looked at
_DIFFERENCE, _ALIKE = 1e-4, 1e-6  # relative step of a difference, and of two slopes that are the same


@dataclass(frozen=True)
class Law:
    """A friction law mu(I), with its derivative and its inverse; arguments are numbers or arrays.

    `breaks` are the inertial numbers at which its slope jumps.
    """

    name: ClassVar[str]
    title: ClassVar[str] = "a law of one's own"
    breaks: ClassVar[tuple[float, ...]] = ()
    yields: ClassVar[bool] = True  # whether grains at rest bear a shear stress, mu > 0 as I -> 0

    def __post_init__(self) -> None:
        for item in fields(self):
            object.__setattr__(self, item.name, check_parameter(self.name, item, getattr(self, item.name)))
        if not sources.shipped(type(self)):
            with sources.faults():
                _verified(self)

    def __init_subclass__(cls, **options: Any) -> None:
        super().__init_subclass__(**options)
        sources.note(cls)

    def __reduce__(self) -> Any:
        return sources.revive, (sources.ticket(type(self)), self.values)

    @property
    def values(self) -> dict[str, Any]:
        """The parameters, {name: number}."""
        return {item.name: getattr(self, item.name) for item in fields(self)}

    @property
    def range(self) -> tuple[float, float]:
        """Open interval of mu for 0 < I < inf."""
        return self.start, float(self.mu(_RAPID))

    @property
    def start(self) -> float:
        """mu as I -> 0: grains at rest bear less. 0 where the law has no yield stress."""
        return float(self.mu(_AT_REST))

    @property
    def rest(self) -> float:
        """The friction coefficient that Shields ratios are measured by."""
        return self.start

    def mu(self, I: Any) -> Any:  # noqa: E741
        raise NotImplementedError

    def slope(self, I: Any) -> Any:  # noqa: E741
        """d mu / d I."""
        return np.imag(self.mu(np.asarray(I, dtype=float) + 1j * _STEP)) / _STEP

    def inverse(self, mu: Any) -> Any:
        """The inertial number at which friction is mu."""
        self.check(mu)
        return self.beyond(np.asarray(mu) - self.start)

    def beyond(self, excess: Any) -> Any:
        """The inertial number at which friction exceeds that at rest by `excess` >= 0."""
        excess = np.asarray(excess, dtype=float)
        low, high = np.full(excess.shape, np.log(_AT_REST)), np.full(excess.shape, np.log(_RAPID))
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            below = self.mu(np.exp(middle)) - self.start < excess
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        found = np.exp((low + high) / 2)
        for _ in range(_NEWTON):
            step = (self.mu(found) - self.start - excess) / self.slope(found)
            found = np.where(np.abs(step) < found / 2, found - step, found)
        return np.where(excess > 0, found, 0.0)

    def check(self, mu: Any) -> None:
        """Raise ParameterError where there is no inertial number at which friction is mu."""
        low, high = self.range
        if not np.all((np.asarray(mu) > low) & (np.asarray(mu) < high)):
            raise ParameterError(f"mu must lie in ({low:g}, {high:g}), the range of the law: no steady flow elsewhere "
                                 f"(got {mu})")


@dataclass(frozen=True)
class Linear(Law):
    """mu = mu1 (1 + b I): thesis (4.48)."""

    name: ClassVar[str] = "linear"
    title: ClassVar[str] = "mu1 (1 + b I), thesis (4.48)"

    mu1: float = parameter(0.4, 0, look=(0.05, 2.0), meaning="friction at rest")
    b: float = parameter(1.0, 0, look=(0.05, 20.0), meaning="rate coefficient of friction mu1 (1 + b I)")

    @property
    def range(self):
        return self.mu1, inf

    @property
    def start(self):
        return self.mu1

    def mu(self, I):  # noqa: E741
        return self.mu1 * (1 + self.b * I)

    def slope(self, I):  # noqa: E741
        return self.mu1 * self.b + 0 * I

    def inverse(self, mu):
        self.check(mu)
        return (mu / self.mu1 - 1) / self.b

    def beyond(self, excess):
        return excess / (self.mu1 * self.b)


@dataclass(frozen=True)
class Saturating(Law):
    """mu = mu1 + (mu2 - mu1) I / (I0 + I): thesis (1.11), Jop, Forterre & Pouliquen (2005). Defaults: glass beads."""

    name: ClassVar[str] = "saturating"
    title: ClassVar[str] = "mu1 + (mu2 - mu1) / (1 + I0/I), thesis (1.11)"

    mu1: float = parameter(tan(radians(20.9)), 0, look=(0.05, 2.0), meaning="friction at rest")
    mu2: float = parameter(tan(radians(32.76)), 0, look=(0.05, 2.0), meaning="friction of rapid flow")
    I0: float = parameter(0.279, 0, look=(0.01, 10.0),
                          meaning="inertial number at which friction is half-way between mu1 and mu2")

    def __post_init__(self):
        super().__post_init__()
        _rising(self)

    @property
    def range(self):
        return self.mu1, self.mu2

    @property
    def start(self):
        return self.mu1

    def mu(self, I):  # noqa: E741
        return self.mu1 + (self.mu2 - self.mu1) * I / (self.I0 + I)

    def slope(self, I):  # noqa: E741
        return (self.mu2 - self.mu1) * self.I0 / (self.I0 + I) ** 2

    def inverse(self, mu):
        self.check(mu)
        return self.I0 * (mu - self.mu1) / (self.mu2 - mu)

    def beyond(self, excess):
        return self.I0 * excess / (self.mu2 - self.mu1 - excess)


@dataclass(frozen=True)
class PowerLaw(Law):
    """mu = mu1 (1 + b I^n): at n = 1 the linear law; n = 1/2 is what discs in simulations of kinetic theory show."""

    name: ClassVar[str] = "power"
    title: ClassVar[str] = "mu1 (1 + b I^n)"

    mu1: float = parameter(0.4, 0, look=(0.05, 2.0), meaning="friction at rest")
    b: float = parameter(1.0, 0, look=(0.05, 20.0), meaning="rate coefficient of friction mu1 (1 + b I^n)")
    n: float = parameter(1.0, 0, look=(0.2, 2.0), meaning="exponent of the inertial number")

    @property
    def range(self):
        return self.mu1, inf

    @property
    def start(self):
        return self.mu1

    def mu(self, I):  # noqa: E741
        return self.mu1 * (1 + self.b * I**self.n)

    def slope(self, I):  # noqa: E741
        return self.mu1 * self.b * self.n * I ** (self.n - 1)

    def inverse(self, mu):
        self.check(mu)
        return self.beyond(mu - self.mu1)

    def beyond(self, excess):
        return (excess / (self.mu1 * self.b)) ** (1 / self.n)


@dataclass(frozen=True)
class Regularised(Law):
    """Well posed as I -> 0 and as I -> inf: Barker & Gray (J. Fluid Mech. 828, 2017, 5-32).

    mu = sqrt(alpha / ln(A/I)) below I1, (mu1 I0 + mu2 I + mu_inf I^2)/(I0 + I) above it. I1 is where the upper branch
    turns well posed, C(I1) = 0, and A = I1 exp(alpha / mu(I1)^2) makes mu continuous; its slope jumps. There is no
    yield stress: grains creep wherever they are sheared. On the lower branch I mu'/mu = mu^2/(2 alpha).
    """

    name: ClassVar[str] = "regularised"
    yields: ClassVar[bool] = False
    title: ClassVar[str] = ("sqrt(alpha / ln(A/I)) below I1, (mu1 I0 + mu2 I + mu_inf I^2)/(I0 + I) above, "
                            "Barker & Gray (2017)")

    mu1: float = parameter(tan(radians(20.9)), 0, look=(0.05, 2.0), meaning="friction at rest of the upper branch")
    mu2: float = parameter(tan(radians(32.76)), 0, look=(0.05, 2.0), meaning="friction of rapid flow")
    I0: float = parameter(0.279, 0, look=(0.01, 10.0), meaning="inertial number of the upper branch")
    alpha: float = parameter(1.9, 0, 2, meaning="of the lower branch sqrt(alpha / ln(A/I))",
                             reason="from 2 on slow flow is ill posed")
    mu_inf: float = parameter(0.05, 0, closed=True, meaning="slope of friction in rapid flow")

    def __post_init__(self):
        super().__post_init__()
        _rising(self)
        _ = self.I1  # whether there is one

    @property
    def I1(self):
        """The inertial number at which the branches meet."""
        return _neutral(self.mu1, self.mu2, self.I0, self.mu_inf)

    @property
    def A(self):
        return self.I1 * exp(self.alpha / self._upper(self.I1) ** 2)

    @property
    def breaks(self):  # type: ignore[override]
        return (self.I1,)

    @property
    def range(self):
        return 0.0, inf if self.mu_inf else self.mu2

    @property
    def start(self):
        return 0.0

    @property
    def rest(self):
        return self.mu1

    def mu(self, I):  # noqa: E741
        slow = np.minimum(I, self.I1)
        with np.errstate(divide="ignore"):
            lower = np.sqrt(self.alpha / np.log(self.A / slow))
        return np.where(np.less(I, self.I1), lower, self._upper(I))

    def slope(self, I):  # noqa: E741
        I = np.asarray(I, dtype=float)  # noqa: E741
        first = self._first
        with np.errstate(divide="ignore", invalid="ignore"):
            lower = self.mu(np.minimum(I, self.I1)) ** 3 / (2 * self.alpha * I)
        upper = (first * self.I0 + self.mu_inf * I * (2 * self.I0 + I)) / (self.I0 + I) ** 2
        return np.where(self.I1 > I, lower, upper)

    def inverse(self, mu):
        self.check(mu)
        return self.beyond(mu)

    def beyond(self, excess):
        """On the upper branch mu_inf I^2 + (mu2 - mu) I = (mu - mu1) I0."""
        mu = np.asarray(excess, dtype=float)
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            lower = self.A * np.exp(-self.alpha / mu**2)
            fall, rise = self.mu2 - mu, (mu - self.mu1) * self.I0
            root = np.sqrt(np.maximum(fall**2 + 4 * self.mu_inf * rise, 0))
            upper = np.where(fall > 0, 2 * rise / (fall + root), (root - fall) / (2 * self.mu_inf or 1.0))
        return np.where(mu < self._upper(self.I1), lower, upper)

    @property
    def _first(self):
        return self.mu2 - self.mu1

    def _upper(self, I):  # noqa: E741
        return (self.mu1 * self.I0 + self.mu2 * I + self.mu_inf * I**2) / (self.I0 + I)


@lru_cache(maxsize=256)
def _neutral(mu1, mu2, I0, mu_inf):
    """The least I at which C of the upper branch of the regularised law is 0; ParameterError where there is none."""
    def excess(I):  # noqa: E741
        mu = (mu1 * I0 + mu2 * I + mu_inf * I**2) / (I0 + I)
        slope = ((mu2 - mu1) * I0 + mu_inf * I * (2 * I0 + I)) / (I0 + I) ** 2
        r = I * slope / mu
        return 4 * r * (r - 1) + mu**2 * (1 - r / 2) ** 2

    grid = I0 * np.geomspace(1e-12, 1e6, 3601)
    inside = np.flatnonzero(excess(grid) <= 0)
    if not len(inside) or not inside[0]:
        raise ParameterError(f"regularised: mu1 = {mu1:g} and mu2 = {mu2:g} leave no inertial number at which the upper "
                             "branch is well posed: nothing to join; take a smaller mu1")
    low, high = float(grid[inside[0] - 1]), float(grid[inside[0]])
    while low < (middle := (low + high) / 2) < high:
        low, high = (middle, high) if excess(middle) > 0 else (low, middle)
    return high


def _rising(law):
    if not law.mu1 < law.mu2:
        raise ParameterError(f"{law.name}: mu2 must exceed mu1, friction at rest (got mu1 = {law.mu1:g}, "
                             f"mu2 = {law.mu2:g})")


@lru_cache(maxsize=256)
def _verified(law):
    """Raise ParameterError where a law of one's own is no law, or where what it gives contradicts its mu(I)."""
    label = law.name
    mu = np.asarray(law.mu(_LOOK))
    if mu.shape != _LOOK.shape or mu.dtype.kind != "f" or not np.isfinite(mu).all() or not (mu > 0).all():
        raise ParameterError(f"{label}: mu(I) must return positive numbers, an array like I")
    if not (np.diff(mu) > 0).all():
        place = _LOOK[int(np.argmax(np.diff(mu) <= 0))]
        raise ParameterError(f"{label}: mu(I) must rise with I: it does not beyond I = {place:.4g}")
    smooth = ~np.any([np.abs(_LOOK / one - 1) < 2 * _DIFFERENCE for one in law.breaks] or [np.zeros(61, bool)], axis=0)
    difference = (law.mu(_LOOK * (1 + _DIFFERENCE)) - law.mu(_LOOK * (1 - _DIFFERENCE))) / (2 * _DIFFERENCE * _LOOK)
    noise = 1e-15 * mu / (_DIFFERENCE * _LOOK)
    given = type(law).slope is not Law.slope
    remedy = "" if given else "; give slope(I), or write mu(I) so that it takes complex numbers"
    _compare(law, "slope(I)", law.slope(_LOOK), difference, _ALIKE * np.abs(difference) + noise, smooth, remedy)
    if type(law).inverse is not Law.inverse or type(law).beyond is not Law.beyond:
        room = 1e-9 * _LOOK + 1e-14 * mu / np.abs(difference)
        _compare(law, "inverse(mu)", law.inverse(mu), _LOOK, room, smooth, "")


def _compare(law, what, value, expected, room, where, remedy):
    value = np.broadcast_to(np.asarray(value, dtype=float), expected.shape)
    off = np.where(where, np.abs(value - expected) - room, -1.0)
    index = int(np.argmax(np.where(np.isnan(off), inf, off)))
    if not off[index] <= 0:
        raise ParameterError(f"{law.name}: {what} contradicts mu(I): at I = {_LOOK[index]:.4g} it is "
                             f"{value[index]:.6g}, mu(I) gives {expected[index]:.6g}{remedy}")


LAWS = {law.name: law for law in (Linear, Saturating, Regularised, PowerLaw)}


def find_law(name: str) -> type[Law]:
    """Return the class of laws that a name stands for: of `LAWS`, or FILE.py:CLASS, or PACKAGE.MODULE:CLASS."""
    if name in LAWS:
        return LAWS[name]
    if ":" not in name and not name.endswith(".py"):
        from .catalogue import nearest

        raise ParameterError(f"--law: unknown law {name!r}{nearest(name, LAWS)}; laws: {', '.join(LAWS)}; a law of your "
                             "own is named path/to/file.py:Class or package.module:Class")
    return check_law(sources.load(name), name)


def check_law(cls: Any, asked: str) -> type[Law]:
    """Return the class, or raise ParameterError where it is no class of friction laws."""
    if not (isinstance(cls, type) and issubclass(cls, Law)):
        raise ParameterError(f"{asked}: {getattr(cls, '__name__', cls)} is no friction law: derive the class from "
                             "stability.flows.Law")
    if not isinstance(getattr(cls, "name", None), str):
        raise ParameterError(f'{asked}: {cls.__name__} has no name: add name: ClassVar[str] = "{cls.__name__.lower()}"')
    for item in fields(cls):
        if "meaning" not in item.metadata:
            raise ParameterError(f'{cls.__name__}.{item.name}: declare it as {item.name}: float = parameter(1.0, '
                                 'meaning="...")')
    return cls


