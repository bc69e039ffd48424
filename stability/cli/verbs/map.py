"""stability map: a quantity over a grid of one to three parameters, on all cores, resumed where it was stopped."""

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...checks import check_integer
from ...errors import ParameterError
from ..common import (
    FORMS,
    INTERRUPTED_STATUS,
    SPEC,
    accuracy_of,
    accuracy_options,
    add_verb,
    check_files,
    flow_of,
    form_of,
    report,
    swept_values,
)
from ..progress import Bar
from ..specs import parse_spec
from ..streams import say
from .critical import vary_option

if TYPE_CHECKING:
    from ...studies.request import Request

_DRAWN_AXES = 2


def add(verbs: Any) -> None:
    add_verb(verbs, "map", _run,
             "stability map dune --over shields=1.1:4:20 --over Re=0.1:1e4:20 -o dunes.csv --plot dunes.png",
             _options, accuracy_options)


def _options(verb: Any) -> None:
    verb.add_argument("--over", action="append", default=[], metavar="NAME=SPEC",
                      help=f"parameter to sweep and its values, once to three times, the innermost last: {SPEC}")
    verb.add_argument("--quantity", metavar="Q", help="k_max (the default), growth_rate (the default with --k), or "
                      "neutral (with --vary)")
    verb.add_argument("--k", metavar="SPEC", help="wavenumbers: growth rates over them too")
    vary_option(verb, required=False)
    verb.add_argument("--workers", metavar="N", help="processes; default: as many as there are cores to use")


def _run(arguments: Any) -> Any:
    from ...studies.map import carry_out
    from ...studies.pool import MOST_WORKERS, cores

    request = _request(arguments)
    workers = cores() if arguments.workers is None else check_integer(arguments.workers, "--workers", 1, MOST_WORKERS)
    _check_output(arguments, request)
    journal = Path(f"{arguments.output}.partial")
    bar = Bar(arguments.quiet)
    try:
        found = carry_out(request, workers=workers, journal=journal, report=bar)
        bar.clear()
        if found.damaged and not arguments.quiet:
            say(f"stability: damaged lines of {str(journal)!r} left out: {found.damaged}; the points that no other "
                "line holds were computed again")
        status = report(arguments, lambda: found)
    except KeyboardInterrupt:
        bar.clear()
        say(f"stability: interrupted: {bar.done} of {request.size} points are kept in {str(journal)!r}; "
            "the same command resumes")
        return INTERRUPTED_STATUS
    finally:
        bar.clear()
    journal.unlink(missing_ok=True)
    return status


def _request(arguments: argparse.Namespace) -> "Request":
    from ...studies.request import Request, usual_quantity

    flow, accuracy = flow_of(arguments), accuracy_of(arguments)
    if not arguments.over:
        raise ParameterError("--over: give at least one parameter to sweep, NAME=SPEC")
    over = {}
    for text in arguments.over:
        name, values = swept_values(text, flow)
        if name in over:
            raise ParameterError(f"--over: {name} is swept twice")
        over[name] = values
    k = None if arguments.k is None else parse_spec(arguments.k, "--k")
    vary = arguments.vary and arguments.vary.replace("-", "_")
    return Request(flow, over, arguments.quantity or usual_quantity(k, vary), k, vary, accuracy)


def _check_output(arguments: argparse.Namespace, request: "Request") -> None:
    if arguments.output is None:
        raise ParameterError("-o FILE is needed, .csv, .json or .nc: a map is kept beside it while it is computed")
    if form_of(arguments) == "table":
        raise ParameterError(f"-o: the file must end in {', '.join(FORMS)}, or add --csv or --json "
                             f"(got {arguments.output!r})")
    check_files(arguments)
    if arguments.plot and len(request.axes) > _DRAWN_AXES:
        raise ParameterError(f"--plot: draws maps over one or two axes (this one has {', '.join(request.axes)})")
