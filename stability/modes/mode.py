"""One mode of one flow, and what can be asked of it."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import NotResolved
from ..status import Status, is_resolved
from .eigenvalue import Eigenvalue

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike

    from ..output.panels import Panel
    from .eigenfunction import Fields

_SAFETY = 5.0  # of the bar of a group speed: it then held at 797 of 798 points against 44 digits (measured)
_SLOPE = 4.0  # error of d sigma/dk in units of error of sigma / k (measured)


@dataclass(frozen=True)
class Mode(Eigenvalue):
    """An eigenvalue with error bar and eigenvectors.

    `sigma` complex growth rate, `error` bound of its absolute error, `slope` d sigma/dk, `truncation` and
    `rounding` the parts of the error, `degree` of the series, `status` "resolved" or what failed. `x`, `y`
    (size,) hold the right and left eigenvector in the pencil of that degree, with y^H B x = 1. `data_error` is the
    standard error of the growth rate from the errors of a measured base flow, None where nothing was measured;
    `scatter` is what the errors of the vectors leave in the slope.

    Of `flow` at wavenumber `k` (1/L, the scales of the flow): `sigma`, `growth_rate` and the errors are in V/L,
    `slope`, `c` and `phase_speed` in V. `rate` = sigma / k^(1 + order) and its derivative `rate_slope` are what the
    pencil has. Its methods raise ParameterError where heights lie outside the flow.

    >>> from stability import dispersion, flows
    >>> mode = dispersion(flows.Dune(), 1.0).modes[0]
    >>> print(f"{mode.sigma:.8f}")
    0.23433997-1.00915105j
    >>> mode.status, mode.error < 1e-12, bool(abs(mode.fields(0.0).p - 1) < 1e-9)  # p = s0 at the interface
    ('resolved', True, True)
    """

    flow: Any
    k: float
    sigma: complex
    error: float
    slope: complex
    degree: int
    status: Status
    truncation: float
    rounding: float
    rate: complex = field(repr=False)
    rate_slope: complex = field(repr=False)
    x: np.ndarray = field(repr=False, compare=False)
    y: np.ndarray = field(repr=False, compare=False)
    data_error: float | None = field(default=None, repr=False, compare=False)
    scatter: float = field(default=0.0, repr=False, compare=False)

    @property
    def slope_error(self) -> float:
        """Estimate of the absolute error of d sigma/dk."""
        return _SLOPE * self.error / self.k

    @property
    def group_speed(self) -> float:
        """Real part of the group velocity d omega/dk, V: omega = i sigma, so that it is -Im d sigma/dk."""
        return (1j * self.slope).real + 0.0  # no negative zero

    @property
    def group_error(self) -> float:
        """Bound of the absolute error of the group speed: of rounding and truncation, and of the vectors."""
        length = max(1.0, 1 / self.k)  # over which fields change with k: short waves fill a layer
        return _SAFETY * (2 * self.error * length + self.scatter)

    def fields(self, z: "ArrayLike") -> "Fields":
        """Return velocities, stresses and pressure of the eigenfunction at heights z, as `eigenfunction.Fields`.

        Raises ParameterError where z lies outside the layers of the flow.

        >>> from stability import dispersion, flows
        >>> fields = dispersion(flows.Film(), 1e-4).modes[0].fields([0.0, 1.0])  # z in depths of the film
        >>> abs(fields.u).round(3).tolist()  # no slip; -dU' of the lifted surface: u = 2
        [0.0, 2.0]
        """
        from .eigenfunction import Eigenfunction

        return Eigenfunction(self).at(z)

    def panels(self) -> "tuple[Panel, ...]":
        """|u| and |w| against z, layer by layer."""
        from ..output.panels import LINE, Axis, Curve, Panel
        from .eigenfunction import Eigenfunction

        curves: list[Curve] = []
        for part in Eigenfunction(self).profiles():
            again = bool(curves)
            curves += [Curve(np.abs(values), part.z, None if again else name, LINE, of=number if again else None)
                       for number, (name, values) in enumerate((("$|u|$", part.u), ("$|w|$", part.w)))]
        return (Panel(Axis("velocity", f"velocity at $k$ = {self.k:g}"), Axis("z", "height $z$"), tuple(curves),
                      limits={"xlim": (0, None)}),)

    def plot(self, ax: "Axes | None" = None, *, label: str | None = None, **line_options: Any) -> "Axes":
        """Draw |u| and |w| against z into the matplotlib Axes `ax`, or a new one; return it.

        Heights are in L, velocities in V for a unit amplitude of the first surface. Raises AttributeError for an option
        that matplotlib's lines have not.

        >>> from matplotlib.figure import Figure
        >>> from stability import dispersion, flows
        >>> mode = dispersion(flows.Vortex(), 1.0).modes[0]
        >>> len(mode.plot(Figure().add_subplot(), color="black").lines)
        2
        """
        from ..output import plots

        return plots.plot(self.panels(), ax, None, label, **line_options)

    def base_flow_sensitivity(self, z: "ArrayLike") -> np.ndarray:
        """Return S at heights z: delta sigma = integral of S(z) delta U(z) dz for a small change of the base flow.

        What the change of U' = dU/dz does is in it. S has the units of sigma over those of U and z, and the shape of z.
        Raises ParameterError outside the layers and for flows in which U enters not through convection alone.

        >>> import numpy as np
        >>> from stability import dispersion, flows
        >>> mode = dispersion(flows.Poiseuille(Re=1e4), 1.0).modes[0]
        >>> nodes, weights = np.polynomial.legendre.leggauss(400)
        >>> print(f"{weights @ mode.base_flow_sensitivity(nodes):.6f}")  # U + 1 adds -i k: the frame moves
        -0.000000-1.000000j
        """
        from .velocity_response import density

        return density(self, z)

    def plot_base_flow_sensitivity(self, ax: "Axes | None" = None) -> "Axes":
        """Draw real and imaginary part of S against z into the matplotlib Axes `ax`, or a new one; return it.

        Units and errors are those of `base_flow_sensitivity`, which raises ParameterError where there is no S.

        >>> from stability import dispersion, flows
        >>> mode = dispersion(flows.Couette(), 1.0).modes[0]
        >>> mode.plot_base_flow_sensitivity().get_ylabel()
        'height $z$'
        """
        from ..output import plots
        from .velocity_response import panel

        return plots.plot((panel(self),), ax)

    def sensitivity(self) -> dict[str, complex | None]:
        """Return d sigma / d parameter of every numeric parameter, and "k", at the others fixed, from the left vector.

        None where there is no derivative: at an infinite value. `sensitivity.sensitivities` adds error bars.

        Units are V/L over those of the parameter. Raises nothing: what cannot be found is None.

        >>> from stability import dispersion, flows
        >>> slopes = dispersion(flows.Film(), 1e-5).modes[0].sensitivity()
        >>> print(f"{slopes['k']:.2f}")  # waves of twice the surface speed: sigma = -2 i k
        0.00-2.00j
        """
        from ..studies.sensitivity import sensitivities

        return {one.parameter: one.slope for one in sensitivities(self).slopes}


def require(mode: "Mode") -> "Mode":
    """Return the mode if it is resolved, else raise NotResolved."""
    if not is_resolved(mode.status):
        raise NotResolved(f"{mode.flow}, k={mode.k:g}: {mode.status}; raise max_degree or loosen the tolerance")
    return mode
