"""Results are finished: printing, hashing, pickling, drawing and writing them solves nothing."""

import json
import pickle
from collections import Counter

import numpy as np
import pytest
import scipy.linalg
from matplotlib.figure import Figure
from results import RECORDS, SELDOM, made

from stability import dispersion, flows
from stability.bvp import problem
from stability.equations.system import System
from stability.modes import dense, energy, short_waves, solver
from stability.numerics import bordered
from stability.output.record import Record
from stability.status import Status

SOLVERS = [(bordered, "Factors"), (bordered, "ManyFactors"), (solver, "refine"), (solver, "refine_many"),
           (solver.Solver, "__init__"), (System, "__init__"), (dense, "finite_rates"), (dense, "_eigenvalues"),
           (problem, "solve_bvp"), (short_waves, "_coefficients"), (energy, "energy"),
           *((np.linalg, name) for name in ("eig", "eigvals", "eigh", "eigvalsh", "solve", "inv", "lstsq", "svd")),
           *((scipy.linalg, name) for name in ("eig", "eigvals", "solve", "lu_factor", "qr"))]


@pytest.fixture
def solved(monkeypatch):
    """How often each solver was called, {name: calls}; all of them are counted."""
    calls: Counter = Counter()

    def counted(place, name):
        plain = getattr(place, name)

        def call(*args, **options):
            calls[f"{place.__name__}.{name}"] += 1
            return plain(*args, **options)

        monkeypatch.setattr(place, name, call)

    for place, name in SOLVERS:
        counted(place, name)
    return calls


def everything(result, folder):
    """All that can be done with a result without a new question."""
    repr(result)
    hash(result)
    pickle.loads(pickle.dumps(result))
    result.plot(Figure().add_subplot())
    if not isinstance(result, Record):
        return
    json.dumps(result.rows())
    result.header(), result.notes(), result.columns(), len(result), result[0], list(result), result._repr_html_()
    assert all(isinstance(row.get("status"), Status) for row in result)
    for form in ("csv", "json", "netcdf"):
        getattr(result, f"to_{form}")(folder / f"x.{form}")


SLOW = {"neutral", "critical", "no critical", "neutral sweep"}  # of which there are short ones
KINDS = sorted({*RECORDS, "map", *SELDOM} - SLOW)


@pytest.mark.parametrize("name", KINDS)
def test_a_result_solves_nothing_once_it_is_made(name, tmp_path, request):
    result = made(name)
    solved = request.getfixturevalue("solved")
    everything(result, tmp_path)
    assert not solved


def test_every_kind_of_result_is_asked():
    """All classes of results that are made anywhere in the package."""
    def below(one):
        return {one, *(other for kind in one.__subclasses__() for other in below(kind))}

    kinds = {type(made(name)) for name in KINDS}
    assert {kind.__name__ for kind in below(Record) - kinds} == {"Record", "ZeroGrowth"}


@pytest.mark.parametrize("question", [lambda: dispersion(flows.Vortex(), [1.0, 2.0]).rows(),
                                      lambda: energy.condition_numbers(dispersion(flows.Vortex(), 1.0).modes),
                                      lambda: short_waves.ill_posed_strips(flows.Dune())])
def test_what_does_solve_is_counted(question, solved):
    question()
    assert solved
