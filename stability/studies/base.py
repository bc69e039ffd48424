"""The base flow of a flow: profiles of velocity, stresses and viscosities through its layers, as they are solved."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import check_integer
from ..equations.layer import numbers
from ..errors import NotSmooth
from ..flows.base import check_flow
from ..numerics.smooth import Rough, fit
from ..output.panels import Axis, Curve, Panel
from ..output.record import Record
from ..output.text import Row
from ..status import RESOLVED
from .choices import HEIGHTS, MOST_HEIGHTS

if TYPE_CHECKING:
    from ..equations.layer import Layer
    from ..flows.base import Flow

HEIGHT = Axis("z", "height $z$")
VELOCITY, SHEAR_RATE = Axis("U", "velocity $U$"), Axis("dU", "shear rate $U'$")
INERTIAL_NUMBER, STRESS = Axis("inertial_number", "inertial number $I$"), Axis("shear_stress", "stress")


@dataclass(frozen=True, repr=False)
class BaseFlow(Record):
    """Profiles at heights from the lower to the upper edge of every layer, in the scales of the flow.

    Arrays (heights,): `z`, `U` and `dU` (velocity and its slope in z; `error` bounds that of a slope that follows from
    U), `shear_stress`, `viscosity` (shear stress over shear rate), `tangent_viscosity` (its derivative in the shear
    rate), and what else the flow states, such as `pressure` and `inertial_number`. `layer` has the names. nan where a
    quantity has no finite value. `flux` maps layers to the integral of U over z.

    `flow` is what was asked about, `profiles` are the arrays. In the scales L, V and S of the flow: z in L, U in V,
    stresses in S. An unknown name raises AttributeError.

    >>> from stability import flows
    >>> base = base_flow(flows.Poiseuille(), 3)
    >>> base.layer[0], base.z.tolist(), base.dU.tolist(), round(base.flux["fluid"], 12)
    ('fluid', [-1.0, 0.0, 1.0], [2.0, 0.0, -2.0], 1.333333333333)
    """

    flow: Any
    layer: tuple[str, ...]
    profiles: dict[str, np.ndarray] = field(compare=False)  # they follow from the flow
    flux: dict[str, float] = field(compare=False)
    dimension: ClassVar[str] = "height"
    bounded: ClassVar[str] = "dU"

    def __getattr__(self, name: str) -> np.ndarray:
        profiles = self.__dict__.get("profiles", {})
        if name not in profiles:
            raise AttributeError(name)
        return profiles[name]

    def rows(self) -> list[Row]:
        """Return a row for each height, layer by layer from below; None where there is no finite value."""
        return list(self._rows)

    @cached_property
    def _rows(self) -> list[Row]:
        values = {name: [float(one) if np.isfinite(one) else None for one in column]
                  for name, column in self.profiles.items()}
        return [{"layer": layer, **{name: column[i] for name, column in values.items()}, "status": RESOLVED}
                for i, layer in enumerate(self.layer)]

    def panels(self) -> tuple[Panel, ...]:
        """Over the height: velocity, inertial number (where there is one) or shear rate, shear stress and pressure."""
        rate = INERTIAL_NUMBER if "inertial_number" in self.profiles else SHEAR_RATE
        stresses = self._curves("shear_stress", r"$\tau$ "), self._curves("pressure", "$p$ ")
        return (Panel(VELOCITY, HEIGHT, self._curves("U")), Panel(rate, HEIGHT, self._curves(rate.name)),
                Panel(STRESS, HEIGHT, stresses[0] + stresses[1]))

    def _curves(self, name: str, symbol: str = "") -> tuple[Curve, ...]:
        """A curve for each layer, with the bars of slopes that follow; none where the flow does not state `name`."""
        if name not in self.profiles:
            return ()
        names, several = np.array(self.layer), len(self.flux) > 1
        bars = self.error if name == "dU" and self.error.any() else None
        return tuple(Curve(self.profiles[name][names == layer], self.profiles["z"][names == layer],
                           label=(symbol + layer if several else symbol.strip()) or None,
                           x_error=None if bars is None else bars[names == layer]) for layer in self.flux)

    def notes(self) -> list[str]:
        fluxes = [f"flux in {layer}: {flux:.10g}" for layer, flux in self.flux.items()]
        return [*fluxes, *self.flow.remarks(), *(f"scales: {self.flow.scales}",)]


def base_flow(flow: Any, points: int = HEIGHTS) -> BaseFlow:
    """Return the `BaseFlow` at `points` heights of each layer.

    >>> from stability import flows
    >>> base_flow(flows.Film(), 3).U.tolist()
    [0.0, 0.75, 1.0]

    Arrays (points,) of each layer in the scales of the flow. Raises ParameterError for what is no flow, NotSmooth where
    a profile is rough.
    """
    check_flow(flow)
    points = check_integer(points, "points", 2, MOST_HEIGHTS)
    s, bottom = np.linspace(0, 1, points), float(flow.lowest)
    names, parts, flux = [], [], {}
    for layer in flow.layers(numbers(flow)):
        profiles = _profiles(flow, layer, s, bottom)
        names += [layer.name] * points
        parts.append(profiles)
        flux[layer.name] = _flux(flow, layer, bottom)
        bottom += float(layer.height(np.array(1.0)))
    columns = {name: np.concatenate([part.get(name, np.full(points, np.nan)) for part in parts])
               for name in dict.fromkeys(name for part in parts for name in part)}
    return BaseFlow(flow, tuple(names), columns, flux)


def _profiles(flow: "Flow", layer: "Layer", s: np.ndarray, bottom: float) -> dict[str, np.ndarray]:
    """The columns of one layer, {name: (points,)}."""
    with np.errstate(divide="ignore", invalid="ignore"):
        base, z = layer.base(s), bottom + layer.height(s)
        derived = layer.profile(s).dU is None
        error = layer.slope("U", s)[1] / np.abs(base.dz) if derived else np.zeros(len(s))
        state = flow.state(layer.name, z, base)
        found = {"z": z, "U": state.pop("U"), "dU": state.pop("dU"), "shear_stress": state.pop("shear_stress"),
                 "viscosity": base.stress * base.eta, "tangent_viscosity": base.stress * base.beta, **state,
                 "error": error}
    return {name: np.broadcast_to(np.asarray(value, dtype=float), s.shape) + 0.0 for name, value in found.items()}


def _flux(flow: "Flow", layer: "Layer", bottom: float) -> float:
    """The integral of U over the layer."""
    def sample(s: np.ndarray) -> np.ndarray:
        base = layer.base(s)
        velocity = flow.state(layer.name, bottom + layer.height(s), base)["U"]
        return np.broadcast_to(np.asarray(velocity * base.dz, dtype=float), (1, len(s)))

    try:
        series = fit(sample).series[0]
    except Rough as rough:
        raise NotSmooth(f"{flow.name}: layer {layer.name}", f"U is not smooth near s = {rough.s:.4g}", None,
                        "take a smooth profile") from None
    integral = np.polynomial.chebyshev.chebint(series, lbnd=-1)
    return float(np.polynomial.chebyshev.chebval(1.0, integral)) / 2
