"""stability spectrum: the least stable modes at one wavenumber."""

import argparse
from dataclasses import replace
from typing import Any

from ...checks import check_integer
from ...studies.choices import MOST_MODES
from ..asked import checked, flow_of
from ..common import accuracy_of, accuracy_options, add_verb, collect, k_option, report
from ..specs import read_spec


def add(verbs: Any) -> None:
    add_verb(verbs, "spectrum", _run, "stability spectrum vortex --k 2 --modes 5",
             k_option, _modes_option,
             accuracy_options)


def _modes_option(verb: Any) -> None:
    verb.add_argument("--modes", default="10", metavar="M", help="how many modes (default 10)")


def _run(arguments: argparse.Namespace) -> int:
    checked(arguments)
    accuracy = accuracy_of(arguments)
    count = check_integer(arguments.modes, "--modes", 1, MOST_MODES)
    spec = read_spec(arguments.k, "--k")

    def compute() -> Any:
        from ...studies.spectrum import Spectra, ill_posed_remarks, spectra

        flow, wavenumbers = flow_of(arguments), spec.array
        parts = spectra(flow, wavenumbers.tolist(), count, accuracy)
        found = collect(arguments, parts, len(wavenumbers), lambda done: [])
        missing, remarks = wavenumbers.tolist()[len(found):], ill_posed_remarks(found)
        if len(wavenumbers) == 1:
            return replace(found[0], remarks=remarks)
        return Spectra(flow, tuple(found), tuple(missing), remarks)

    return report(arguments, compute)
