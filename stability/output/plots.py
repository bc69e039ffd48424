"""The renderer: panels become figures, without a display and ready for print. It knows no result by name.

Colours and line styles are given out by matplotlib's cycle of the axes, so that successive results on the same axes
differ, in grey print too, and so that a style sheet may say otherwise. Text stays text in PDF (Type 42) and SVG.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..status import is_outgrown, is_settled
from .look import Look
from .mapplots import draw_grid, legend_of
from .panels import BARS, DOTS, LEVEL, LINE, MARKED, OTHERS, POINTS, THIN, Grid, Panel, labelled, named
from .style import COLOURS, FONTS, GREY, MARKERS, RED, STYLE

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .panels import Curve

_SIZE = 6.4, 2.8  # inches, unless a Look says otherwise
_NARROW, _SMALL = 5.0, 7  # inches of width below which the font has this size
_ASIDE = 1.2  # ratio of width and height from which panels stand side by side
_SEEN = 2e-3  # of the range of a curve: smaller error bars would not be seen
_MARKED_MOST = 25  # doubtful points of a curve that are marked, at most
_ROW = 4  # entries in a line of the legend below a figure
_HOLLOW = {"linestyle": "", "marker": "o", "markersize": 4, "markerfacecolor": "none"}
_SHAPES: dict[str, dict[str, Any]] = {
    LINE: {"marker": ""}, MARKED: {"marker": ".", "markersize": 4}, POINTS: {"linestyle": "", "markersize": 4},
    OTHERS: _HOLLOW, DOTS: {"linestyle": "", "marker": ".", "markersize": 5},
    THIN: {"marker": "", "linestyle": "--", "linewidth": 0.8},
}
_DOUBTS = ((lambda status: not is_settled(status), "x", "not resolved"),
           (is_outgrown, "+", "outgrown by an internal mode"))


def draw(record: Any, path: Any, look: Look | None = None) -> list[str]:
    """Draw the panels of a Record into the file `path`; return what there is to say of it, a sentence each."""
    import matplotlib
    from matplotlib.figure import Figure

    look = look or Look()
    panels, size = look.chosen(record.panels()), look.size or _SIZE
    with matplotlib.rc_context({**STYLE, **({"font.size": _SMALL} if size[0] < _NARROW else {})}):
        matplotlib.rcParams.update(dict[Any, Any](look.style) | FONTS)
        figure = Figure(figsize=size, layout="constrained")
        shape = (1, len(panels)) if size[0] >= _ASIDE * size[1] else (len(panels), 1)
        axes = figure.subplots(*shape, squeeze=False).ravel().tolist()
        for axis, panel in zip(axes, panels, strict=True):
            draw_one(axis, panel)
            for curve in look.overlaid(panel):
                _curve(axis, curve, None, {})
        notes = look.rescale(axes, panels)
        _legends(figure, axes, panels)
        small = matplotlib.rcParams["font.size"] - 1
        title = {"fontsize": small, "color": GREY} if look.title is None else {"fontsize": small + 1}
        figure.suptitle(record.title if look.title is None else look.title, **title, wrap=True)
        figure.savefig(path)
    return notes


def plot(panels: Sequence[Any], ax: "Axes | None", quantity: str | None = None, label: str | None = None,
         **line_options: Any) -> "Axes":
    """Draw one of the panels into the matplotlib Axes `ax`, or into new ones; return them."""
    axis, panel = axes_or_new(ax), named(panels, quantity)
    draw_one(axis, panel if isinstance(panel, Grid) else labelled(panel, label), line_options)
    if axis.get_legend_handles_labels()[1]:
        axis.legend()
    return axis


def axes_or_new(axes: "Axes | None") -> "Axes":
    """Return the axes given, or those of a new figure of pyplot."""
    if axes is not None:
        return axes
    from matplotlib import pyplot

    with pyplot.rc_context(STYLE):
        return pyplot.subplots(figsize=(4.2, 3.0))[1]


def draw_one(axis: "Axes", panel: Any, line_options: Any = None) -> None:
    """Draw a Panel or a Grid into axes, without its legend."""
    if isinstance(panel, Grid):

        draw_grid(axis, panel, line_options or {})
    else:
        _panel(axis, panel, line_options or {})


def _panel(axis: Any, panel: Panel, line_options: dict[Any, Any]) -> None:
    fresh = not axis.has_data()
    if panel.zero and not any(line.get_label() == "_zero" for line in axis.lines):
        line = axis.axhline if panel.zero == "y" else axis.axvline
        line(0, color=GREY, linewidth=0.6, label="_zero")
    for band in panel.bands:
        span = axis.axhspan if band.axis == "y" else axis.axvspan
        span(band.low, band.high, color=RED, alpha=0.15, linewidth=0)
    colours: list[Any] = []
    for curve in panel.curves:
        colour = None if curve.of is None else colours[curve.of]
        colours.append(_curve(axis, curve, colour, line_options if curve.of is None else {}))
    axis.set(xlabel=panel.x.label, ylabel=panel.y.label)
    if fresh:
        for which, scale in (("x", panel.x.scale), ("y", panel.y.scale)):
            set_scale(axis, which, scale)
        axis.set(**panel.limits)


def set_scale(axis: Any, which: str, scale: str) -> None:
    """Set the scale of an axis; symmetric logarithms are linear next to zero."""
    if scale != "linear":
        getattr(axis, f"set_{which}scale")(scale, **({"linthresh": 1e-2} if scale == "symlog" else {}))


def _curve(axis: Any, curve: Any, colour: Any, line_options: Any) -> Any:
    """Draw a curve in a colour, or in the next one of the axes; return its colour."""
    if curve.kind == BARS:
        return axis.barh(curve.y, curve.x, **{"color": COLOURS[0], "label": curve.label, **line_options})[0]
    if curve.kind == LEVEL:
        for y in curve.y:
            axis.axhline(y, color=colour, linestyle="--", linewidth=0.8, label=curve.label)
        return colour
    style: dict[str, Any] = {"label": curve.label, **_SHAPES[curve.kind]}
    if curve.fade < 1:
        style["alpha"] = curve.fade
    if curve.kind == POINTS:  # a marker of its own among the points that are there
        style["marker"] = MARKERS[sum(line.get_marker() in MARKERS for line in axis.lines) % len(MARKERS)]
    if colour is not None:
        style = {"linestyle": "-", "marker": "", **style, "color": colour}
    (line,) = axis.plot(curve.x, curve.y, **{**style, **line_options})
    _bars(axis, curve, line.get_color())
    if curve.status is not None:
        _doubts(axis, curve, line.get_color())
    return line.get_color()


def _bars(axis: Any, curve: "Curve", colour: str) -> None:
    """Error bars that are long enough to be seen."""
    errors = {}
    for name, values, bars in (("xerr", curve.x, curve.x_error), ("yerr", curve.y, curve.y_error)):
        if bars is not None and len(values):
            known = values[np.isfinite(values)]
            extent = (np.ptp(known) or np.abs(known).max()) if len(known) else 0.0
            if 0 < _SEEN * extent < np.nanmax(bars, initial=0.0):
                errors[name] = bars
    if errors:  # all that the cycle of the axes would give is given, or it would move on
        axis.errorbar(curve.x, curve.y, fmt="none", ecolor=colour, elinewidth=0.8, capsize=1.5, color=colour,
                      linestyle="", marker="", **errors)


def _doubts(axis: Any, curve: Any, colour: Any) -> None:
    for test, marker, label in _DOUBTS:
        where = np.array([test(status) for status in curve.status], dtype=bool)
        if where.any():
            told = label in axis.get_legend_handles_labels()[1]
            every = max(1, int(where.sum()) // _MARKED_MOST)
            axis.plot(curve.x[where], curve.y[where], linestyle="", marker=marker, markersize=5, color=colour,
                      markevery=every, label=None if told else label)


def _legends(figure: Any, axes: list[Any], panels: list[Any]) -> None:
    """One legend below the figure where all panels have the same, and one in each otherwise."""
    found = [axis.get_legend_handles_labels() for axis in axes]
    grids = [panel for panel in panels if isinstance(panel, Grid)]
    if grids:
        extra = legend_of(grids[0])
        handles, labels = [*found[0][0], *extra[0]], [*found[0][1], *extra[1]]
    elif len(axes) > 1 and all(labels == found[0][1] for _, labels in found) and len(found[0][1]) > 1:
        handles, labels = found[0]
    else:
        for axis, (_, labels) in zip(axes, found, strict=True):
            if labels:
                axis.legend(fontsize="small" if len(labels) > 3 else None)
        return
    if labels:
        figure.legend(handles, labels, loc="outside lower center", ncols=min(len(labels), _ROW), fontsize="small")


