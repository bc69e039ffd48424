"""Figures of results, drawn without a display and ready for print."""

import numpy as np

from .neutral import NeutralCurve, NeutralPoint
from .relation import DispersionRelation
from .wellposed import WellPosedness

STYLE = {
    "figure.constrained_layout.use": True,
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "savefig.dpi": 200,
    "svg.hashsalt": "stability",
}
BLUE, RED, GREY = "#0b4f8a", "#c0392b", "#7f7f7f"


def draw(result, path):
    """Draw a result into the file `path`: a DispersionRelation, a list of Spectrum, a NeutralCurve, or a pair
    (name of the swept parameter, list of Optimum or NeutralPoint)."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 2.8), layout="none" if _plain(result) else "constrained")
        if _plain(result):
            figure.subplots_adjust(left=0.14, right=0.98, bottom=0.18, top=0.86, wspace=0.45)
        axes = figure.subplots(1, 2)
        if isinstance(result, DispersionRelation):
            _dispersion(result, *axes)
        elif isinstance(result, NeutralCurve):
            _neutral_curve(result, *axes)
        elif isinstance(result, list):
            _spectra(result, figure, axes)
        elif hasattr(result, "measurements"):
            _comparison(result, figure, axes)
        elif isinstance(result[0], WellPosedness):
            _well_posedness(*result, *axes)
        elif isinstance(result[1][0], NeutralPoint):
            _neutral_points(*result, *axes)
        else:
            _optima(*result, *axes)
        figure.suptitle(_caption(result), fontsize=8, color=GREY)
        figure.savefig(path)


def _plain(result):
    """Two plain panels need no layout engine, which would take half the time of the drawing."""
    return isinstance(result, DispersionRelation) or isinstance(result, tuple) and hasattr(result[1][0], "maxima")


def _caption(result):
    if isinstance(result, DispersionRelation):
        return f"{result.flow}, {result.mode} mode"
    if isinstance(result, NeutralCurve):
        return str(result.flow)
    if hasattr(result, "measurements"):
        return f"{result.flow}, k = {result.k:g}"
    if isinstance(result, list) or isinstance(result[0], WellPosedness):
        return str(result[0].flow)
    name, points = result
    first = points[0].flow
    return str(first).replace(f"{name}={getattr(first, name)}", f"{name} swept") if name else str(first)


def _dispersion(relation, left, right):
    order = np.argsort(relation.k)
    k = relation.k[order]
    marker = "o" if len(k) == 1 else ""
    for axis, values, label in ((left, relation.growth_rate, r"growth rate $\sigma_r$"),
                                (right, relation.phase_speed, r"phase speed $c_r$")):
        axis.axhline(0, color=GREY, linewidth=0.6)
        axis.plot(k, values[order], color=BLUE, marker=marker)
        axis.set(xlabel="wavenumber $k$", ylabel=label, xscale="log" if _spans_decades(k) else "linear")


def _spectra(spectra, figure, axes):
    axes[1].remove()
    axes[0].set_subplotspec(figure.add_gridspec(1, 1)[0])
    for one in spectra:
        speeds = [mode.phase_speed for mode in one.modes]
        axes[0].plot(speeds, one.sigma.real, "o", markersize=4, label=f"$k$ = {one.k:g}")
    axes[0].axhline(0, color=GREY, linewidth=0.6)
    axes[0].set(xlabel=r"phase speed $c_r$", ylabel=r"growth rate $\sigma_r$")
    axes[0].legend()


def _optima(name, optima, left, right):
    x = [getattr(optimum.flow, name) if name else 0.0 for optimum in optima]
    quantities = ((left, "$k_{max}$", lambda m: m.k), (right, r"growth rate at $k_{max}$", lambda m: m.growth_rate))
    for axis, label, get in quantities:
        others = [(value, get(m)) for value, optimum in zip(x, optima, strict=True) for m in optimum.maxima[1:]]
        if others:
            axis.plot(*zip(*others, strict=True), ".", color=RED, markersize=4, label="other local maxima")
            axis.legend()
        best = [(value, get(o.maxima[0])) for value, o in zip(x, optima, strict=True) if o.maxima]
        if best:
            axis.plot(*zip(*best, strict=True), ".-", color=BLUE, markersize=4)
        scale = "log" if len(x) > 1 and min(x) > 0 and _spans_decades(x) else "linear"
        axis.set(xlabel=f"${name}$" if name and len(name) < 3 else name or "", ylabel=label, xscale=scale,
                 yscale="log" if best and scale == "log" else "linear")


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


def _comparison(found, figure, axes):
    """Relative error against time, a curve for each method; dashed what it reports."""
    axes[1].remove()
    axes[0].set_subplotspec(figure.add_gridspec(1, 1)[0])
    scale = abs(found.reference.sigma)
    floor = np.finfo(float).eps / 2  # errors below are drawn there
    colors = {"collocation": BLUE, "bvp": RED, "bvp-thesis": "#d98200", "dense": GREY}
    for method, color in colors.items():
        rows = [one for one in found.measurements if one.method == method]
        seconds = [one.seconds for one in rows]
        if rows:
            error = np.maximum([one.error / scale for one in rows], floor)
            axes[0].loglog(seconds, error, ".-", color=color, label=method)
        if rows and rows[0].reported is not None:
            reported = np.maximum([one.reported / scale for one in rows], floor)
            axes[0].loglog(seconds, reported, "--", color=color, linewidth=0.8)
    axes[0].set(xlabel="CPU seconds per eigenvalue", ylabel="relative error (dashed: reported)")
    axes[0].legend()


def _spans_decades(values):
    return max(values) > 20 * min(values)


def _neutral_curve(curve, left, right):
    known = [point for point in curve.points if point.value is not None]
    k, value = curve.trace.T
    left.plot(k, value, color=BLUE)
    left.plot([point.k for point in known], [point.value for point in known], ".", color=BLUE, markersize=5)
    right.plot([point.k for point in known], [point.phase_speed for point in known], ".", color=BLUE, markersize=5)
    left.set(xlabel="wavenumber $k$", ylabel=f"{curve.vary} at zero growth",
             xscale="log" if _spans_decades(k) else "linear", yscale="log" if _spans_decades(value) else "linear")
    right.set(xlabel="wavenumber $k$", ylabel="phase speed $c_r$", xscale=left.get_xscale())


def _neutral_points(name, points, left, right):
    known = [point for point in points if point.value is not None]
    x = [getattr(point.flow, name) if name else 0.0 for point in known]
    scale = "log" if len(x) > 1 and min(x) > 0 and _spans_decades(x) else "linear"
    left.plot(x, [point.value for point in known], ".-", color=BLUE, markersize=4)
    right.plot(x, [point.k for point in known], ".-", color=BLUE, markersize=4)
    left.set(xlabel=name or "", ylabel=f"{points[0].vary} at zero growth", xscale=scale)
    right.set(xlabel=name or "", ylabel="wavenumber $k$ (0: long waves)", xscale=scale)
