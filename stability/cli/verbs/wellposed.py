"""stability wellposed: where a flow's own equations are ill posed, and how its fastest modes grow with k."""

import argparse
from typing import Any

from ...checks import check_integer
from ...studies.wellposed import growth_with_degree, ill_posedness
from ..common import add_verb, collect, flow_of, report
from ..specs import parse_spec

_POINTS = "21"
_WAVENUMBERS = "1:100:9"  # of the second panel of the figure


def add(verbs: Any) -> None:
    add_verb(verbs, "wellposed", _run, "stability wellposed dune --shields 1.05 --mu1 0.7 --k 1,3,10,30,100",
             _k_option, _points_option)


def _k_option(verb: Any) -> None:
    verb.add_argument("--k", metavar="SPEC",
                      help="wavenumbers: report the largest growth rate of all modes there, by Chebyshev degree, "
                           "instead of C through the layer")


def _points_option(verb: Any) -> None:
    verb.add_argument("--points", default=_POINTS, metavar="N", help=f"points of each layer (default {_POINTS})")


def _run(arguments: argparse.Namespace) -> int:
    flow = flow_of(arguments)
    count = check_integer(arguments.points, "--points", 2, 100_000)
    wavenumbers = parse_spec(arguments.k, "--k") if arguments.k else None

    def compute() -> Any:
        growth = ()
        if wavenumbers is not None or arguments.plot:
            growth = _growth(arguments, flow, parse_spec(_WAVENUMBERS, "") if wavenumbers is None else wavenumbers)
        return ill_posedness(flow, count, growth, wavenumbers)

    return report(arguments, compute)


def _growth(arguments: Any, flow: Any, wavenumbers: Any) -> Any:
    growth = (one for k in sorted(set(wavenumbers.tolist())) for one in growth_with_degree(flow, k))
    return tuple(collect(arguments, growth, len(wavenumbers), lambda done: []))
