"""stability dispersion: growth rate and phase speed over wavenumbers."""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ...errors import ParameterError
from ...status import INTERRUPTED
from ...studies.choices import MODES
from ..common import accuracy_options, add_verb, collect, k_option, options_of
from ..families import answer, each_option
from ..methods import bvp_settings, check_method, method_of, method_options
from ..specs import Spec, read_spec

if TYPE_CHECKING:
    import numpy as np

    from ...flows.base import Flow
    from ...flows.declaration import Declaration
    from ...studies.dispersion import DispersionRelation


def add(verbs: Any) -> None:
    add_verb(verbs, "dispersion", _run, "stability dispersion dune --Re 100 --k 1e-2:10:50 --plot dune.png",
             k_option, each_option, _mode_option, method_options, accuracy_options)


def _mode_option(verb: Any) -> None:
    verb.add_argument("--mode", metavar="MODE", help=f"one of {', '.join(MODES)}; default: surface where the flow has "
                      "a slow surface mode, else the leading mode of the smallest k, followed")


def _run(arguments: argparse.Namespace) -> int:
    options = options_of(arguments)
    wavenumbers = read_spec(arguments.k, "--k")
    if arguments.mode is not None and arguments.mode not in MODES:
        raise ParameterError(f"--mode: must be one of {', '.join(MODES)} (got {arguments.mode!r})")

    def ask(declared: "Declaration") -> Callable[..., Any]:
        check_method(arguments)
        return lambda flow: _question(arguments, flow, wavenumbers, options)

    return answer(arguments, ask)


def _question(arguments: argparse.Namespace, flow: "Flow", spec: Spec, options: dict[str, Any]) -> Callable[..., Any]:
    from ...studies.dispersion import DispersionRelation, default_mode, dispersion_parts, joined_relation, judged

    wavenumbers = spec.array
    mode = arguments.mode or default_mode(flow)
    bvp = method_of(arguments, flow, options["tolerance"])
    if bvp and mode != MODES[0]:
        raise ParameterError(f"--mode {mode}: --method {arguments.method} follows the surface mode only")

    def compute() -> "DispersionRelation":
        parts = _continued(flow, wavenumbers, **bvp) if bvp else dispersion_parts(flow, wavenumbers, mode, **options)
        missing = DispersionRelation(flow, mode, (), dict.fromkeys(wavenumbers.tolist(), INTERRUPTED), ())
        found = collect(arguments, parts, len(wavenumbers), lambda done: [missing], lambda part: len(part.modes))
        return judged(replace(joined_relation(found, wavenumbers.tolist()), method=arguments.method,
                              settings=bvp_settings(bvp, options)))

    return compute


def _continued(flow: "Flow", wavenumbers: "np.ndarray", **bvp: Any) -> Iterator[Any]:
    """The surface mode by continuation, point by point."""
    from ...bvp.continuation import steps_in_k
    from ...studies.dispersion import DispersionRelation

    for part in steps_in_k(flow, wavenumbers, **bvp):
        yield DispersionRelation(flow, MODES[0], part.points, part.lost, ())
