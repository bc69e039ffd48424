"""stability base: the base flow, its profiles through all layers."""

import argparse
from typing import TYPE_CHECKING, Any

from ...checks import check_integer
from ...studies.choices import HEIGHTS, MOST_HEIGHTS
from ..asked import checked, flow_of
from ..common import add_verb, report

if TYPE_CHECKING:
    from ...studies.base import BaseFlow


def add(verbs: Any) -> None:
    add_verb(verbs, "base", _run, "stability base dune --points 11 --plot base.png", _points_option)


def _points_option(verb: Any) -> None:
    verb.add_argument("--points", metavar="N", help="heights in each layer, evenly spaced in its coordinate "
                      "(default 41)")


def _run(arguments: argparse.Namespace) -> int:
    checked(arguments)
    points = HEIGHTS if arguments.points is None else check_integer(arguments.points, "--points", 2, MOST_HEIGHTS)

    def compute() -> "BaseFlow":
        from ...studies.base import base_flow

        return base_flow(flow_of(arguments), points)

    return report(arguments, compute)
