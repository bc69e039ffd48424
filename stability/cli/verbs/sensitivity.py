"""stability sensitivity: how growth rate and phase speed change with every parameter."""

import argparse
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ...errors import ModeLost, ParameterError
from ...studies.choices import MODES
from ..asked import checked, flow_of
from ..common import accuracy_options, add_verb, options_of, report
from ..specs import parse_one

if TYPE_CHECKING:
    from ...studies.sensitivity import Sensitivities

_MODES = MODES[:2]  # a mode that can be followed


def add(verbs: Any) -> None:
    add_verb(verbs, "sensitivity", _run, "stability sensitivity dune --k 1 --plot dune.png",
             _k_option, _mode_option, accuracy_options)


def _k_option(verb: Any) -> None:
    verb.add_argument("--k", required=True, metavar="K", help="wavenumber")


def _mode_option(verb: Any) -> None:
    verb.add_argument("--mode", metavar="MODE", help=f"one of {', '.join(_MODES)}; default: surface where the flow has "
                      "a slow surface mode")


def _run(arguments: argparse.Namespace) -> int:
    checked(arguments)
    options = options_of(arguments)
    k = parse_one(arguments.k, "--k", "wavenumber")
    if arguments.mode and arguments.mode not in _MODES:
        raise ParameterError(f"--mode: must be one of {', '.join(_MODES)} (got {arguments.mode!r})")

    def compute() -> "Sensitivities":
        from ...studies.dispersion import default_mode, dispersion
        from ...studies.sensitivity import sensitivities

        flow = flow_of(arguments)
        mode = arguments.mode or default_mode(flow)
        relation = dispersion(flow, k, mode, strict=False, **options)
        for reason in relation.lost.values():
            raise ModeLost(reason)
        return replace(sensitivities(relation.modes[0]), settings={"mode": mode, **options})

    return report(arguments, compute)
