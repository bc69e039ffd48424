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
from math import inf
from typing import Any, ClassVar

import numpy as np

from ..errors import ParameterError
from . import sources
from .rules import check_parameter

_AT_REST, _RAPID = 1e-200, 1e200  # inertial numbers that stand for 0 and for infinity
_STEP = 1e-30  # of the imaginary part by which mu(I) is differentiated
_HALVINGS, _NEWTON = 100, 4  # of log I, then steps to rounding
_LOOK = np.geomspace(1e-4, 10.0, 61)  # inertial numbers at which a law of one's own is looked at
_DIFFERENCE, _ALIKE = 1e-4, 1e-6  # relative step of a difference, and of two slopes that are the same


@dataclass(frozen=True)
class Law:
    """A friction law mu(I), with its derivative and its inverse; arguments are numbers or arrays.

    `breaks` are the inertial numbers at which its slope jumps.

    Friction and the inertial number are numbers without units. Raises ParameterError for a parameter outside its range,
    for friction that no inertial number has, and where a law contradicts itself.

    >>> from stability.flows import Linear
    >>> law = Linear(mu1=0.4, b=1.0)
    >>> isinstance(law, Law), law.mu(0.5), round(float(law.inverse(0.6)), 12), law.range
    (True, 0.6000000000000001, 0.5, (0.4, inf))
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
        return float(self.mu(_AT_REST)) if self.yields else 0.0

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

    def between(self, excess: Any, lack: Any) -> Any:
        """The same where friction lacks `lack` of its largest value: near that, an excess alone has few digits."""
        return self.beyond(excess)

    def check(self, mu: Any) -> None:
        """Raise ParameterError where there is no inertial number at which friction is mu."""
        low, high = self.range
        if not np.all((np.asarray(mu) > low) & (np.asarray(mu) < high)):
            raise ParameterError(f"mu must lie in ({low:g}, {high:g}), the range of the law: no steady flow elsewhere "
                                 f"(got {mu})")


@lru_cache(maxsize=256)
def _verified(law: Any) -> None:
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
    room = 1e-9 * _LOOK + 1e-14 * mu / np.abs(difference)
    if type(law).inverse is not Law.inverse or type(law).beyond is not Law.beyond:
        _compare(law, "inverse(mu)", law.inverse(mu), _LOOK, room, smooth, "")
    if type(law).between is not Law.between:
        found = law.between(mu - law.start, law.range[1] - mu)
        _compare(law, "between(excess, lack)", found, _LOOK, room, smooth, "")


def _compare(law: Any, what: Any, value: Any, expected: Any, room: Any, where: Any, remedy: Any) -> None:
    value = np.broadcast_to(np.asarray(value, dtype=float), expected.shape)
    off = np.where(where, np.abs(value - expected) - room, -1.0)
    index = int(np.argmax(np.where(np.isnan(off), inf, off)))
    if not off[index] <= 0:
        raise ParameterError(f"{law.name}: {what} contradicts mu(I): at I = {_LOOK[index]:.4g} it is "
                             f"{value[index]:.6g}, mu(I) gives {expected[index]:.6g}{remedy}")


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
