"""The problems as Cawthorn's thesis set them up for bvp4c (4.1.4, 4.2.4): regularised, or under a distant lid."""

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from math import isinf, radians, tan
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..equations.layer import Layer, Profile
from ..errors import ParameterError
from ..flows import Dune, Vortex
from ..flows.base import parameter

if TYPE_CHECKING:
    from ..flows.base import Flow

THESIS_RESIDUAL = 1e-3  # default tolerance of bvp4c and of solve_bvp
THESIS_DELTA = 0.01  # grain size over depth of the layer
THESIS_DEPTH = 100.0  # depth of the fluid times k, where it stands for an unbounded fluid


@dataclass(frozen=True)
class RegularisedVortex(Vortex):
    """Vortices under the pressure `delta` of a monolayer of grains, in the coordinate z: thesis (4.26)-(4.29).

    The term i k c delta W of (4.28) is kept as printed, although a load normal to the surface gives none.
    """

    title: ClassVar[str] = "longitudinal vortices with a delta-regularised free surface"

    delta: float = parameter(THESIS_DELTA, 0, meaning="pressure on the free surface, thesis (4.26)")

    def layers(self, names: Any) -> Any:
        mu = tan(radians(self.slope_deg))

        def profile(s: Any) -> Any:
            viscosity = mu * np.sqrt(1 + self.delta - s)
            return Profile(dz=1.0, rho=self.Fr2, eta=viscosity, beta=viscosity)

        return (Layer("grains", profile),)

    def conditions(self, edges: Any, names: Any) -> Any:
        no_slip, no_flow, stress, pressure, kinematic = super().conditions(edges, names)
        load = self.delta * names.k**2 * names.rate * edges.grains[1].w
        return no_slip, no_flow, stress - load, pressure, kinematic

    def long_wave(self, k: Any) -> Any:
        """sigma = -(k^2 / tan slope) int_0^1 (1-z)^2 (1+delta-z)^{-1/2} dz, what (4.30) should say."""
        low, high = self.delta**0.5, (1 + self.delta) ** 0.5
        integral = 2 / 5 * high**5 - 4 / 3 * self.delta * high**3 + 2 * self.delta**2 * high - 16 / 15 * low**5
        return -(k**2) / tan(radians(self.slope_deg)) * integral


def thesis_setting(flow: "Flow", delta: Any = None) -> Callable[..., Any]:
    """Return k -> flow as the thesis set it up: delta-regularised vortices, dunes under a lid at 100/k.

    Raises ParameterError for other flows, and for a `delta` that the flow has no use for.
    """
    if isinstance(flow, Vortex):
        parameters = {item.name: getattr(flow, item.name) for item in fields(flow)}
        regularised = RegularisedVortex(**parameters, delta=THESIS_DELTA if delta is None else delta)
        return lambda k: regularised
    if delta is not None:
        raise ParameterError(f"--delta regularises the free surface of vortex; {flow.name} has none")
    if isinstance(flow, Dune):
        return lambda k: replace(flow, fluid="layer", depth=THESIS_DEPTH / k if isinf(flow.depth) else flow.depth)
    raise ParameterError(f"--method bvp-thesis: the thesis computes vortex and dune, not {flow.name}")
