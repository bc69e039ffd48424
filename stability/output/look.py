"""How a figure is to look, apart from what it shows: size, style, title, scales, and points laid over it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..errors import ParameterError
from .overlay import Overlay
from .panels import Curve, Grid


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
