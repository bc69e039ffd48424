"""The options that say how the figure of --plot is to look."""

import argparse
from typing import TYPE_CHECKING, Any

from ..errors import ParameterError
from ..output.sheet import parse_log, parse_size, read_style

if TYPE_CHECKING:
    from ..output.look import Look

_DEPENDENT = "size", "style", "title", "log", "overlay", "panel"  # options that need --plot


def plot_options(verb: Any) -> None:
    """Options of every verb that draws."""
    group = verb.add_argument_group("figure")
    group.add_argument("--plot", metavar="FILE", help="draw the result: .png, .pdf or .svg")
    group.add_argument("--panel", metavar="NAME", help="one panel alone, by the name of its column")
    group.add_argument("--size", metavar="WxH", help="in inches, or with a unit: 86x60mm")
    group.add_argument("--style", metavar="FILE", help="a matplotlib style: file or name")
    group.add_argument("--title", metavar="TEXT", help="instead of flow and parameters")
    group.add_argument("--log", metavar="AXES", help="logarithmic axes: x, y or xy")
    group.add_argument("--overlay", metavar="CSV[:LABEL]", action="append", default=[],
                       help="points with errors, columns by name; repeatable")


def look_of(arguments: argparse.Namespace) -> "Look | None":
    """The `Look` that the options ask for, None without --plot; files are read once."""
    given = {name: getattr(arguments, name) for name in _DEPENDENT if getattr(arguments, name, None)}
    if arguments.plot is None:
        for name in given:
            raise ParameterError(f"--{name}: says how a figure looks; add --plot FILE")
        return None
    if getattr(arguments, "look", None) is None:
        size = parse_size(arguments.size) if arguments.size else None
        style = read_style(arguments.style) if arguments.style else {}
        log = parse_log(arguments.log) if arguments.log else ""
        from ..output.look import Look
        from ..output.overlay import read_overlay

        arguments.look = Look(size, style, arguments.title, log, tuple(map(read_overlay, arguments.overlay)),
                              (arguments.panel,) if arguments.panel else ())
    return arguments.look
