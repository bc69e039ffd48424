"""stability dispersion: growth rate and phase speed over wavenumbers."""

from ..errors import ParameterError
from ..relation import MODES, dispersion
from ..specs import parse_spec
from .common import add_verb, flow_of, k_option, lost_row, mode_row, options_of, report


def add(verbs):
    add_verb(verbs, "dispersion", _run, "growth rate and phase speed over wavenumbers",
             "stability dispersion dune --Re 100 --k 1e-2:10:50 --plot dune.png", k_option, _mode_option)


def _mode_option(verb):
    verb.add_argument("--mode", default=MODES[0], metavar="MODE", help=f"{' or '.join(MODES)} (default {MODES[0]})")


def _run(arguments):
    flow, options = flow_of(arguments), options_of(arguments)
    wavenumbers = parse_spec(arguments.k, "--k")
    if arguments.mode not in MODES:
        raise ParameterError(f"--mode: must be one of {', '.join(MODES)} (got {arguments.mode!r})")

    def compute():
        relation = dispersion(flow, wavenumbers, arguments.mode, strict=False, **options)
        found = {mode.k: mode for mode in relation.modes}
        rows = [mode_row(found[k]) if k in found else lost_row(k) for k in wavenumbers.tolist()]
        notes = sorted({str(collision) for collision in relation.collisions} | set(relation.lost.values()))
        return rows, relation, notes

    return report(arguments, flow, compute)
