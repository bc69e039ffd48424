"""stability kmax: the fastest growing wavenumber, over a parameter."""

import argparse
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from ...errors import ParameterError, StabilityError
from ...status import INTERRUPTED, unresolved
from ...studies.choices import CREST_MODES
from ..asked import sweep_of, swept
from ..common import SPEC, accuracy_options, add_verb, collect, options_of
from ..families import answer, each_option
from ..methods import bvp_settings, check_method, method_of, method_options
from ..specs import Spec
from .critical import search_option, searched

if TYPE_CHECKING:
    from ...flows.base import Flow
    from ...flows.declaration import Declaration
    from ...studies.kmax import Optimum


def add(verbs: Any) -> None:
    add_verb(verbs, "kmax", _run, "stability kmax dune --over Re=0.1:1e4:41 --plot kmax.png",
             _over_option, each_option, _mode_option, search_option, method_options, accuracy_options)


def _over_option(verb: Any) -> None:
    verb.add_argument("--over", metavar="NAME=SPEC", help=f"parameter to sweep and its values: {SPEC}")


def _mode_option(verb: Any) -> None:
    verb.add_argument("--mode", metavar="MODE", help=f"one of {', '.join(CREST_MODES)}: the slow surface mode alone "
                      "(default of flows that are ill posed), or the fastest of all modes (default elsewhere)")


def _run(arguments: argparse.Namespace) -> int:
    if arguments.mode and arguments.mode not in CREST_MODES:
        raise ParameterError(f"--mode: must be one of {', '.join(CREST_MODES)} (got {arguments.mode!r})")
    options = options_of(arguments)

    def ask(declared: "Declaration") -> Callable[..., Any]:
        over = None if arguments.over is None else swept(arguments.over, declared)
        check_method(arguments)
        where = searched(arguments)
        return lambda flow: _question(arguments, flow, over, {**where, **options})

    return answer(arguments, ask)


def _question(arguments: argparse.Namespace, flow: "Flow", over: tuple[str, Spec] | None,
              options: dict[str, Any]) -> Callable[..., Any]:
    from ...studies.kmax import Optima, Optimum, k_max_sweep

    name, sweep = (None, [flow]) if over is None else (over[0], sweep_of(flow, over))
    bvps = [method_of(arguments, one, options["tolerance"]) for one in sweep]
    if bvps[0] is not None and not flow.has_surface_mode():
        raise ParameterError(f"--method {arguments.method}: {flow.name} has no slow surface mode, the one that is "
                             "continued; leave it out")
    for option in ("mode", "search"):
        if bvps[0] is not None and getattr(arguments, option) is not None:
            raise ParameterError(f"--{option}: --method {arguments.method} does not use it; leave it out")

    def compute() -> Any:
        optima = map(_bounded, sweep, bvps) if bvps[0] is not None else \
            k_max_sweep(sweep, mode=arguments.mode, **options)
        found = collect(arguments, optima, len(sweep),
                        lambda done: [Optimum(one, (), INTERRUPTED) for one in sweep[done:]])
        return Optima(flow, name, tuple(found), arguments.method)

    return compute


def _bounded(flow: "Flow", bvp: Any) -> "Optimum":
    """The optimum of a flow by bounded minimisation over solve_bvp's growth rates; the first maximum only."""
    from ...bvp.continuation import bounded_maximum
    from ...studies.kmax import Optimum

    settings = bvp_settings(bvp)
    try:
        found = bounded_maximum(flow, **bvp)
    except StabilityError as reason:
        return Optimum(flow, (), unresolved(reason), settings)
    return Optimum(flow, (found,), found.mode.status, settings)
