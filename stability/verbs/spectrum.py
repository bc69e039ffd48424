"""stability spectrum: the least stable modes at one wavenumber."""

from ..checks import check_integer
from ..specs import parse_spec
from ..spectra import MOST, spectrum
from ..status import INTERRUPTED
from ..wellposed import notes_on
from .common import accuracy_options, add_verb, collect, flow_of, k_option, options_of, report


def add(verbs):
    add_verb(verbs, "spectrum", _run, "the least stable modes at one wavenumber",
             "stability spectrum vortex --k 2 --modes 5", k_option, _modes_option,
             accuracy_options)


def _modes_option(verb):
    verb.add_argument("--modes", default="10", metavar="M", help="how many modes (default 10)")


def _run(arguments):
    flow, options = flow_of(arguments), options_of(arguments)
    count = check_integer(arguments.modes, "--modes", 1, MOST)
    wavenumbers = parse_spec(arguments.k, "--k")

    def compute():
        spectra = (spectrum(flow, k, count, strict=False, **options) for k in wavenumbers.tolist())
        found = collect(arguments, spectra, len(wavenumbers), lambda done: [])
        rows = [row for one in found for row in one.rows()]
        rows += [dict.fromkeys(rows[0]) | {"k": k, "status": INTERRUPTED} for k in wavenumbers.tolist()[len(found):]]
        return rows, found, notes_on(found)

    return report(arguments, flow, compute)
