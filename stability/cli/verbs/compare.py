"""stability compare: all methods on one eigenvalue, their errors and times."""

import argparse
from typing import Any

from ..asked import checked, flow_of
from ..common import add_verb, report
from ..progress import Bar
from ..specs import parse_one

_POINTS = 21  # of the sweeps: enough for a time per eigenvalue
_BUDGET = 10.0  # seconds after which nothing long is begun


def add(verbs: Any) -> None:
    add_verb(verbs, "compare", _run, "stability compare vortex --k 2 --plot compare.png",
             _k_option)


def _k_option(verb: Any) -> None:
    verb.add_argument("--k", required=True, metavar="K", help="wavenumber")


def _run(arguments: argparse.Namespace) -> int:
    checked(arguments)
    k = parse_one(arguments.k, "--k", "wavenumber")

    def compute() -> Any:
        from ...studies.compare import comparisons

        flow = flow_of(arguments)
        bar, found = Bar(arguments.quiet), None
        try:
            for found in comparisons(flow, k, report=bar, points=_POINTS, budget=_BUDGET):  # noqa: B007
                pass
        except KeyboardInterrupt:
            if found is None or not found.measurements:
                raise
        finally:
            bar.clear()
        return found

    return report(arguments, compute)
