"""What is to be drawn: panels of curves, as numbers and words. Results make them, `output.plots` draws them.

Nothing here knows a flow or a result, and nothing imports matplotlib.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Any

import numpy as np

from ..errors import ParameterError
from ..status import Status
from .spacing import is_logarithmic, spans_decades

LINE, MARKED, POINTS = "line", "marked", "points"  # a line, one with dots, dots alone
OTHERS, DOTS, LEVEL, THIN = "others", "dots", "level", "thin"  # what goes with a curve, in its colour
BARS = "bars"  # horizontal, `y` naming them


@dataclass(frozen=True)
class Axis:
    """One axis: the `name` that its column has in a table, its label, and its scale ("linear", "log", "symlog")."""

    name: str
    label: str
    scale: str = "linear"


@dataclass(frozen=True, eq=False)
class Curve:
    """Points (count,) that belong together; errors, where known, are half-widths of bars.

    `of` is the number of the curve in its panel whose colour this one shares, None for a colour of its own. `status`,
    where given, has a text for each point: those that are not settled, or outgrown, are marked. `fade` from 0 to 1 is
    how opaque it is.
    """

    x: np.ndarray
    y: np.ndarray
    label: str | None = None
    kind: str = LINE
    x_error: np.ndarray | None = None
    y_error: np.ndarray | None = None
    of: int | None = None
    status: tuple[Status, ...] | None = None
    fade: float = 1.0


@dataclass(frozen=True)
class Band:
    """A strip between two values of an axis ("x" or "y"), tinted."""

    low: float
    high: float
    axis: str


@dataclass(frozen=True, eq=False)
class Panel:
    """Curves in one pair of axes. `zero` names the axis ("x", "y") whose zero is drawn as a line, if any.

    `least` are the lower ends of the axes where they are known, `widest` limits in which error bars do not count.
    """

    x: Axis
    y: Axis
    curves: tuple[Curve, ...]
    zero: str = ""
    bands: tuple[Band, ...] = ()
    limits: Mapping[str, Any] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """Name of the quantity that is drawn."""
        return self.y.name


@dataclass(frozen=True, eq=False)
class Grid:
    """One quantity over one or two parameters: `axes` (outermost first) with their values (count,), `values` shaped by
    them, nan where there is none.

    `states` {why: where} marks doubtful points, `jumps` says for each axis between which sorted neighbours a branch
    ends, `second` are values of another branch; `signed` quantities have a zero of interest.
    """

    axes: tuple[tuple[Axis, np.ndarray], ...]
    quantity: Axis
    values: np.ndarray
    states: Mapping[str, np.ndarray]
    jumps: Sequence[np.ndarray] | None = None
    second: np.ndarray | None = None
    signed: bool = False

    @property
    def name(self) -> str:
        return self.quantity.name

    @property
    def x(self) -> Axis:
        return self.axes[-1][0]

    @property
    def y(self) -> Axis:
        return self.axes[0][0] if len(self.axes) > 1 else self.quantity


WAVENUMBER = Axis("k", "wavenumber $k$")
GROWTH_RATE = Axis("growth_rate", r"growth rate $\sigma_r$")
PHASE_SPEED = Axis("phase_speed", "phase speed $c_r$")
ELASTICITY, PARAMETER = Axis("elasticity", "elasticity of the growth rate"), Axis("parameter", "")
K_MAX = Axis("k_max", r"fastest growing $k_\mathrm{max}$")
GROWTH_AT_K_MAX = Axis("growth_rate", r"growth rate at $k_\mathrm{max}$")


def scale_of(values: Any) -> str:
    """The scale on which values asked for lie evenly: "log" if they span decades, unless their steps are equal."""
    known = np.array([value for value in values if isfinite(value)], dtype=float)
    logarithmic = spans_decades(known) and (len(known) < 3 or is_logarithmic(np.unique(known)))
    return "log" if logarithmic else "linear"


def scale_found(values: Any) -> str:
    """The scale of values that were not asked for but found: "log" if they span decades, however they lie."""
    return "log" if spans_decades(np.asarray(values, dtype=float)) else "linear"


def swept_curves(x: Iterable[float], y: Iterable[float], level: str, label: str | None = None, kind: str = MARKED,
                 **more: Any) -> tuple[Curve, ...]:
    """A curve over a swept parameter, and for each infinite value of it a level, labelled `level`."""
    pairs = np.array(list(zip(x, y, strict=True)), dtype=float).reshape(-1, 2)
    finite = np.isfinite(pairs[:, 0])
    chosen: dict[str, Any] = {name: part if part is None or isinstance(part, (int, str)) else _chosen(part, finite)
                              for name, part in more.items()}
    curve = Curve(pairs[finite, 0], pairs[finite, 1], label, kind, **chosen)
    return curve, *(Curve(np.array([np.inf]), np.array([one]), level, LEVEL, of=more.get("of") or 0)
                    for one in pairs[~finite, 1].tolist())


def _chosen(part: Any, where: np.ndarray) -> Any:
    kept = [one for one, take in zip(part, where.tolist(), strict=True) if take]
    return tuple(kept) if isinstance(part, tuple) else np.array(kept, dtype=float)


def merged(panels: Sequence[tuple[Panel, ...]], labels: Sequence[str]) -> tuple[Panel, ...]:
    """The panels of several results as one set, every curve labelled with its result."""
    return tuple(_merged_one(same, labels) for same in zip(*panels, strict=True))


def _merged_one(panels: Any, labels: Any) -> Any:
    curves: list[Curve] = []
    told: set[str | None] = set()
    for panel, label in zip(panels, labels, strict=True):
        first = len(curves)
        for curve in panel.curves:
            of = None if curve.of is None else curve.of + first
            if curve.of is None or curve.kind == LEVEL:
                text = f"{label}, {curve.label}" if curve.label else label
            else:
                text = None if curve.label in told else curve.label
                told.add(curve.label)
            curves.append(replace(curve, of=of, label=text))
    return replace(panels[0], curves=tuple(curves), bands=tuple(band for panel in panels for band in panel.bands),
                   x=_axis([panel.x for panel in panels]), y=_axis([panel.y for panel in panels]))


def _axis(axes: Any) -> Any:
    """The same axis of several panels, logarithmic where all of them are."""
    scales = {axis.scale for axis in axes}
    return axes[0] if len(scales) == 1 else replace(axes[0], scale="linear")


def labelled(panel: Panel, label: str | None) -> Panel:
    """A panel whose curves of their own bear a label; those that go with them none."""
    if label is None:
        return panel
    own = sum(curve.of is None for curve in panel.curves)
    curves = [replace(curve, label=None if curve.of is not None else
                      f"{label}, {curve.label}" if own > 1 and curve.label else label) for curve in panel.curves]
    return replace(panel, curves=tuple(curves))


def named(panels: Sequence[Any], quantity: str | None) -> Any:
    """The panel of a quantity, the first by default; raises ParameterError where there is none."""
    if quantity is None:
        return panels[0]
    names = [panel.name for panel in panels]
    if quantity not in names:
        raise ParameterError(f"quantity must be one of {', '.join(names)} (got {quantity!r})")
    return panels[names.index(quantity)]
