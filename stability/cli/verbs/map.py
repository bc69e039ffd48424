"""stability map: a quantity over a grid of one to three parameters, on all cores, resumed where it was stopped."""

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...checks import check_integer
from ...errors import ParameterError
from ...studies.choices import MOST_WORKERS, check_quantity, usual_quantity
from ..asked import check_vary, checked, flow_of, swept
from ..common import (
    FORMS,
    INTERRUPTED_STATUS,
    SPEC,
    accuracy_of,
    accuracy_options,
    add_verb,
    check_files,
    form_of,
    report,
)
from ..progress import Bar
from ..specs import Spec, read_spec
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
    request_of = _request(arguments)
    workers = None if arguments.workers is None else check_integer(arguments.workers, "--workers", 1, MOST_WORKERS)
    _check_output(arguments)
    from ...studies.pool import cores, without_threads

    without_threads()
    from ...studies.map import carry_out, points_kept

    request = request_of()
    journal = Path(f"{arguments.output}.partial")
    bar = Bar(arguments.quiet)
    try:
        found = carry_out(request, workers=workers or cores(), journal=journal, report=bar, may_fork=True)
        bar.clear()
        if found.damaged and not arguments.quiet:
            say(f"stability: damaged lines of {str(journal)!r} left out: {found.damaged}; the points that no other "
                "line holds were computed again")
        status = report(arguments, lambda: found)
    except KeyboardInterrupt:
        bar.clear()
        say(f"stability: interrupted: {points_kept(request, journal)} of {request.size} points are kept in "
            f"{str(journal)!r}; the same command resumes")
        return INTERRUPTED_STATUS
    finally:
        bar.clear()
    journal.unlink(missing_ok=True)
    return status


def _request(arguments: argparse.Namespace) -> "Callable[[], Request]":
    """Check what is asked; return the function that makes the request of it."""
    flow, accuracy = checked(arguments), accuracy_of(arguments)
    if not arguments.over:
        raise ParameterError("--over: give at least one parameter to sweep, NAME=SPEC")
    over: dict[str, Spec] = {}
    for text in arguments.over:
        name, values = swept(text, flow)
        if name in over:
            raise ParameterError(f"--over: {name} is swept twice")
        over[name] = values
    k = None if arguments.k is None else read_spec(arguments.k, "--k")
    vary = None if arguments.vary is None else check_vary(flow, arguments)
    quantity = check_quantity(arguments.quantity or usual_quantity(k, vary), over, k, vary)

    def request() -> "Request":
        from ...studies.request import Request

        grid = {name: values.array.tolist() for name, values in over.items()}
        return Request(flow_of(arguments), grid, quantity, None if k is None else k.array, vary, accuracy)

    return request


def _check_output(arguments: argparse.Namespace) -> None:
    if arguments.output is None:
        raise ParameterError("-o FILE is needed, .csv, .json or .nc: a map is kept beside it while it is computed")
    if form_of(arguments) == "table":
        raise ParameterError(f"-o: the file must end in {', '.join(FORMS)}, or add --csv or --json "
                             f"(got {arguments.output!r})")
    check_files(arguments)
    axes = [text.partition("=")[0].replace("-", "_") for text in arguments.over] + ["k"] * (arguments.k is not None)
    if arguments.plot and len(axes) > _DRAWN_AXES:
        raise ParameterError(f"--plot: draws maps over one or two axes (this one has {', '.join(axes)})")
