"""stability flows: what can be computed, with parameters, defaults, ranges and scales."""

import argparse
from typing import Any

from ...flows import FLOWS
from ...flows.declaration import Declaration, Parameter, declared
from ..names import FLOW, flag_of
from ..streams import put, terminal_width


def add(verbs: Any) -> None:
    verb = verbs.add_parser("flows", help="flows, parameters, defaults, ranges, scales",
                            epilog="example: stability flows dune")
    verb.add_argument("flow", nargs="?", metavar="FLOW", help=FLOW)
    verb.set_defaults(run=_run, complete=lambda verb, words: None)


def _run(arguments: argparse.Namespace) -> int:
    from ...flows.catalogue import offers

    chosen = [arguments.flow] if arguments.flow else [*FLOWS, *offers()]
    width = terminal_width()
    put("\n".join(_describe(declared(name), width) for name in chosen))
    return 0


def _describe(flow: Declaration, width: int | None) -> str:
    rows = [(flag_of(item.name), item.default, item.allowed, _meaning(item)) for item in flow.parameters]
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    lines = ["  " + "  ".join((*(cell.ljust(w) for cell, w in zip(row, widths, strict=False)), row[3])) for row in rows]
    if width and max(map(len, lines)) > width:
        lines = _wrapped(rows, width)
    return "\n".join([f"{flow.name}: {flow.title}", *(f"  {part}" for part in flow.scales.split("; ")), *lines, ""])


def _meaning(item: Parameter) -> str:
    return f"{item.meaning}; searched from {item.searched}" if item.searched else item.meaning


def _wrapped(rows: Any, width: Any) -> Any:
    from textwrap import wrap

    return [line for name, default, range_, meaning in rows
            for line in (f"  {name} {default}, {range_}", *wrap(meaning, width - 4, initial_indent="    ",
                                                                 subsequent_indent="    "))]
