"""The friction laws of this package, by name, and those of one's own; what a law is: `stability.flows.law`."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from math import exp, inf, radians, tan
from typing import Any, ClassVar

import numpy as np

from ..errors import ParameterError
from . import sources
from .base import parameter
from .law import Law, check_law


@dataclass(frozen=True)
class Linear(Law):
    """mu = mu1 (1 + b I): thesis (4.48).

    All numbers are without units. Raises ParameterError for a parameter outside its range, and for friction below mu1.

    >>> Linear(mu1=0.4, b=2.0).mu(0.5)
    0.8
    """

    name: ClassVar[str] = "linear"
    title: ClassVar[str] = "mu1 (1 + b I), thesis (4.48)"

    mu1: float = parameter(0.4, 0, look=(0.05, 2.0), meaning="friction at rest")
    b: float = parameter(1.0, 0, look=(0.05, 20.0), meaning="rate coefficient of friction mu1 (1 + b I)")

    @property
    def range(self) -> Any:
        return self.mu1, inf

    @property
    def start(self) -> Any:
        return self.mu1

    def mu(self, I: Any) -> Any:  # noqa: E741
        return self.mu1 * (1 + self.b * I)

    def slope(self, I: Any) -> Any:  # noqa: E741
        return self.mu1 * self.b + 0 * I

    def inverse(self, mu: Any) -> Any:
        self.check(mu)
        return (mu / self.mu1 - 1) / self.b

    def beyond(self, excess: Any) -> Any:
        return excess / (self.mu1 * self.b)


@dataclass(frozen=True)
class Saturating(Law):
    """mu = mu1 + (mu2 - mu1) I / (I0 + I): thesis (1.11), Jop, Forterre & Pouliquen (2005). Defaults: glass beads.

    All numbers are without units. Raises ParameterError for a parameter outside its range, for mu2 below mu1, and for
    friction not between them.

    >>> Saturating(mu1=0.4, mu2=0.6, I0=0.3).mu(0.3)  # half-way
    0.5
    """

    name: ClassVar[str] = "saturating"
    title: ClassVar[str] = "mu1 + (mu2 - mu1) / (1 + I0/I), thesis (1.11)"

    mu1: float = parameter(tan(radians(20.9)), 0, look=(0.05, 2.0), meaning="friction at rest")
    mu2: float = parameter(tan(radians(32.76)), 0, look=(0.05, 2.0), meaning="friction of rapid flow")
    I0: float = parameter(0.279, 0, look=(0.01, 10.0),
                          meaning="inertial number at which friction is half-way between mu1 and mu2")

    def __post_init__(self) -> None:
        super().__post_init__()
        _rising(self)

    @property
    def range(self) -> Any:
        return self.mu1, self.mu2

    @property
    def start(self) -> float:
        return self.mu1

    def mu(self, I: float) -> float:  # noqa: E741
        return self.mu1 + (self.mu2 - self.mu1) * I / (self.I0 + I)

    def slope(self, I: Any) -> Any:  # noqa: E741
        return (self.mu2 - self.mu1) * self.I0 / (self.I0 + I) ** 2

    def inverse(self, mu: float) -> float:
        self.check(mu)
        return self.I0 * (mu - self.mu1) / (self.mu2 - mu)

    def beyond(self, excess: np.ndarray) -> np.ndarray:
        return self.between(excess, self.mu2 - self.mu1 - excess)

    def between(self, excess: np.ndarray, lack: np.ndarray) -> np.ndarray:
        return self.I0 * excess / lack


@dataclass(frozen=True)
class PowerLaw(Law):
    """mu = mu1 (1 + b I^n): at n = 1 the linear law; n = 1/2 is what discs in simulations of kinetic theory show.

    All numbers are without units. Raises ParameterError for a parameter outside its range, and for friction below mu1.

    >>> PowerLaw(mu1=0.5, b=1.0, n=0.5).mu(0.25)
    0.75
    """

    name: ClassVar[str] = "power"
    title: ClassVar[str] = "mu1 (1 + b I^n)"

    mu1: float = parameter(0.4, 0, look=(0.05, 2.0), meaning="friction at rest")
    b: float = parameter(1.0, 0, look=(0.05, 20.0), meaning="rate coefficient of friction mu1 (1 + b I^n)")
    n: float = parameter(1.0, 0, look=(0.2, 2.0), meaning="exponent of the inertial number")

    @property
    def range(self) -> Any:
        return self.mu1, inf

    @property
    def start(self) -> Any:
        return self.mu1

    def mu(self, I: Any) -> Any:  # noqa: E741
        return self.mu1 * (1 + self.b * I**self.n)

    def slope(self, I: Any) -> Any:  # noqa: E741
        return self.mu1 * self.b * self.n * I ** (self.n - 1)

    def inverse(self, mu: Any) -> Any:
        self.check(mu)
        return self.beyond(mu - self.mu1)

    def beyond(self, excess: Any) -> Any:
        return (excess / (self.mu1 * self.b)) ** (1 / self.n)


@dataclass(frozen=True)
class Regularised(Law):
    """Well posed as I -> 0 and as I -> inf: Barker & Gray (J. Fluid Mech. 828, 2017, 5-32).

    mu = sqrt(alpha / ln(A/I)) below I1, (mu1 I0 + mu2 I + mu_inf I^2)/(I0 + I) above it. I1 is where the upper branch
    turns well posed, C(I1) = 0, and A = I1 exp(alpha / mu(I1)^2) makes mu continuous; its slope jumps. There is no
    yield stress: grains creep wherever they are sheared. On the lower branch I mu'/mu = mu^2/(2 alpha).

    All numbers are without units. Raises ParameterError for a parameter outside its range, and for friction that it
    does not reach.

    >>> law = Regularised()
    >>> law.start, len(law.breaks), bool(law.mu(0.1) > law.mu(0.01))
    (0.0, 1, True)
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

    def __post_init__(self) -> None:
        super().__post_init__()
        _rising(self)
        _ = self.I1  # whether there is one

    @property
    def I1(self) -> Any:
        """The inertial number at which the branches meet."""
        return _neutral(self.mu1, self.mu2, self.I0, self.mu_inf)

    @property
    def A(self) -> Any:
        return self.I1 * exp(self.alpha / self._upper(self.I1) ** 2)

    @property
    def breaks(self) -> Any:  # type: ignore[override]
        return (self.I1,)

    @property
    def range(self) -> Any:
        return 0.0, inf if self.mu_inf else self.mu2

    @property
    def start(self) -> Any:
        return 0.0

    @property
    def rest(self) -> Any:
        return self.mu1

    def mu(self, I: Any) -> Any:  # noqa: E741
        return self._by_branch(I, self._lower, self._upper)

    def slope(self, I: Any) -> Any:  # noqa: E741
        return self._by_branch(np.asarray(I, dtype=float), self._lower_slope, self._upper_slope)

    def _by_branch(self, I: Any, lower: Callable[..., Any], upper: Callable[..., Any]) -> Any:  # noqa: E741
        """Values of one function below I1, of the other one above: where all are on one side, of that alone."""
        I1, A = self.I1, self.A
        slow = np.less(I, I1)
        if not slow.any():
            return upper(I)
        with np.errstate(divide="ignore", invalid="ignore"):
            below = lower(np.minimum(I, I1), A)
        return below if slow.all() else np.where(slow, below, upper(I))

    def _lower(self, I: Any, A: Any) -> Any:  # noqa: E741
        return np.sqrt(self.alpha / np.log(A / I))

    def _lower_slope(self, I: Any, A: Any) -> Any:  # noqa: E741
        return self._lower(I, A) ** 3 / (2 * self.alpha * I)

    def _upper_slope(self, I: Any) -> Any:  # noqa: E741
        return (self._first * self.I0 + self.mu_inf * I * (2 * self.I0 + I)) / (self.I0 + I) ** 2

    def inverse(self, mu: Any) -> Any:
        self.check(mu)
        return self.beyond(mu)

    def beyond(self, excess: Any) -> Any:
        """On the upper branch mu_inf I^2 + (mu2 - mu) I = (mu - mu1) I0."""
        mu = np.asarray(excess, dtype=float)
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            lower = self.A * np.exp(-self.alpha / mu**2)
            fall, rise = self.mu2 - mu, (mu - self.mu1) * self.I0
            root = np.sqrt(np.maximum(fall**2 + 4 * self.mu_inf * rise, 0))
            upper = np.where(fall > 0, 2 * rise / (fall + root), (root - fall) / (2 * self.mu_inf or 1.0))
        return np.where(mu < self._upper(self.I1), lower, upper)

    @property
    def _first(self) -> Any:
        return self.mu2 - self.mu1

    def _upper(self, I: Any) -> Any:  # noqa: E741
        return (self.mu1 * self.I0 + self.mu2 * I + self.mu_inf * I**2) / (self.I0 + I)


@lru_cache(maxsize=256)
def _neutral(mu1: Any, mu2: Any, I0: Any, mu_inf: Any) -> Any:
    """The least I at which C of the upper branch of the regularised law is 0; ParameterError where there is none."""
    def excess(I: Any) -> Any:  # noqa: E741
        mu = (mu1 * I0 + mu2 * I + mu_inf * I**2) / (I0 + I)
        slope = ((mu2 - mu1) * I0 + mu_inf * I * (2 * I0 + I)) / (I0 + I) ** 2
        r = I * slope / mu
        return 4 * r * (r - 1) + mu**2 * (1 - r / 2) ** 2

    grid = I0 * np.geomspace(1e-12, 1e6, 3601)
    inside = np.flatnonzero(excess(grid) <= 0)
    if not len(inside) or not inside[0]:
        raise ParameterError(f"regularised: mu1 = {mu1:g} and mu2 = {mu2:g} leave no inertial number at which the "
                             "upper branch is well posed: nothing to join; take a smaller mu1")
    low, high = float(grid[inside[0] - 1]), float(grid[inside[0]])
    while low < (middle := (low + high) / 2) < high:
        low, high = (middle, high) if excess(middle) > 0 else (low, middle)
    return high


def _rising(law: Any) -> None:
    if not law.mu1 < law.mu2:
        raise ParameterError(f"{law.name}: mu2 must exceed mu1, friction at rest (got mu1 = {law.mu1:g}, "
                             f"mu2 = {law.mu2:g})")


LAWS = {law.name: law for law in (Linear, Saturating, Regularised, PowerLaw)}


def find_law(name: str) -> type[Law]:
    """Return the class of laws that a name stands for: of `LAWS`, or FILE.py:CLASS, or PACKAGE.MODULE:CLASS."""
    if name in LAWS:
        return LAWS[name]
    if ":" not in name and not name.endswith(".py"):
        from .catalogue import nearest

        raise ParameterError(f"--law: unknown law {name!r}{nearest(name, LAWS)}; laws: {', '.join(LAWS)}; a law of "
                             "your own is named path/to/file.py:Class or package.module:Class")
    return check_law(sources.load_class(name), name)
