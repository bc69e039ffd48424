"""The option --each: the same question for several values of a parameter, as one table and one figure."""

import argparse
from collections.abc import Callable, Iterator
from typing import Any

from ..errors import ParameterError
from ..flows.declaration import Declaration
from ..status import is_interrupted
from .asked import checked, flow_of, given, sweep_of, swept
from .common import report
from .specs import Spec

_MOST = 42  # curves that differ in colour or line style


def each_option(verb: Any) -> None:
    verb.add_argument("--each", metavar="NAME=SPEC",
                      help="the same for each value of another parameter")


def answer(arguments: argparse.Namespace, ask: Callable[[Declaration], Callable[..., Any]]) -> int:
    """Report the result of a verb, for one flow or for each of a family; return the exit status.

    `ask(what the flow declares)` checks what is asked, and returns the question: `question(flow)` checks what depends
    on the values of its parameters, and returns the function that computes its Record.
    """
    declared = checked(arguments)
    each = None if arguments.each is None else _each(arguments, declared)
    question = ask(declared)

    def compute() -> Any:
        flow = flow_of(arguments)
        if each is None:
            return question(flow)()
        computations = [question(one) for one in sweep_of(flow, each)]
        members = list(_members(computations))
        from ..studies.family import Family

        return Family(flow, each[0], tuple(members), tuple(each[1].array.tolist()[len(members):]))

    return report(arguments, compute)


def _each(arguments: argparse.Namespace, flow: Declaration) -> tuple[str, Spec]:
    """The parameter and its values; refused where they would have no effect, or be lost among themselves."""
    name, values = swept(arguments.each, flow, "--each")
    if name in given(arguments):
        raise ParameterError(f"--each: {name} is given as --{name.replace('_', '-')} too; leave one of them out")
    for option in ("over", "vary"):
        text = getattr(arguments, option, None) or ""
        if text.partition("=")[0].replace("-", "_") == name:
            raise ParameterError(f"--each: {name} is the parameter of --{option}; take another one")
    if len(set(values.known)) < len(values.known):
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
