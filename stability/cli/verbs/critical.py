"""stability critical: the value of a parameter at which a flow becomes unstable."""

import argparse
from typing import TYPE_CHECKING, Any

from ...checks import check_range
from ..asked import check_vary, checked, flow_of
from ..common import accuracy_options, add_verb, options_of, report

if TYPE_CHECKING:
    from ...studies.critical import NeutralPoint


def add(verbs: Any) -> None:
    add_verb(verbs, "critical", _run, "stability critical poiseuille --vary Re",
             vary_option, range_option,
             search_option, long_wave_option, accuracy_options)


def vary_option(verb: Any, required: bool = True) -> None:
    verb.add_argument("--vary", required=required, metavar="NAME",
                      help="parameter to solve for")


def range_option(verb: Any) -> None:
    verb.add_argument("--range", metavar="LOW:HIGH", help="values of it to search; default: see stability flows FLOW")


def search_option(verb: Any) -> None:
    verb.add_argument("--search", metavar="LOW:HIGH", help="wavenumbers to search (default 0.01:100, and shorter waves "
                      "in thin layers)")


def searched(arguments: argparse.Namespace) -> dict[Any, Any]:
    """The options --range and --search as arguments of `critical`."""
    names = {"span": "range", "search": "search"}
    given = {name: getattr(arguments, option, None) for name, option in names.items()}
    return {name: check_range(value.split(":"), f"--{names[name]}") for name, value in given.items() if value}


def long_wave_option(verb: Any) -> None:
    verb.add_argument("--long-wave", action="store_true",
                      help="the threshold as k -> 0, even where waves of finite length grow on its stable side")


def _run(arguments: argparse.Namespace) -> int:
    flow, options = checked(arguments), options_of(arguments)
    vary, where = check_vary(flow, arguments), searched(arguments)

    def compute() -> "NeutralPoint":
        from ...studies.critical import critical

        return critical(flow_of(arguments), vary, long_wave=arguments.long_wave, strict=False, **where, **options)

    return report(arguments, compute)
