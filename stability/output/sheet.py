"""Texts that say how a figure is to look: its size, its logarithmic axes, its style sheet. Read without numerics."""

from typing import Any

from ..checks import as_number
from ..errors import ParameterError

_UNITS = {"in": 1.0, "mm": 1 / 25.4, "cm": 1 / 2.54}  # inches
_LEAST, _MOST = 0.5, 50.0  # inches of a side


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
