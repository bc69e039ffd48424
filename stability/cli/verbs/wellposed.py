"""stability wellposed: where a flow's own equations are ill posed, and how its fastest modes grow with k."""

import argparse
from typing import Any

from ...checks import check_integer
from ..asked import checked, flow_of
from ..common import add_verb, collect, report
from ..specs import parse_spec, read_spec

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
    checked(arguments)
    count = check_integer(arguments.points, "--points", 2, 100_000)
    spec = read_spec(arguments.k, "--k") if arguments.k else None

    def compute() -> Any:
        from ...studies.wellposed import ill_posedness

        flow, growth, wavenumbers = flow_of(arguments), (), None if spec is None else spec.array
        if wavenumbers is not None or arguments.plot:
            growth = _growth(arguments, flow, parse_spec(_WAVENUMBERS, "") if wavenumbers is None else wavenumbers)
        return ill_posedness(flow, count, growth, wavenumbers)

    return report(arguments, compute)


def _growth(arguments: Any, flow: Any, wavenumbers: Any) -> Any:
    from ...studies.wellposed import growth_with_degree

    growth = (one for k in sorted(set(wavenumbers.tolist())) for one in growth_with_degree(flow, k))
    return tuple(collect(arguments, growth, len(wavenumbers), lambda done: []))
