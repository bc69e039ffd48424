"""stability neutral: where growth vanishes, over a second parameter or over wavenumbers."""

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ...errors import ParameterError
from ...status import INTERRUPTED
from ..common import SPEC, accuracy_options, add_verb, collect, options_of, sweep_of
from ..families import answer, each_option
from ..specs import parse_spec
from .critical import long_wave_option, range_option, searched, vary_option

if TYPE_CHECKING:
    from ...flows.base import Flow
    from ...studies.critical import NeutralSweep
    from ...studies.neutral import NeutralCurve


def add(verbs: Any) -> None:
    add_verb(verbs, "neutral", _run, "stability neutral poiseuille --vary Re --k 0.8:1.09:30:lin --plot neutral.png",
             vary_option, range_option, _over_or_k_option, each_option,
             long_wave_option, accuracy_options)


def _over_or_k_option(verb: Any) -> None:
    either = verb.add_mutually_exclusive_group(required=True)
    either.add_argument("--over", metavar="NAME=SPEC",
                        help=f"second parameter: zero growth of the most unstable wavenumber at each value; {SPEC}")
    either.add_argument("--k", metavar="SPEC",
                        help=f"wavenumbers: all branches of the neutral curve at each; {SPEC}")


def _run(arguments: argparse.Namespace) -> int:
    if arguments.k is not None and arguments.long_wave:
        raise ParameterError("--long-wave: has no meaning with --k; use --over, or the verb critical")
    options = options_of(arguments)
    return answer(arguments, lambda flow: (_over if arguments.k is None else _curve)(arguments, flow, options))


def _over(arguments: argparse.Namespace, flow: "Flow", options: dict[str, Any]) -> Callable[..., Any]:
    from ...studies.critical import NeutralPoint, NeutralSweep, critical_sweep

    vary = _vary(arguments, flow)
    name, sweep = sweep_of(arguments, flow)
    if name == vary:
        raise ParameterError(f"--over: {name} is the parameter to solve for; sweep another one")

    def compute() -> "NeutralSweep":
        found = collect(arguments, critical_sweep(sweep, vary, long_wave=arguments.long_wave, **searched(arguments),
                                                  **options), len(sweep),
                        lambda done: [NeutralPoint(one, vary, None, None, None, None, None, INTERRUPTED)
                                      for one in sweep[done:]])
        return NeutralSweep(flow, vary, name, tuple(found))

    return compute


def _curve(arguments: argparse.Namespace, flow: "Flow", options: dict[str, Any]) -> Callable[..., Any]:
    import numpy as np

    from ...studies.critical import NeutralPoint
    from ...studies.neutral import NeutralCurve, joined_curve, neutral_parts

    vary, wavenumbers = _vary(arguments, flow), parse_spec(arguments.k, "--k")

    def compute() -> "NeutralCurve":
        def rest(done: Any) -> Any:
            points = (NeutralPoint(flow, vary, k, None, None, None, None, INTERRUPTED)
                      for k in wavenumbers[done:].tolist())
            return [NeutralCurve(flow, vary, tuple(points), np.empty((0, 2)))]

        parts = neutral_parts(flow, vary, wavenumbers, **searched(arguments), **options)
        return joined_curve(collect(arguments, parts, len(wavenumbers), rest))

    return compute


def _vary(arguments: argparse.Namespace, flow: "Flow") -> str:
    from ...flows.base import check_parameter_name

    return check_parameter_name(flow, arguments.vary.replace("-", "_"))
