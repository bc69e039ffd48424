"""stability dispersion: growth rate and phase speed over wavenumbers."""

from ..errors import ParameterError
from ..relation import MODES, DispersionRelation, default_mode, dispersion
from ..specs import parse_spec
from .common import add_verb, flow_of, k_option, options_of, progress, report
from .methods import INTERRUPTED, INTERRUPTED_STATUS, method_of, method_options


def add(verbs):
    add_verb(verbs, "dispersion", _run, "growth rate and phase speed over wavenumbers",
             "stability dispersion dune --Re 100 --k 1e-2:10:50 --plot dune.png",
             k_option, _mode_option, method_options)


def _mode_option(verb):
    verb.add_argument("--mode", metavar="MODE", help=f"one of {', '.join(MODES)}; default: surface where the flow has "
                      "a slow surface mode, else the leading mode of the smallest k, followed")


def _run(arguments):
    flow, options = flow_of(arguments), options_of(arguments)
    wavenumbers = parse_spec(arguments.k, "--k")
    arguments.mode = arguments.mode or default_mode(flow)
    if arguments.mode not in MODES:
        raise ParameterError(f"--mode: must be one of {', '.join(MODES)} (got {arguments.mode!r})")
    bvp = method_of(arguments, flow, options["tolerance"])
    if not bvp:
        return report(arguments, flow, lambda: _collocation(flow, wavenumbers, arguments.mode, options))
    if arguments.mode != MODES[0]:
        raise ParameterError(f"--mode {arguments.mode}: --method {arguments.method} follows the surface mode only")
    lost = {}
    status = report(arguments, flow, lambda: _continuation(arguments, flow, wavenumbers, bvp, lost))
    return INTERRUPTED_STATUS if INTERRUPTED in lost.values() else status


def _collocation(flow, wavenumbers, mode, options):
    relation = dispersion(flow, wavenumbers, mode, strict=False, **options)
    return relation.rows(), relation, relation.notes()


def _continuation(arguments, flow, wavenumbers, bvp, lost):
    """Rows, result and notes of a continuation; fills `lost`."""
    from ..continuation import continue_in_k

    found = continue_in_k(flow, wavenumbers, report=lambda done, total: progress(arguments, done, total), **bvp)
    lost.update(found.lost)
    points = {point.k: point for point in found.points}
    asked = tuple(wavenumbers.tolist())
    relation = DispersionRelation(flow, MODES[0], tuple(points[k] for k in asked if k in points), found.lost, (), asked,
                                  arguments.method)
    return relation.rows(), relation, relation.notes()
