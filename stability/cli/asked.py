"""The flow that is asked about: flags of its parameters, and what is given with them, checked before it is imported.

What a flow of this package declares is known without numerics (`flows.declaration`); a flow of one's own, and any flow
under a friction law that is named, is asked itself.
"""

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ..errors import ParameterError
from ..flows.catalogue import find, nearest
from ..flows.declaration import Declaration, Parameter, declaration_of, declared
from ..flows.rules import check_parameter, check_varied, numeric
from .names import flag_of
from .specs import Spec, read_spec
from .verbs.once import NUMBER

if TYPE_CHECKING:
    from ..flows.base import Flow

LAW = ("friction law: linear, saturating, regularised, power, or your own: path/to/file.py:Class; its parameters are "
       "listed by: --law NAME --help")
_GIVEN = "parameter "  # begins the name, among parsed arguments, of a parameter of the flow


def add_parameters(verb: Any, words: list[str]) -> None:
    """Add a flag for every parameter of the flow that the words name."""
    name = _flow_named(verb, words)
    if name is None:
        verb.add_argument_group("parameters of the flow", f"listed by: {verb.prog} FLOW --help")
        return
    flow = _declared(name, _law_named(words))
    group = verb.add_argument_group(f"parameters of {flow.name}", flow.title)
    if flow.takes_law:
        group.add_argument("--law", metavar="NAME", help=LAW)
    for item in flow.parameters:
        text = f"{item.meaning}; {item.allowed}, default {item.default}".replace("%", "%%")
        for spelling in dict.fromkeys((flag_of(item.name), f"--{item.name}")):
            group.add_argument(spelling, dest=_GIVEN + item.name, metavar=_metavar(item),
                               help=text if spelling == flag_of(item.name) else argparse.SUPPRESS)


def _flow_named(verb: Any, words: list[str]) -> str | None:
    """The first of the words that is no option and no value of one; an option that is unknown yet takes a value."""
    value_follows = False
    for word in words:
        if value_follows:
            value_follows = False
        elif not word.startswith("-") or word == "-":
            return word
        else:
            option = verb._option_string_actions.get(word)
            long = word.startswith("--") and "=" not in word
            value_follows = option.nargs != 0 if option else long
    return None


def _metavar(item: Parameter) -> str:
    return NUMBER if numeric(item) else "FILE" if "table" in item.metadata else "NAME"


def _law_named(words: list[str]) -> str | None:
    """The friction law that the words name, or None; an abbreviated or missing value is left to the parser."""
    for word, following in zip(words, [*words[1:], None], strict=True):
        if word == "--law" or word.startswith("--law="):
            return word.partition("=")[2] if "=" in word else following
    return None


def _declared(name: str, law: str | None) -> Declaration:
    """What the flow of this name declares, under the friction law if one is named."""
    flow = declared(name)
    return flow if law is None or not flow.takes_law else declaration_of(_class_of(name, law))


def _class_of(name: str, law: str | None) -> Any:
    """The class of flows with this name, under the friction law if one is named."""
    flow: Any = find(name)
    if law is None or not hasattr(flow, "under"):
        return flow
    from ..flows.laws import find_law

    return flow.under(find_law(law))


def nearest_flag(arguments: argparse.Namespace, unknown: Any) -> Any:
    """A hint at the parameter that an unknown option may stand for."""
    if not getattr(arguments, "flow", None):
        return ""
    flow = declaration(arguments)
    flags = [flag_of(item.name) for item in flow.parameters]
    return nearest(unknown.partition("=")[0], flags) or f"; {flow.name} has {', '.join(flags) or 'no parameters'}"


def nearest_option(unknown: str, known: list[str]) -> str:
    """A hint at the option of a verb that an unknown one may stand for, in the other case of letters first."""
    name = unknown.partition("=")[0]
    same = [option for option in known if option.lower() == name.lower()]
    return nearest(same[0], same) if same else nearest(name, known)


def given(arguments: argparse.Namespace) -> dict[str, str]:
    """The parameters given as flags, {name: text}."""
    return {key.removeprefix(_GIVEN): value for key, value in vars(arguments).items()
            if key.startswith(_GIVEN) and value is not None}


def declaration(arguments: argparse.Namespace) -> Declaration:
    """What the flow declares that is asked about."""
    return _declared(arguments.flow, getattr(arguments, "law", None))


def checked(arguments: argparse.Namespace) -> Declaration:
    """The same; raises ParameterError where a value given for a parameter is not admissible."""
    flow, values = declaration(arguments), given(arguments)
    for item in flow.parameters:
        if item.name in values:
            if "table" in item.metadata:
                break  # the flow reads it, and says first what is wrong with it
            check_parameter(flow.name, item, values[item.name])
    return flow


def flow_of(arguments: argparse.Namespace) -> "Flow":
    """The flow with the parameters given as flags."""
    flow = _class_of(arguments.flow, getattr(arguments, "law", None))(**given(arguments))
    from ..flows.base import check_flow

    return check_flow(flow)


def check_vary(flow: Declaration, arguments: argparse.Namespace) -> str:
    """The parameter of --vary."""
    return check_varied(flow.name, flow.parameters, arguments.vary.replace("-", "_"))


def swept(text: str, flow: Declaration, option: str = "--over") -> tuple[str, Spec]:
    """The parameter of NAME=SPEC and its values, each of them admissible."""
    name, _, spec = text.partition("=")
    name = name.replace("-", "_")
    items = {item.name: item for item in flow.parameters if numeric(item)}
    if name not in items:
        raise ParameterError(f"{option}: {flow.name} has no parameter {name!r}{nearest(name, items)}; "
                             f"it has {', '.join(items)}")
    values = read_spec(spec, f"{option} {name}", False, items[name].metadata["unbounded"])
    _check_swept(flow.name, items[name], values)
    return name, values


def _check_swept(flow: str, item: Parameter, values: Spec) -> None:
    """Raise the ParameterError of the first value that is not admissible; a range is looked at by its ends."""
    try:
        for value in values.known:
            check_parameter(flow, item, value)
    except ParameterError:
        if len(values.known) == len(values):
            raise
        for value in values.array.tolist():
            check_parameter(flow, item, value)
        raise


def sweep_of(flow: "Flow", over: tuple[str, Spec]) -> "list[Flow]":
    """The flows of a sweep over a parameter."""
    name, values = over
    return [replace(flow, **{name: value}) for value in values.array.tolist()]
