"""Figures of results, drawn without a display and ready for print."""

from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from .eigenfunction import Eigenfunction
from .errors import ParameterError
from .mode import Mode
from .neutral import NeutralCurve, NeutralPoint, NeutralSweep
from .optimum import Optima, Optimum
from .relation import DispersionRelation
from .sensitivity import Sensitivities
from .spectra import Spectra, Spectrum

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STYLE: dict[Any, Any] = {
    "figure.constrained_layout.use": True,
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "savefig.dpi": 200,
    "svg.hashsalt": "stability",
}
_FAINT = 1e-3  # of the largest sensitivity to the base flow: less is not drawn
BLUE, RED, GREY = "#0b4f8a", "#c0392b", "#7f7f7f"

DISPERSION = {"growth_rate": r"growth rate $\sigma_r$", "phase_speed": r"phase speed $c_r$"}  # axis labels
SWEEP = {"value": "at zero growth", "k": "wavenumber $k$ (0: long waves)"}
OPTIMA = {"k_max": "$k_{max}$", "growth_rate": r"growth rate at $k_{max}$"}
NEUTRAL = {"value": "at zero growth", "phase_speed": "phase speed $c_r$"}


def draw(result, path):
    """Draw the Record of a verb into the file `path`."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE):
        layout: Any = "none" if _plain(result) else "constrained"
        figure = Figure(figsize=(6.4, 2.8), layout=layout)
        if _plain(result):
            figure.subplots_adjust(left=0.14, right=0.98, bottom=0.18, top=0.86, wspace=0.45)
        if hasattr(result, "axes"):
            from .mapplots import draw_map

            draw_map(result, figure)
        else:
            _draw_panels(result, figure)
        figure.suptitle(_caption(result), fontsize=8, color=GREY)
        figure.savefig(path)


def _draw_panels(result, figure):
    if isinstance(result, (Spectrum, Spectra, Sensitivities, NeutralPoint)) or hasattr(result, "measurements"):
        axis = figure.subplots()
    else:
        axes = figure.subplots(1, 2)
    if isinstance(result, DispersionRelation):
        _both(dispersion, result, axes, DISPERSION)
    elif isinstance(result, NeutralCurve):
        _both(neutral_curve, result, axes, NEUTRAL)
    elif isinstance(result, NeutralSweep):
        _both(neutral_sweep, result, axes, SWEEP)
    elif isinstance(result, (Spectrum, Spectra)):
        spectra(getattr(result, "spectra", [result]), axis)
    elif isinstance(result, NeutralPoint):
        neutral_point(result, axis)
    elif isinstance(result, Sensitivities):
        sensitivities(result, axis)
    elif hasattr(result, "measurements"):
        _comparison(result, axis)
    elif isinstance(result, Optima):
        _both(optima, result, axes, OPTIMA)
    else:
        _well_posedness(result.layers, result.growth, *axes)


def axes_or_new(axes: "Axes | None") -> "Axes":
    """Return the axes given, or those of a new figure of pyplot."""
    if axes is not None:
        return axes
    from matplotlib import pyplot

    with pyplot.rc_context(STYLE):
        return pyplot.subplots(figsize=(4.2, 3.0))[1]


def _both(panel, result, axes, quantities):
    for axis, quantity in zip(axes, quantities, strict=True):
        panel(result, axis, quantity)


def _plain(result):
    """Two plain panels need no layout engine, which would take half the time of the drawing."""
    return isinstance(result, (DispersionRelation, Optima))


def _caption(result):
    if isinstance(result, DispersionRelation):
        return f"{result.flow}, {result.mode} mode"
    if hasattr(result, "axes"):
        return result.title
    if isinstance(result, Sensitivities) or hasattr(result, "measurements"):
        return f"{result.flow}, k = {result.k:g}"
    text = str(result.flow)
    for name in filter(None, result.swept):
        text = text.replace(f"{name}={getattr(result.flow, name)}", f"{name} varies")
    return text


def _label(labels, quantity):
    if quantity not in labels:
        raise ParameterError(f"quantity must be one of {', '.join(labels)} (got {quantity!r})")
    return labels[quantity]


def dispersion(relation: DispersionRelation, axis: "Axes", quantity: str) -> "Axes":
    """Growth rate or phase speed against k."""
    label = _label(DISPERSION, quantity)
    order = np.argsort(relation.k)
    k = relation.k[order]
    axis.axhline(0, color=GREY, linewidth=0.6)
    axis.plot(k, getattr(relation, quantity)[order], color=BLUE, marker="o" if len(k) == 1 else "")
    axis.set(xlabel="wavenumber $k$", ylabel=label, xscale="log" if _spans_decades(k) else "linear")
    return axis


def spectra(found: Sequence[Spectrum], axis: "Axes") -> "Axes":
    """Growth rates against phase speeds, a colour for each spectrum."""
    for one in found:
        axis.plot(one.phase_speed, one.growth_rate, "o", markersize=4, label=f"$k$ = {one.k:g}")
    axis.axhline(0, color=GREY, linewidth=0.6)
    axis.set(xlabel=r"phase speed $c_r$", ylabel=r"growth rate $\sigma_r$")
    axis.legend()
    return axis


def maxima(optimum: Optimum, axis: "Axes") -> "Axes":
    """The maxima at (k, growth rate), with error bars in k."""
    for one, color in zip(optimum.maxima, (BLUE, *[RED] * len(optimum.maxima)), strict=False):
        axis.errorbar(one.k, one.growth_rate, xerr=one.error, fmt="o", color=color, markersize=4)
    axis.set(xlabel="wavenumber $k$", ylabel=r"growth rate $\sigma_r$")
    return axis


def optima(found: Optima, axis: "Axes", quantity: str) -> "Axes":
    """k_max or its growth rate against the swept parameter, other local maxima as dots."""
    label = _label(OPTIMA, quantity)
    name, field = found.over, "k" if quantity == "k_max" else quantity
    x = [getattr(optimum.flow, name) if name else 0.0 for optimum in found.optima]
    pairs = list(zip(x, found.optima, strict=True))
    others = [(value, getattr(one, field)) for value, optimum in pairs for one in optimum.maxima[1:]]
    _against(axis, name, others, color=RED, linestyle="", label="other local maxima")
    best = [(value, getattr(optimum.maxima[0], field)) for value, optimum in pairs if optimum.maxima]
    _against(axis, name, best, color=BLUE)
    scale = _scale(x)
    axis.set(xlabel=f"${name}$" if name and len(name) < 3 else name or "", ylabel=label, xscale=scale,
             yscale="log" if best and scale == "log" else "linear")
    return axis


def _against(axis, name, pairs, **style):
    """A line with dots through (value of the swept parameter, y); y at infinity is a level."""
    finite = [pair for pair in pairs if isfinite(pair[0])]
    if finite:
        axis.plot(*zip(*finite, strict=True), **{"marker": ".", "markersize": 4, **style})
    for value, y in pairs:
        if not isfinite(value):
            axis.axhline(y, color=style["color"], linestyle="--", linewidth=0.8, label=f"{name} = inf")
    if axis.get_legend_handles_labels()[0]:
        axis.legend()


def _scale(values):
    finite = [value for value in values if isfinite(value)]
    return "log" if len(finite) > 1 and min(finite) > 0 and _spans_decades(finite) else "linear"


def mode(one: Mode, axis: "Axes") -> "Axes":
    """|u| and |w| against z, layer by layer."""
    for index, part in enumerate(Eigenfunction(one).profiles()):
        for name, values, color in (("$|u|$", part.u, BLUE), ("$|w|$", part.w, RED)):
            axis.plot(np.abs(values), part.z, color=color, label=None if index else name)
    axis.set(xlabel=f"velocity at $k$ = {one.k:g}", ylabel="height $z$", xlim=(0, None))
    axis.legend()
    return axis


def base_flow_sensitivity(one: Mode, axis: "Axes") -> "Axes":
    """Real and imaginary part of d sigma / d U(z) against z, where they matter."""
    for index, part in enumerate(Eigenfunction(one).profiles()):
        S = one.base_flow_sensitivity(part.z)
        matters = np.abs(S) > _FAINT * np.abs(S).max()
        z, S = part.z[matters], S[matters]
        for name, values, color in (("growth rate", S.real, BLUE), ("frequency", S.imag, RED)):
            axis.plot(values, z, color=color, label=None if index else name)
    axis.axvline(0, color=GREY, linewidth=0.6)
    axis.set(xlabel=rf"$\delta\sigma/\delta U(z)$ at $k$ = {one.k:g}", ylabel="height $z$")
    axis.legend()
    return axis


def sensitivities(found: Sensitivities, axis: "Axes") -> "Axes":
    """Relative changes of the growth rate per relative change of every parameter, as bars."""
    rows = [row for row in found.rows() if row["elasticity"] is not None]
    axis.barh([row["parameter"] for row in rows], [row["elasticity"] for row in rows], color=BLUE)
    axis.axvline(0, color=GREY, linewidth=0.6)
    axis.invert_yaxis()
    axis.set(xlabel="elasticity of the growth rate")
    return axis


def _well_posedness(found, growth, left, right):
    """C through the layers, ill-posed strips shaded; largest growth rate against k by degree."""
    for name in dict.fromkeys(found.layer):
        rows = np.array([layer == name for layer in found.layer])
        left.plot(found.C[rows], found.height[rows], color=BLUE)
    for strip in found.strips:
        left.axhspan(strip.low, strip.high, color=RED, alpha=0.15, linewidth=0)
    left.axvline(0, color=GREY, linewidth=0.6)
    left.set(xlabel="$C$, ill posed where $C > 0$", ylabel="height in the layer")
    k = [one.k for one in growth]
    rates = np.array([one.rates for one in growth])
    scale = {"value": "symlog", "linthresh": 1e-2}
    for column, degree in enumerate(growth[0].degrees):
        shade = 0.25 + 0.75 * column / (len(growth[0].degrees) - 1)
        right.plot(k, rates[:, column], color=RED, alpha=shade, label=f"degree {degree}")
    surface = [(one.k, one.surface) for one in growth if one.surface is not None]
    if surface:
        right.plot(*zip(*surface, strict=True), color=BLUE, linestyle="--", label="surface mode")
    right.axhline(0, color=GREY, linewidth=0.6)
    right.set_xscale("log")
    right.set_yscale(**scale)
    right.set(xlabel="wavenumber $k$", ylabel=r"largest growth rate $\sigma_r$")
    right.legend(fontsize=7)


def _comparison(found, axis):
    """Relative error against time, a curve for each method; dashed what it reports."""
    scale = abs(found.reference.sigma)
    floor = np.finfo(float).eps / 2  # errors below are drawn there
    colors = {"collocation": BLUE, "bvp": RED, "bvp-thesis": "#d98200", "dense": GREY}
    for method, color in colors.items():
        rows = [one for one in found.measurements if one.method == method]
        seconds = [one.seconds for one in rows]
        if rows:
            error = np.maximum([one.error / scale for one in rows], floor)
            axis.loglog(seconds, error, ".-", color=color, label=method)
        if rows and rows[0].reported is not None:
            reported = np.maximum([one.reported / scale for one in rows], floor)
            axis.loglog(seconds, reported, "--", color=color, linewidth=0.8)
    axis.set(xlabel="CPU seconds per eigenvalue", ylabel="relative error (dashed: reported)")
    axis.legend()


def _spans_decades(values):
    return len(values) > 0 and max(values) > 20 * min(values)


def neutral_curve(curve: NeutralCurve, axis: "Axes", quantity: str) -> "Axes":
    """The parameter at zero growth or the phase speed there against k."""
    label = _label(NEUTRAL, quantity)
    known = [(point.k, getattr(point, quantity)) for point in curve.points if point.value is not None]
    k, value = curve.trace.T
    if quantity == "value":
        axis.plot(k, value, color=BLUE)
        axis.set_yscale("log" if _spans_decades(value) else "linear")
        label = f"{curve.vary} {label}"
    axis.plot(*np.array(known, dtype=float).reshape(-1, 2).T, ".", color=BLUE, markersize=5)
    axis.set(xlabel="wavenumber $k$", ylabel=label, xscale="log" if _spans_decades(k) else "linear")
    return axis


def neutral_point(point: NeutralPoint, axis: "Axes") -> "Axes":
    """The point at (k, value), as in the figure of a curve, with error bars."""
    if point.k is not None and point.value is not None:
        if not axis.has_data():  # error bars are no scale for a point alone
            axis.set(xlim=(0, 2 * point.k or 1), ylim=sorted((0, 2 * point.value or 1)))
        axis.errorbar(point.k, point.value, xerr=point.k_error, yerr=point.error, fmt="o", color=RED, markersize=5)
    axis.set(xlabel="wavenumber $k$", ylabel=f"{point.vary} {NEUTRAL['value']}")
    return axis


def neutral_sweep(found: NeutralSweep, axis: "Axes", quantity: str) -> "Axes":
    """The parameter at zero growth or the wavenumber there against the swept parameter."""
    label, name = _label(SWEEP, quantity), found.over
    x = [getattr(point.flow, name) for point in found.points]
    known = [(value, getattr(point, quantity)) for value, point in zip(x, found.points, strict=True)
             if point.value is not None]
    _against(axis, name, known, color=BLUE)
    axis.set(xlabel=name, ylabel=f"{found.vary} {label}" if quantity == "value" else label, xscale=_scale(x))
    return axis
