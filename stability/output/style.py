"""Colours, line styles and fonts of all figures: told apart in grey print, text kept as text."""

from itertools import cycle as forever
from itertools import islice
from typing import Any

from cycler import cycler

BLUE, RED, GREEN, ORANGE, PURPLE, TEAL, BLACK = COLOURS = ("#0b4f8a", "#c0392b", "#2e8b57", "#d98200", "#7d3c98",
                                                           "#17a2b8", "#222222")
GREY = "#7f7f7f"
LINES: tuple[Any, ...] = ("-", "--", "-.", ":", (0, (6, 1, 1, 1, 1, 1)), (0, (10, 2)))  # told apart in grey print
MARKERS = "o", "s", "^", "D", "v"
CURVES = len(COLOURS) * len(LINES)  # that differ in colour or line style


def _cycle() -> Any:
    """All pairs of colours and line styles: their numbers have no common divisor."""
    return cycler(**{name: list(islice(forever(values), CURVES)) for name, values in
                     (("color", COLOURS), ("linestyle", LINES))})


FONTS: dict[Any, Any] = {"pdf.fonttype": 42, "ps.fonttype": 42, "svg.fonttype": "none"}  # text, not its outlines
STYLE: dict[Any, Any] = {
    "figure.constrained_layout.use": True,
    "font.size": 9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.prop_cycle": _cycle(),
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "savefig.dpi": 200,
    "svg.hashsalt": "stability",
    **FONTS,
}
