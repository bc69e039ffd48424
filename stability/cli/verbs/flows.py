"""stability flows: what can be computed, with parameters, defaults, ranges and scales."""

from dataclasses import fields
from textwrap import wrap

from ...flows import FLOWS, find
from ...flows.base import allowed, numeric, span_of
from ...output.text import terminal_width, write
from ..common import FLOW, flag


def add(verbs):
    verb = verbs.add_parser("flows", help="flows, parameters, defaults, ranges, scales",
                            epilog="example: stability flows dune")
    verb.add_argument("flow", nargs="?", metavar="FLOW", help=FLOW)
    verb.set_defaults(run=_run, complete=lambda verb, words: None)


def _run(arguments):
    from ...flows.catalogue import offers

    chosen = [find(name) for name in ([arguments.flow] if arguments.flow else [*FLOWS, *offers()])]
    write("\n".join(_describe(flow, terminal_width()) for flow in chosen), None)
    return 0


def _describe(flow, width):
    rows = [(flag(item), str(item.default), allowed(item.metadata), _meaning(flow, item)) for item in fields(flow)]
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    lines = ["  " + "  ".join((*(cell.ljust(w) for cell, w in zip(row, widths, strict=False)), row[3])) for row in rows]
    if width and max(map(len, lines)) > width:
        lines = [line for name, default, range_, meaning in rows
                 for line in (f"  {name} {default}, {range_}", *wrap(meaning, width - 4, initial_indent="    ",
                                                                     subsequent_indent="    "))]
    return "\n".join([f"{flow.name}: {flow.title}", *(f"  {part}" for part in flow.scales.split("; ")), *lines, ""])




def _meaning(flow, item):
    """What a parameter means, and where neutral values of it are looked for."""
    if not numeric(item):
        return item.metadata["meaning"]
    low, high = span_of(flow, item.name)
    return f"{item.metadata['meaning']}; searched from {low:g} to {high:g}"
