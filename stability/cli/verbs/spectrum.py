"""stability spectrum: the least stable modes at one wavenumber."""

import argparse
from dataclasses import replace
from typing import Any

from ...checks import check_integer
from ...studies.spectrum import MOST_MODES, Spectra, ill_posed_remarks, spectra
from ..common import accuracy_of, accuracy_options, add_verb, collect, flow_of, k_option, report
from ..specs import parse_spec


def add(verbs: Any) -> None:
    add_verb(verbs, "spectrum", _run, "stability spectrum vortex --k 2 --modes 5",
             k_option, _modes_option,
             accuracy_options)


def _modes_option(verb: Any) -> None:
    verb.add_argument("--modes", default="10", metavar="M", help="how many modes (default 10)")


def _run(arguments: argparse.Namespace) -> int:
    flow, accuracy = flow_of(arguments), accuracy_of(arguments)
    count = check_integer(arguments.modes, "--modes", 1, MOST_MODES)
    wavenumbers = parse_spec(arguments.k, "--k")

    def compute() -> Any:
        parts = spectra(flow, wavenumbers.tolist(), count, accuracy)
        found = collect(arguments, parts, len(wavenumbers), lambda done: [])
        missing, remarks = wavenumbers.tolist()[len(found):], ill_posed_remarks(found)
        if len(wavenumbers) == 1:
            return replace(found[0], remarks=remarks)
        return Spectra(flow, tuple(found), tuple(missing), remarks)

    return report(arguments, compute)
