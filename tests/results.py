"""One result of every kind, by name, and the commands that give the same."""

from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from stability import dispersion, flows, k_max, load, spectrum
from stability.bvp.continuation import Continuation
from stability.studies.base import base_flow
from stability.studies.compare import Comparison, Measurement, Reference
from stability.studies.critical import NeutralSweep, critical, critical_sweep
from stability.studies.family import Family
from stability.studies.kmax import Optima, k_max_sweep
from stability.studies.map import parameter_map
from stability.studies.neutral import neutral_curve
from stability.studies.sensitivity import sensitivities
from stability.studies.spectrum import Spectra
from stability.studies.wellposed import growth_with_degree, ill_posedness

BED, FILM = flows.Dune(), flows.Film()
LOST = {"mode": "most-unstable", "max_degree": 14, "strict": False}


def sensitivity():
    relation = dispersion(BED, 1.0)
    return replace(sensitivities(relation.modes[0]), settings={"mode": relation.mode, **relation.settings})


def sweep():
    return Optima(BED, "Re", tuple(k_max_sweep(replace(BED, Re=Re) for Re in (10.0, 1.0))))


RECORDS = {
    "dispersion": lambda: dispersion(BED, [1.0, 0.01, 3.0], rivals=True),
    "pair": lambda: dispersion(flows.Vortex(Fr2=5.0), [0.1, 1.0, 10.0]),
    "unresolved": lambda: dispersion(flows.Dune(shields=3.0), [8.0, 1.0], **LOST),
    "outgrown": lambda: dispersion(flows.Dune(shields=1.05, mu1=0.7), [3.0, 10.0], rivals=True),
    "spectrum": lambda: spectrum(flows.Vortex(), 2.0, 3),
    "optimum": lambda: k_max(BED),
    "none": lambda: k_max(flows.Vortex(), strict=False),
    "sweep": sweep,
    "neutral": lambda: neutral_curve(flows.Poiseuille(), "Re", [1.0, 1.2]),
    "critical": lambda: critical(flows.Film(slope_deg=45.0), "Re"),
    "no critical": lambda: critical(flows.Vortex(), "slope_deg", strict=False),
    "sensitivity": sensitivity,
    "neutral sweep": lambda: NeutralSweep(FILM, "Re", "We", tuple(critical_sweep([FILM, replace(FILM, We=1)], "Re"))),
    "spectra": lambda: Spectra(flows.Vortex(), tuple(spectrum(flows.Vortex(), k, 2) for k in (1.0, 2.0))),
}
COMMANDS = {
    "dispersion": "dispersion dune --k 1,0.01,3",
    "pair": "dispersion vortex --Fr2 5 --k 0.1,1,10",
    "unresolved": "dispersion dune --shields 3 --k 8,1 --mode most-unstable --max-degree 14",
    "outgrown": "dispersion dune --shields 1.05 --mu1 0.7 --k 3,10",
    "spectrum": "spectrum vortex --k 2 --modes 3",
    "optimum": "kmax dune",
    "none": "kmax vortex",
    "sweep": "kmax dune --over Re=10,1",
    "neutral": "neutral poiseuille --vary Re --k 1,1.2",
    "sensitivity": "sensitivity dune --k 1",
    "critical": "critical film --slope-deg 45 --vary Re",
    "no critical": "critical vortex --vary slope_deg",
    "neutral sweep": "neutral film --vary Re --over We=0,1",
    "spectra": "spectrum vortex --k 1,2 --modes 2",
}

OTHERS = {
    "mode": lambda: dispersion(BED, 1.0).modes[0],
    "map": lambda: parameter_map(BED, {"Re": [1.0, 10.0]}),
    "continuation": lambda: Continuation((), {1.0: "why"}),
}


def family():
    beds = [replace(BED, Re=Re) for Re in (1.0, 10.0)]
    return Family(BED, "Re", tuple(dispersion(bed, [0.5, 1.0], rivals=True) for bed in beds))


def stored():
    with TemporaryDirectory() as folder:
        path = Path(folder) / "x.json"
        dispersion(BED, [0.5, 1.0], rivals=True).to_json(path)
        return load(path)


POINT = {"span": (1.0, 1.5), "long_wave": True}
SELDOM = {  # kinds of results that the tests of files and figures above do without
    "map of growth": lambda: parameter_map(BED, {"Re": [1.0, 10.0]}, k=[1.0]),
    "long-wave threshold": lambda: critical(flows.Film(slope_deg=45.0), "Re", **POINT),
    "long-wave thresholds": lambda: NeutralSweep(FILM, "Re", "We", (made("long-wave threshold"),)),
    "nose": lambda: neutral_curve(flows.Poiseuille(), "Re", [1.02], span=(5700.0, 5900.0)),
    "base": lambda: base_flow(BED, 5),
    "comparison": lambda: Comparison(flows.Vortex(), 1.0, Reference(-1 + 0j, 0.0, "exact"), (
        Measurement("collocation", "degree 12", -1 + 0j, 1e-15, 2e-15, 1e-3, 52),), ()),
    "ill-posed spectrum": lambda: spectrum(flows.Dune(shields=1.05, mu1=0.7), 10.0, 2, rivals=True),
    "outgrown optimum": lambda: k_max(flows.Dune(shields=1.02, mu1=0.7, Re=3e3)),
    "leading": lambda: dispersion(flows.RollWave(slope_deg=32.6), 1.0, "leading"),
    "strips": lambda: ill_posedness(BED, 5, growth_with_degree(BED, [1.0, 10.0])),
    "growth": lambda: ill_posedness(BED, 5, growth_with_degree(BED, [1.0]), np.array([1.0])),
    "family": family,
    "stored": stored,
}


@cache
def made(name):
    """The result of that name, made once."""
    return {**RECORDS, **OTHERS, **SELDOM}[name]()
