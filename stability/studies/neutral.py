"""Neutral curves: the values of one parameter at which a mode is neutral, at given wavenumbers (`studies.crossings`).

The line through them is followed by arclength through the plane of k and the parameter (`studies.contour`).
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import check_wavenumbers
from ..flows.base import check_flow
from ..modes.accuracy import DEGREES, TOLERANCE, check_accuracy
from ..numerics.threads import one_thread
from ..output.panels import DOTS, PHASE_SPEED, POINTS, WAVENUMBER, Curve, Panel, scale_found, scale_of
from ..output.text import Row
from ..status import is_resolved, unresolved
from .contour import Line, lines_through
from .critical import NeutralPoint, ZeroGrowth, landscape_of, no_point, point_of, settings_of, value_axis
from .crossings import zeros_at

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..flows import Flow
    from .ridges import Landscape


@dataclass(frozen=True, repr=False)
class NeutralCurve(ZeroGrowth):
    """Neutral points at the wavenumbers asked for, by increasing value at each, and the `trace` (points, 2)
    of (k, value) along the whole curve from one end to the other.

    `flow` and `vary` are what was asked for, `points` (points,) are `NeutralPoint` records, `settings` range and
    tolerance. Values have the units of the parameter, k is in 1/L. Writing raises ParameterError where a file cannot be
    written.

    >>> from stability import flows, neutral_curve
    >>> curve = neutral_curve(flows.Poiseuille(), "Re", [1.0])
    >>> [f"{point.value:.4f}" for point in curve.points]
    ['5814.8288', '31956.4510']
    >>> curve.trace.shape[1]
    2
    """

    flow: Any
    vary: str
    points: tuple[NeutralPoint, ...]
    trace: np.ndarray = field(compare=False)
    settings: Mapping[str, Any] = field(default_factory=dict, compare=False)
    dimension: ClassVar[str] = "point"

    def panels(self) -> tuple[Panel, ...]:
        """The value and the phase speed on the neutral curve against k."""
        known = [point for point in self.points if point.value is not None]
        status = tuple(point.status for point in known)
        x = replace(WAVENUMBER, scale=scale_of([point.k for point in self.points]))
        k, value, error, speed = (np.array([getattr(point, name) for point in known], dtype=float)
                                  for name in ("k", "value", "error", "phase_speed"))
        curve = Curve(*self.trace.T), Curve(k, value, None, DOTS, None, error, 0, status)
        return (Panel(x, replace(value_axis(self), scale=scale_found(self.trace[:, 1])), curve),
                Panel(x, PHASE_SPEED, (Curve(k, speed, None, POINTS, status=status),)))

    def rows(self) -> list[Row]:
        return [point.row() for point in self.points]


def neutral_curve(flow: "Flow", vary: str, k: "ArrayLike", *, span: tuple[float, float] | None = None,
                  tolerance: float = TOLERANCE, max_degree: int = DEGREES[-1]) -> NeutralCurve:
    """Return the `NeutralCurve` of a flow: at each wavenumber of k, all values of `vary` in the `span` at which a mode
    is neutral.

    A wavenumber without such a value keeps one point without numbers, whose status says so. What is found at one does
    not depend on the others.

    `k` (points,) is in 1/L, values and `span` have the units of the parameter. Raises ParameterError for what is no
    flow, parameter, wavenumber or range.

    >>> from stability import flows
    >>> curve = neutral_curve(flows.Poiseuille(), "Re", [1.02054744928533], span=(5700.0, 5900.0))
    >>> f"{curve.points[0].value:.4f}"  # the nose of the curve: Orszag (1971) has 5772.22
    '5772.2218'
    """
    return joined_curve(list(neutral_parts(flow, vary, k, span=span, tolerance=tolerance, max_degree=max_degree)))


def neutral_parts(flow: "Flow", vary: str, k: "ArrayLike", *, span: tuple[float, float] | None = None,
                  tolerance: float = TOLERANCE, max_degree: int = DEGREES[-1]) -> Iterator[NeutralCurve]:
    """Yield the curve of `neutral_curve` with the points of one wavenumber at a time: `joined` puts them together."""
    wavenumbers = check_wavenumbers(k)
    land = landscape_of(check_flow(flow), vary, span, None, check_accuracy(tolerance, max_degree))
    settings = {name: value for name, value in settings_of(land).items() if name != "search"}
    drawn: list[Line] = []
    for wavenumber in wavenumbers.tolist():
        points, lines = one_thread(_at_wavenumber)(land, wavenumber, settings, drawn, wavenumbers.min(),
                                                   wavenumbers.max())
        drawn += lines
        trace = np.concatenate((np.empty((0, 2)), *(line.trace for line in lines)))
        yield NeutralCurve(flow, vary, points, trace, settings)


def joined_curve(parts: list[NeutralCurve]) -> NeutralCurve:
    """Return the parts as one curve."""
    return replace(parts[0], points=tuple(point for part in parts for point in part.points),
                   trace=np.concatenate([part.trace for part in parts]))


def _at_wavenumber(land: "Landscape", k: float, settings: dict[str, Any], drawn: list[Line], low: float,
                   high: float) -> tuple[tuple[NeutralPoint, ...], list[Line]]:
    """The neutral points at one wavenumber, and the curves through those that lie on none that is drawn yet."""
    zeros, trouble, grows = zeros_at(land, k)
    points = [point_of(land, zero, settings) for zero in zeros]
    if trouble:
        value, reason = next(iter(trouble.items()))
        doubt = f"others may be missing: at {land.vary} = {value:.4g}, {reason}"
        points = [replace(point, status=unresolved(doubt)) if is_resolved(point.status) else point for point in points]
    if not points:
        kind = "a mode grows" if grows == {True} else "all modes decay"
        why = f"the neutral curve does not reach k = {k:g}: {kind} at every {land.vary} from {land.span[0]:g} to " \
              f"{land.span[1]:g}"
        points = [no_point(land.flow, land.vary, k, doubt if trouble else why)]
    return tuple(points), lines_through(land, zeros, drawn, low, high)
