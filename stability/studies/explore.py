"""A window in which parameters are moved: growth rate and phase speed over k, the spectrum and a mode at a click.

While a slider moves, as many wavenumbers are followed as fit into the time of a frame; once it rests all of them, with
error bars, the fastest growing wavenumber and the long-wave limit. Everything is matplotlib: the window of a desktop,
a notebook (ipympl) or a browser (WebAgg).
"""

from collections.abc import Iterator
from dataclasses import fields, replace
from math import inf, isfinite, isinf, log10
from time import perf_counter
from typing import Any

import numpy as np

from ..errors import ParameterError, StabilityError
from ..flows.base import check_flow, span_of
from ..flows.rules import numeric
from ..modes.crests import crest_mode
from ..modes.eigenfunction import Eigenfunction
from ..output.panels import GROWTH_RATE, PHASE_SPEED, WAVENUMBER
from ..output.plots import draw
from ..output.style import BLUE, GREY, RED, STYLE
from ..output.symbols import symbol_of
from .dispersion import DispersionRelation, dispersion
from .kmax import Optimum, k_max
from .spectrum import Spectrum, spectrum

FRAME = 0.05  # seconds in which a move is to be answered
_FEWEST = 8  # wavenumbers that are followed at least
_REST = 250  # milliseconds without a move after which everything is computed
_MODES = 10  # of a spectrum
_NEAR = 12.0  # pixels from a mode within which a click means it
_DECADES = 1.5  # of a range from which its slider is logarithmic
_HEIGHTS = 201  # of an eigenfunction


def explore(flow: Any, k: Any = None, source: str | None = None) -> "Explorer":
    """Open the window for a flow and wavenumbers (points,), 0.01 .. 10 by default; keep what is returned.

    `source` is what the command line calls the flow. In a notebook write `%matplotlib widget` before. Raises
    ParameterError where the flow or a wavenumber is none.

    Wavenumbers are in 1/L, as on the axes.

    >>> import matplotlib
    >>> matplotlib.use("agg")  # no window: for tests
    >>> from stability import flows
    >>> window = explore(flows.Vortex(), [0.1, 1.0])
    >>> sorted(window.sliders), window.command
    (['Fr2', 'slope_deg'], 'stability dispersion vortex --k 0.1:1:2')
    """
    from ..checks import check_wavenumbers

    wavenumbers = np.geomspace(1e-2, 10, 80) if k is None else np.unique(check_wavenumbers(k))
    return Explorer(check_flow(flow), wavenumbers, source or flow.name)


class Explorer:
    """The window: `flow` is what its sliders say, `relation` what is shown, `figure` where."""

    def __init__(self, flow: Any, k: Any, source: Any) -> None:
        from matplotlib import pyplot

        self.flow, self.k, self.source = flow, k, source
        self.relation: DispersionRelation | None = None
        self.spectrum: Spectrum | None = None
        self.best: Optimum | None = None
        self.mode: Any = None
        self._count = len(k)
        names = [item.name for item in fields(flow) if numeric(item)]
        with pyplot.rc_context({**STYLE, "figure.constrained_layout.use": False}):
            self.figure = pyplot.figure(f"stability explore {source}", figsize=(9.6, 5.6 + 0.28 * len(names)))
            self._axes(len(names))
            self._artists()
            self.sliders = {name: self._slider(place, name) for place, name in enumerate(names)}
            self._buttons()
        self._timer = self.figure.canvas.new_timer(interval=_REST)
        self._timer.single_shot = True
        self._timer.add_callback(self.rest)
        self.figure.canvas.mpl_connect("button_press_event", self._clicked)
        self.figure.canvas.mpl_connect("draw_event", self._drawn)
        self._background = None
        self.rest()

    # -- the window ---------------------------------------------------------------------------------------------

    def _axes(self, sliders: Any) -> None:
        below = 0.10 + 0.28 * sliders / (5.6 + 0.28 * sliders)
        grid = self.figure.add_gridspec(2, 2, left=0.08, right=0.98, top=0.94, bottom=below + 0.06, wspace=0.22,
                                        hspace=0.42)
        self.growth, self.speed, self.modes, self.fields = (
            self.figure.add_subplot(grid[row, column]) for row, column in ((0, 0), (1, 0), (0, 1), (1, 1)))
        self.speed.sharex(self.growth)
        self._below, self._rows = below, sliders
        for axis, quantity in ((self.growth, GROWTH_RATE), (self.speed, PHASE_SPEED)):
            axis.set(xscale="log" if self.k[-1] > 10 * self.k[0] else "linear", xlabel=WAVENUMBER.label,
                     ylabel=quantity.label, xlim=(self.k[0], self.k[-1]) if len(self.k) > 1 else None)
        self.growth.axhline(0, color=GREY, linewidth=0.6)
        self.modes.set(xlabel=PHASE_SPEED.label, ylabel=GROWTH_RATE.label, title="click at a wavenumber")
        self.fields.set(xlabel="$|u|$, $|w|$", ylabel="height $z$", title="click at a mode")

    def _artists(self) -> None:
        """What moves: animated, so that a frame redraws nothing else."""
        def line(axis: Any, **options: Any) -> Any:
            return axis.plot([], [], animated=True, **{"marker": "", "linestyle": "-"} | options)[0]

        self._lines = {"growth_rate": line(self.growth, color=BLUE), "phase_speed": line(self.speed, color=BLUE)}
        self._bars = line(self.growth, color=BLUE, linewidth=4, alpha=0.3)
        self._limit = line(self.growth, color=GREY, linestyle=":", label="long waves")
        self._peak = line(self.growth, color=RED, linestyle="", marker="o", markersize=5)
        self._here = line(self.growth, color=RED, linewidth=0.8)
        self._text = self.figure.text(0.01, 0.012, "", fontsize=8, color=GREY, animated=True)

    def _slider(self, place: Any, name: Any) -> Any:
        from matplotlib.widgets import Slider

        low, high = self._span(name)
        value = getattr(self.flow, name)
        logarithmic = low > 0 and log10(high / low) > _DECADES
        height = 0.28 / self.figure.get_figheight()
        axis = self.figure.add_axes((0.16, 0.09 + height * (self._rows - 1 - place), 0.6, 0.7 * height))
        start = high if isinf(value) else value
        scale = log10 if logarithmic else float
        slider: Any = Slider(axis, symbol_of(self.flow, name), scale(low), scale(high), valinit=scale(start))
        slider.drawon = False
        slider.logarithmic = logarithmic
        for artist in (slider.poly, slider._handle, slider.valtext):
            artist.set_animated(True)
        slider.valtext.set_text(f"{value:.5g}")
        (item,) = (item for item in fields(self.flow) if item.name == name)
        end = inf if item.metadata["unbounded"] else high

        def value_at(position: Any) -> Any:
            return end if position >= slider.valmax else min(10**position, high) if logarithmic else position

        slider.on_changed(lambda position: self.moved(name, value_at(position)))
        return slider

    def _span(self, name: Any) -> Any:
        """The range of a slider: what is searched of the parameter, and the value that it has."""
        low, high = span_of(self.flow, name)
        value = getattr(self.flow, name)
        return (min(low, value), max(high, value)) if isfinite(value) else (low, high)

    def _buttons(self) -> None:
        from matplotlib.widgets import Button

        def button(place: Any, text: Any, action: Any) -> Any:
            made = Button(self.figure.add_axes((0.84, 0.09 + 0.055 * place, 0.14, 0.045)), text)
            made.label.set_fontsize(8)
            made.on_clicked(lambda event: action())
            return made

        self.buttons = [button(1, "copy as command", self.copy), button(0, "save figure", self.save)]

    # -- what happens -------------------------------------------------------------------------------------------

    def moved(self, name: Any, value: Any) -> None:
        """A parameter has a new value: answer within a frame, and in full once nothing moves any more."""
        began = perf_counter()
        try:
            self.flow = replace(self.flow, **{name: value})
        except ParameterError as reason:
            self._say(str(reason))
            return
        self.sliders[name].valtext.set_text(f"{value:.5g}")
        places = np.unique(np.linspace(0, len(self.k) - 1, self._count).round().astype(int))
        self._follow(self.k[places])
        self.best = None
        for line in (self._peak, self._bars, self._limit):
            line.set_data([], [])
        self._refresh()
        spent = perf_counter() - began
        self._count = int(np.clip(self._count * min(FRAME / spent, 1.5), min(_FEWEST, len(self.k)), len(self.k)))
        self._timer.stop()
        self._timer.start()

    def rest(self) -> None:
        """Everything at the parameters that the sliders show."""
        self._timer.stop()
        self._follow(self.k)
        try:
            self.best = k_max(self.flow, strict=False)
        except StabilityError as reason:
            self._say(str(reason))
        self._mark()
        self._rescale()
        self.figure.canvas.draw_idle()

    def _follow(self, k: Any) -> None:
        """Follow the mode over wavenumbers; what is lost is left out, and said."""
        try:
            self.relation = dispersion(self.flow, k, strict=False, rivals=True)
        except StabilityError as reason:
            self.relation = None
            self._say(str(reason))
            return
        modes = self.relation.modes
        self._say(f"{len(self.relation.lost)} wavenumbers lost: {next(iter(self.relation.lost.values()))}"
                  if self.relation.lost else "; ".join(self.relation.notes()))
        for name, line in self._lines.items():
            line.set_data([mode.k for mode in modes], [getattr(mode, name) for mode in modes])

    def _mark(self) -> None:
        """Error bars, the fastest growing wavenumber and the long-wave limit."""
        if self.relation is not None:
            modes = self.relation.modes
            ends = [(mode.growth_rate - mode.error, mode.growth_rate + mode.error, np.nan) for mode in modes]
            self._bars.set_data(np.repeat([mode.k for mode in modes], 3), np.ravel(ends))
        peaks = self.best.maxima if self.best else ()
        self._peak.set_data([peak.k for peak in peaks], [peak.growth_rate for peak in peaks])
        if crest_mode(self.flow) == "surface":
            self._limit.set_data(self.k, np.real(self.flow.long_wave(self.k)))

    def _rescale(self) -> None:
        """Limits that show the curves: of the growth rate from the decay that matters."""
        for name, axis in (("growth_rate", self.growth), ("phase_speed", self.speed)):
            values = np.asarray(self._lines[name].get_ydata(), dtype=float)
            values = values[np.isfinite(values)]
            if not len(values):
                continue
            low, high = float(values.min()), float(values.max())
            low = max(low, -2 * high) if name == "growth_rate" and high > 0 else low
            room = 0.08 * (high - low or abs(high) or 1.0)
            axis.set_ylim(low - room, high + room)

    def _clicked(self, event: Any) -> None:
        if event.inaxes in (self.growth, self.speed) and event.xdata and event.xdata > 0:
            self.show_spectrum(float(event.xdata))
        elif event.inaxes is self.modes and self.spectrum is not None and self.spectrum.modes:
            at = self.modes.transData.transform([(mode.phase_speed, mode.growth_rate) for mode in self.spectrum.modes])
            away = np.hypot(*(at - (event.x, event.y)).T)
            if away.min() < _NEAR:
                self.show_mode(self.spectrum.modes[int(away.argmin())])

    def show_spectrum(self, k: Any) -> None:
        """The modes at one wavenumber."""
        try:
            self.spectrum = spectrum(self.flow, k, _MODES, strict=False)
        except StabilityError as reason:
            self._say(str(reason))
            return
        self._here.set_data([k, k], self.growth.get_ylim())
        self.modes.clear()
        self.modes.axhline(0, color=GREY, linewidth=0.6)
        modes = self.spectrum.modes
        self.modes.plot([mode.phase_speed for mode in modes], [mode.growth_rate for mode in modes], color=BLUE,
                        marker="o", markersize=4, linestyle="")
        self.modes.set(xlabel=PHASE_SPEED.label, ylabel=GROWTH_RATE.label, title=f"modes at $k$ = {k:.4g}")
        self.figure.canvas.draw_idle()

    def show_mode(self, mode: Any) -> None:
        """The velocities of a mode over the height."""
        self.mode = mode
        self.fields.clear()
        for layer, shape in enumerate(Eigenfunction(mode).profiles(_HEIGHTS)):
            for values, name, colour in ((shape.u, "$|u|$", BLUE), (shape.w, "$|w|$", RED)):
                self.fields.plot(np.abs(values), shape.z, color=colour, label=None if layer else name)
        self.fields.legend()
        self.fields.set(xlabel="$|u|$, $|w|$", ylabel="height $z$",
                        title=f"$c$ = {mode.c.real:.5g} {mode.c.imag:+.4g}i")
        self.figure.canvas.draw_idle()

    @property
    def command(self) -> Any:
        """The command that prints what is shown."""
        given = [f"--{item.name.replace('_', '-')} {getattr(self.flow, item.name)}" for item in fields(self.flow)
                 if getattr(self.flow, item.name) != item.default]
        return " ".join(["stability dispersion", self.source, *given, f"--k {_spec_of(self.k)}"])

    def copy(self) -> Any:
        """Put the command on the clipboard of the desktop where there is one, and into the window and the terminal."""
        window: Any = getattr(self.figure.canvas.manager, "window", None)
        if hasattr(window, "clipboard_append"):  # Tk
            window.clipboard_clear()
            window.clipboard_append(self.command)
        self._say(self.command)
        self.figure.canvas.draw_idle()
        return self.command

    def save(self) -> Any:
        """Write the dispersion relation, as `stability dispersion --plot` draws it, to a new file here; its name."""
        from pathlib import Path

        if not isinstance(self.relation, DispersionRelation):
            return None
        number = next(n for n in range(1, 10_000) if not Path(f"{self.flow.name}-{n}.pdf").exists())
        path = f"{self.flow.name}-{number}.pdf"
        draw(self.relation, path)
        self._say(f"written: {path}")
        self.figure.canvas.draw_idle()
        return path

    # -- drawing ------------------------------------------------------------------------------------------------

    def _say(self, text: Any) -> None:
        self._text.set_text(text if len(text) < 160 else f"{text[:157]}...")

    def _moving(self) -> Iterator[Any]:
        yield from (*self._lines.values(), self._bars, self._limit, self._peak, self._here, self._text)
        for slider in self.sliders.values():
            yield from (slider.poly, slider._handle, slider.valtext)

    def _drawn(self, event: Any) -> None:
        """All that rests has been drawn: keep it, and lay over it what moves."""
        canvas: Any = self.figure.canvas
        if not hasattr(canvas, "copy_from_bbox"):
            return
        self._background = canvas.copy_from_bbox(self.figure.bbox)
        self._lay()

    def _lay(self) -> None:
        for artist in self._moving():
            self.figure.draw_artist(artist)

    def _refresh(self) -> None:
        """A frame: what rests comes from memory."""
        canvas: Any = self.figure.canvas
        if self._background is None:
            canvas.draw_idle()
            return
        canvas.restore_region(self._background)
        self._lay()
        canvas.blit(self.figure.bbox)
        canvas.flush_events()


def _spec_of(k: Any) -> Any:
    """Wavenumbers (points,) as the command line takes them: a range where they are evenly spaced, or else a list."""
    for steps, spacing in ((np.diff(np.log(k)), ""), (np.diff(k), ":lin")):
        if len(k) > 1 and np.allclose(steps, steps[0]):
            return f"{k[0]:g}:{k[-1]:g}:{len(k)}{spacing}"
    return ",".join(f"{value:.17g}" if float(f"{value:g}") != value else f"{value:g}" for value in k)
