"""How a figure is to look, apart from what it shows: size, style, title, scales, and points laid over it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..checks import as_number
from ..errors import ParameterError
from .overlay import Overlay
from .panels import Curve, Grid

_UNITS = {"in": 1.0, "mm": 1 / 25.4, "cm": 1 / 2.54}  # inches
_LEAST, _MOST = 0.5, 50.0  # inches of a side


@dataclass(frozen=True)
class Look:
    """`size` (width, height) in inches, `style` settings of matplotlib, `title` in place of the usual one, `log` the
    axes made logarithmic ("x", "y", "xy", ""), `overlays` laid over every panel that has their columns, and `only` the
    names of the panels that are drawn, all if empty."""

    size: tuple[float, float] | None = None
    style: Mapping[str, Any] = field(default_factory=dict)
    title: str | None = None
    log: str = ""
    overlays: tuple[Overlay, ...] = ()
    only: tuple[str, ...] = ()

    def chosen(self, panels: Sequence[Any]) -> list[Any]:
        """The panels to be drawn; raises ParameterError where there is no such panel or an overlay fits none."""
        names = [panel.name for panel in panels]
        for name in self.only:
            if name not in names:
                raise ParameterError(f"--panel: must be one of {', '.join(names)} (got {name!r})")
        kept = [panel for panel in panels if not self.only or panel.name in self.only]
        for one in self.overlays:
            if not any(one.fits(panel) for panel in kept):
                wanted = " or ".join(f"{panel.x.name} and {panel.y.name}" for panel in kept)
                raise ParameterError(f"--overlay: {one.source} has no columns {wanted}; it has "
                                     f"{', '.join(one.columns)}")
        return kept

    def overlaid(self, panel: Any) -> list[Curve]:
        """The overlays as curves of a panel."""
        return [one.curve(panel) for one in self.overlays if one.fits(panel)]

    def rescale(self, axes: Sequence[Any], panels: Sequence[Any]) -> list[str]:
        """Make axes logarithmic as asked; return what is lost by that, a sentence each."""
        notes = []
        for which in self.log:
            for axis, panel in zip(axes, panels, strict=True):
                values = _values(panel, which)
                lost = int(np.sum(values <= 0))
                if len(values) and lost == len(values):
                    raise ParameterError(f"--log {which}: no value of {getattr(panel, which).name} is positive")
                if lost:
                    notes.append(f"--log {which}: {lost} of {len(values)} values of {getattr(panel, which).name} are "
                                 "not positive, and not drawn")
                getattr(axis, f"set_{which}scale")("log")
        return notes


def _values(panel: Any, which: Any) -> Any:
    """What is drawn along an axis of a panel."""
    if isinstance(panel, Grid):
        grids = {axis.name: values for axis, values in panel.axes}
        found = grids.get(getattr(panel, which).name, panel.values.ravel())
        return found[np.isfinite(found)]
    parts = [np.asarray(getattr(curve, which)) for curve in panel.curves]
    parts = [part[np.isfinite(part)] for part in parts if part.dtype.kind in "fi"]
    return np.concatenate(parts) if parts else np.empty(0)


def parse_size(text: str, name: str = "--size") -> tuple[float, float]:
    """Return (width, height) in inches of WxH, in inches or with a unit at the end.

    >>> parse_size("6x3"), tuple(round(side, 4) for side in parse_size("86x60mm"))
    ((6.0, 3.0), (3.3858, 2.3622))
    """
    unit = next((unit for unit in _UNITS if text.endswith(unit)), "")
    sides = [as_number(side) for side in text.removesuffix(unit).split("x")]
    inches = [side * _UNITS[unit or "in"] for side in sides if side is not None]
    if len(sides) != 2 or len(inches) != 2 or not all(_LEAST <= side <= _MOST for side in inches):
        raise ParameterError(f"{name}: give width and height as WxH, in inches, or with mm or cm at the end, "
                             f"from {_LEAST:g} to {_MOST:g} inches each, like 86x60mm (got {text!r})")
    return inches[0], inches[1]


def parse_log(text: str, name: str = "--log") -> str:
    """Return the axes that are to be logarithmic."""
    if text not in ("x", "y", "xy"):
        raise ParameterError(f"{name}: must be x, y or xy (got {text!r})")
    return text


def read_style(path: str, name: str = "--style") -> dict[str, Any]:
    """Return the settings of a matplotlib style sheet: a file, or the name of a style that matplotlib knows."""
    import logging
    import os

    import matplotlib
    from matplotlib import style

    if path in style.library:
        return {**style.library[path]}  # type: ignore[dict-item]
    if not os.path.exists(path):
        raise ParameterError(f"{name}: no file {path!r}, and no style of matplotlib of that name; those are "
                             f"{', '.join(style.available)}")
    said: list[str] = []
    logger, handler = logging.getLogger("matplotlib"), logging.Handler()
    handler.emit = lambda record: said.append(" ".join(record.getMessage().split()))  # type: ignore[method-assign]
    logger.addHandler(handler)
    propagates, logger.propagate = logger.propagate, False
    try:
        found = matplotlib.rc_params_from_file(path, fail_on_error=True, use_default_template=False)
    except (OSError, ValueError) as reason:
        raise ParameterError(f"{name}: {path!r} is no style sheet of matplotlib: {' '.join(str(reason).split())}") \
            from None
    finally:
        logger.removeHandler(handler)
        logger.propagate = propagates
    if said or not found:
        why = said[0].partition(" You probably")[0] if said else "it has no settings"
        raise ParameterError(f"{name}: {path!r} is no style sheet of matplotlib: {why}")
    return {**found}  # type: ignore[dict-item]
