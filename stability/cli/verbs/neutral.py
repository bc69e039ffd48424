"""stability neutral: where growth vanishes, over a second parameter or over wavenumbers."""

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ...errors import ParameterError
from ...status import INTERRUPTED
from ..asked import check_vary, sweep_of, swept
from ..common import SPEC, accuracy_options, add_verb, collect, options_of
from ..families import answer, each_option
from ..specs import Spec, read_spec
from .critical import long_wave_option, range_option, searched, vary_option

if TYPE_CHECKING:
    from ...flows.base import Flow
    from ...flows.declaration import Declaration
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

    def ask(flow: "Declaration") -> Callable[..., Any]:
        vary = check_vary(flow, arguments)
        if arguments.k is None:
            over = swept(arguments.over, flow)
            if over[0] == vary:
                raise ParameterError(f"--over: {vary} is the parameter to solve for; sweep another one")
            where = searched(arguments)
            return lambda flow: _over(arguments, flow, vary, over, {**where, **options})
        spec, where = read_spec(arguments.k, "--k"), searched(arguments)
        return lambda flow: _curve(arguments, flow, vary, spec, {**where, **options})

    return answer(arguments, ask)


def _over(arguments: argparse.Namespace, flow: "Flow", vary: str, over: tuple[str, Spec],
          options: dict[str, Any]) -> Callable[..., Any]:
    from ...studies.critical import NeutralPoint, NeutralSweep, critical_sweep

    sweep = sweep_of(flow, over)

    def compute() -> "NeutralSweep":
        found = collect(arguments, critical_sweep(sweep, vary, long_wave=arguments.long_wave, **options), len(sweep),
                        lambda done: [NeutralPoint(one, vary, None, None, None, None, None, INTERRUPTED)
                                      for one in sweep[done:]])
        return NeutralSweep(flow, vary, over[0], tuple(found))

    return compute


def _curve(arguments: argparse.Namespace, flow: "Flow", vary: str, spec: Spec,
           options: dict[str, Any]) -> Callable[..., Any]:
    import numpy as np

    from ...studies.critical import NeutralPoint
    from ...studies.neutral import NeutralCurve, joined_curve, neutral_parts

    wavenumbers = spec.array

    def compute() -> "NeutralCurve":
        def rest(done: Any) -> Any:
            points = (NeutralPoint(flow, vary, k, None, None, None, None, INTERRUPTED)
                      for k in wavenumbers[done:].tolist())
            return [NeutralCurve(flow, vary, tuple(points), np.empty((0, 2)))]

        parts = neutral_parts(flow, vary, wavenumbers, **options)
        return joined_curve(collect(arguments, parts, len(wavenumbers), rest))

    return compute
