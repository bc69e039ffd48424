"""stability base: the base flow, its profiles through all layers."""

import argparse
from typing import Any

from ..common import add_verb, flow_of, report


def add(verbs: Any) -> None:
    add_verb(verbs, "base", _run, "stability base dune --points 11 --plot base.png", _points_option)


def _points_option(verb: Any) -> None:
    verb.add_argument("--points", metavar="N", help="heights in each layer, evenly spaced in its coordinate "
                      "(default 41)")


def _run(arguments: argparse.Namespace) -> int:
    from ...checks import check_integer
    from ...studies.base import HEIGHTS, MOST_HEIGHTS, base_flow

    flow = flow_of(arguments)
    points = HEIGHTS if arguments.points is None else check_integer(arguments.points, "--points", 2, MOST_HEIGHTS)
    return report(arguments, lambda: base_flow(flow, points))
