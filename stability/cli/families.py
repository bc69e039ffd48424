"""The option --each: the same question for several values of a parameter, as one table and one figure."""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..errors import ParameterError
from ..status import is_interrupted
from .common import flow_of, report, swept_values

if TYPE_CHECKING:
    from ..flows.base import Flow
    from ..studies.family import Family

_MOST = 42  # curves that differ in colour or line style


def each_option(verb: Any) -> None:
    verb.add_argument("--each", metavar="NAME=SPEC",
                      help="the same for each value of another parameter")


def answer(arguments: argparse.Namespace, question: Callable[..., Any]) -> int:
    """Report the result of a verb, for one flow or for each of a family; return the exit status.

    `question(flow)` checks what is asked of a flow, and returns the function that computes its Record.
    """
    flow = flow_of(arguments)
    if arguments.each is None:
        return report(arguments, question(flow))
    name, values = _values(arguments, flow)
    flows = [replace(flow, **{name: value}) for value in values]
    computations = [question(one) for one in flows]

    def compute() -> "Family":
        from ..studies.family import Family

        members = list(_members(computations))
        return Family(flow, name, tuple(members), tuple(values[len(members):]))

    return report(arguments, compute)


def _values(arguments: argparse.Namespace, flow: "Flow") -> tuple[str, list[float]]:
    """The parameter and its values; refused where they would have no effect, or be lost among themselves."""
    name, values = swept_values(arguments.each, flow, "--each")
    if getattr(arguments, f"parameter {name}", None) is not None:
        raise ParameterError(f"--each: {name} is given as --{name.replace('_', '-')} too; leave one of them out")
    for option in ("over", "vary"):
        text = getattr(arguments, option, None) or ""
        if text.partition("=")[0].replace("-", "_") == name:
            raise ParameterError(f"--each: {name} is the parameter of --{option}; take another one")
    if len(set(values)) < len(values):
        raise ParameterError(f"--each {name}: a value is given twice")
    if arguments.plot and len(values) > _MOST:
        raise ParameterError(f"--each {name}: a figure has up to {_MOST} curves (got {len(values)} values); leave out "
                             "--plot, or some of them")
    return name, values


def _members(computations: list[Callable[..., Any]]) -> Iterator:
    """The results in turn, until Ctrl-C: what is done is kept."""
    done = 0
    try:
        for compute in computations:
            result = compute()
            done += 1
            yield result
            if any(is_interrupted(row["status"]) for row in result.rows()):
                return
    except KeyboardInterrupt:
        if not done:
            raise
