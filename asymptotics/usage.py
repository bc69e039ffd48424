"""How the command reads its arguments: errors as exceptions, no value given twice, help with a flow's parameters."""

import argparse
import sys
from difflib import get_close_matches
from typing import Any, NoReturn

from .catalogue import names


class BadUsage(ValueError):
    """What the command line asks for cannot be done."""


class Parser(argparse.ArgumentParser):
    """Errors as exceptions; no value is given twice; examples in one line, to be copied."""

    def __init__(self, **options: Any) -> None:
        super().__init__(formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False, **options)
        for action in (None, "store"):
            self.register("action", action, _Once)
        self.set_defaults(given=frozenset())

    def error(self, message: str) -> NoReturn:
        raise BadUsage(f"{message} (see: {self.prog} --help)")

    def exit(self, status: int = 0, message: str | None = None) -> NoReturn:
        sys.stdout.flush()  # of the help: where nobody reads it, say so in `main`
        super().exit(status, message)


class _Once(argparse.Action):
    """Store a value, and in `given` that it was given: twice is refused, or the first value would get lost."""

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: Any = None) -> None:
        if self.dest in namespace.given:
            raise BadUsage(f"{option_string}: given twice, with {getattr(namespace, self.dest)!r} and {values!r}; "
                           "give it once")
        setattr(namespace, self.dest, values)
        namespace.given |= {self.dest}


class Help(argparse.Action):
    """Print the help of a verb, with the parameters of the flow that has been named before, if any."""

    def __init__(self, option_strings: list[str], dest: str, help: str) -> None:
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, default=argparse.SUPPRESS, help=help)

    def __call__(self, parser: Any, namespace: Any, values: Any, option_string: Any = None) -> None:
        group = namespace.parameters
        if namespace.flow in names():
            from . import flows

            flow = flows.load(namespace.flow)
            texts = {parameter.flag: f"{parameter.meaning}, {parameter.range}" for parameter in flow.PARAMETERS}
            group.title, group.description = f"parameters of {namespace.flow}", flow.SUMMARY
            for action in group._group_actions:
                action.help = texts.get(action.option_strings[0], argparse.SUPPRESS)
        parser.print_help()
        parser.exit()


def nearest(name: str, known: Any) -> str:
    match = get_close_matches(name, known, 1)
    return f" (did you mean {match[0]!r}?)" if match else ""


def add_parameters(verb: "Parser", flags: bool) -> None:
    """The group of the parameters, with the flags of every flow where they are needed: a flow costs sympy."""
    group = verb.add_argument_group("parameters of the flow", f"listed by: {verb.prog} FLOW --help")
    verb.set_defaults(parameters=group)
    if not flags:
        return
    from . import flows

    known = {parameter.flag: parameter.name for name in names() for parameter in flows.load(name).PARAMETERS}
    for flag, name in known.items():
        for spelling in dict.fromkeys((flag, f"--{name}")):
            if spelling in verb._option_string_actions:
                continue  # the wavenumbers of evaluate
            group.add_argument(spelling, dest=f"parameter {name}", metavar="V", help=argparse.SUPPRESS)


def positive(text: str, flag: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not value > 0:
        raise BadUsage(f"{flag} must be a positive number, got {text!r}; write it like {flag} 0.05")
    return value
