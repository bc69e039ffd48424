"""stability spectrum: the least stable modes at one wavenumber."""

from ..energy import condition_numbers
from ..relation import dispersion
from ..specs import parse_spec
from ..spectra import spectrum
from ..wellposed import outgrown, well_posedness
from .common import RESOLVED, add_verb, flow_of, integer, k_option, mode_row, options_of, report


def add(verbs):
    add_verb(verbs, "spectrum", _run, "the least stable modes at one wavenumber",
             "stability spectrum vortex --k 2 --modes 5", k_option, _modes_option)


def _modes_option(verb):
    verb.add_argument("--modes", default="10", metavar="M", help="how many modes (default 10)")


def _run(arguments):
    flow, options = flow_of(arguments), options_of(arguments)
    count = integer(arguments.modes, "--modes", 1, 200)
    wavenumbers = parse_spec(arguments.k, "--k")

    def compute():
        found = [spectrum(flow, k, count, strict=False, **options) for k in wavenumbers.tolist()]
        return [row for one in found for row in _rows(one)], found, _warnings(flow, wavenumbers, found)

    return report(arguments, flow, compute)


def _rows(one):
    """Rows of the modes; `condition` is the condition number of the eigenvalue in the energy norm."""
    for mode, condition in zip(one.modes, condition_numbers(one.modes).tolist(), strict=True):
        row = mode_row(mode)
        status = row.pop("status")
        yield {**row, "condition": condition, "status": status}


def _warnings(flow, wavenumbers, found):
    """What an ill-posed flow does to its spectrum: modes that do not converge, internal modes that lead it."""
    strips = well_posedness(flow).strips
    if not strips:
        return []
    notes = [f"{flow}, k = {one.k:g}: the spectrum does not converge; {'; '.join(map(str, strips))}"
             for one in found if any(mode.status != RESOLVED for mode in one.modes)]
    faster = outgrown(dispersion(flow, wavenumbers, strict=False)) if flow.has_surface_mode() else None
    return [*notes, f"{flow}: {faster}"] if faster else notes
