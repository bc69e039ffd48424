"""What steady granular shear flows share: layers whose shear rate follows from equilibrium and the friction law."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from math import radians, tan
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import chebyshev as C

from ..equations.forms import Form
from ..equations.layer import Layer, Profile
from ..errors import ParameterError
from ..numerics.smooth import Rough, fit
from .base import parameter
from .granular import Granular
from .growth import growths, nodes, swaying, turning
from .law import Law
from .laws import Saturating

_CROWD = 8  # distance from the end at which heights crowd: this power of s


@dataclass(frozen=True)
class Equilibrium:
    """What equilibrium says at the points s of a layer: arrays (points,)."""

    dz: Any
    pressure: Any
    stress: Any
    inertial: Any
    scale: float = 1.0  # of the shear rate: U' = scale I sqrt(pressure)

    @property
    def shear_rate(self) -> np.ndarray:
        return self.scale * self.inertial * np.sqrt(self.pressure)


def sheared_layers(law: Law, parts: list[tuple[str, Callable[[Any], Equilibrium]]],
                   inertia: float = 1.0) -> list[Layer]:
    """The layers of a steady flow, from that at rest at its lower edge upwards.

    Where friction rises as another power of I than the first, the shear rate is a power of the distance from the yield
    surface that is no integer: heights crowd there then.
    """
    low, found = 0.0, []
    velocities: list[np.ndarray] = []
    for name, plain in parts:
        for state in (plain, partial(_crowded, plain, 0), partial(_crowded, plain, 1)):
            try:
                one = fit(lambda s, state=state: np.asarray(state(s).shear_rate * state(s).dz)[None])
                break
            except Rough as rough:
                place = rough.s
        else:
            raise ParameterError(f"layer {name}: the shear rate under law {law.name} is not smooth near "
                                 f"s = {place:.4g}: friction must rise smoothly with I, and the stress stay clear of "
                                 "its largest value") from None
        series = C.chebint(one.series[0], lbnd=-1) / 2
        found.append(Layer(name, _profile(law, state, series, low, inertia)))
        low += float(C.chebval(1.0, series))
        velocities.append(series)
    return found if law.yields else _growing(law, found, [plain for _, plain in parts], velocities, inertia)


def _growing(law: Law, layers: list[Layer], states: list[Callable[[Any], Equilibrium]], velocities: list[np.ndarray],
             inertia: float) -> list[Layer]:
    """The layers of a creeping flow, with the growth of their series."""
    slow, swift = [], []
    for state, series in zip(states, velocities, strict=True):
        one = state(nodes()[0])
        slope = law.slope(one.inertial)
        slow.append(turning(one.dz, one.stress / one.pressure, one.inertial, slope))
        swift.append(swaying(one.dz, inertia, float(C.chebval(1.0, series)), slope * np.sqrt(one.pressure) / one.scale))
    grow = growths([len(series) for series in velocities], slow, swift)
    return [replace(layer, growth=growth) for layer, growth in zip(layers, grow, strict=True)]


def _crowded(state: Any, end: Any, s: Any) -> Any:
    """What a function of s says where heights crowd at one of its ends, 0 or 1."""
    x = s if end == 0 else 1 - s
    here = state(x**_CROWD if end == 0 else 1 - x**_CROWD)
    return replace(here, dz=here.dz * _CROWD * x ** (_CROWD - 1))


def _profile(law: Law, state: Callable[..., Any], series: np.ndarray, low: float, inertia: float) -> Callable[..., Any]:
    def at(s: np.ndarray) -> Profile:
        here = state(s)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            rate, slope = here.shear_rate, law.slope(here.inertial)
            return Profile(dz=here.dz, rho=inertia, U=low + C.chebval(2 * s - 1, series), dU=rate,
                           eta=here.stress / rate, beta=slope * np.sqrt(here.pressure) / here.scale,
                           alpha=here.stress / here.pressure - here.inertial * slope / 2)

    return at


@dataclass(frozen=True, kw_only=True)
class Saturated(Granular):
    """A scene whose usual law is the saturating one."""

    friction = Saturating

    mu1: float = parameter(tan(radians(20.9)), 0, look=(0.05, 2.0), meaning="friction at rest")
    mu2: float = parameter(tan(radians(32.76)), 0, look=(0.05, 2.0), meaning="friction of rapid flow")
    I0: float = parameter(0.279, 0, look=(0.01, 10.0), meaning="inertial number at which friction is half-way between")

    def _within(self, name: str, value: float, low: float, high: float, shown: str) -> None:
        """Refuse a friction coefficient that the law does not reach."""
        if not low < value < high:
            raise ParameterError(f"{self.name}: {name} must lie in {shown}: friction of law {self.law.name} lies "
                                 f"between {low:.6g} and {high:.6g}, no steady flow elsewhere (got "
                                 f"{getattr(self, name):g})")


@dataclass(frozen=True, kw_only=True)
class Steady(Saturated):
    """A steady flow whose waves are not those of a layer of this package: base flow alone."""

    why: ClassVar[str] = "its perturbations are not those of a parallel layer"

    def base_only(self, names: Any) -> None:
        """Refuse what asks for equations, with k as a symbol."""
        if isinstance(getattr(names, "k", None), Form):
            self.conditions(None, names)

    def conditions(self, edges: Any, names: Any) -> Any:
        raise ParameterError(f"{self.name}: {self.why}: ask for stability base {self.name}")
