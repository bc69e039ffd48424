"""A pencil without w and n has the eigenvalues and the vectors of the whole one, and where it is not formed."""

import numpy as np
import pytest

from stability import dispersion, spectrum
from stability.equations.condensed import condensable, sparing
from stability.flows import Dune, Film, Plate, Poiseuille, Regularised, RollWave, Saturating, TwoLayerCouette, Vortex
from stability.modes import dense
from stability.modes.solver import Solver

FLOWS = {"creeping": Dune(law=Regularised()), "yielding": Dune(shields=1.5, law=Saturating()),
         "with a fluid": Dune(shields=1.5, law=Saturating(), fluid="layer"), "plate": Plate(law=Regularised())}
BANDS = {"bed": Dune(), "half a channel": Poiseuille(Re=1000.0).halves()[0], "surface": Film(), "across": Vortex(),
         "downslope": RollWave(), "two fluids": TwoLayerCouette()}


def case(flow, k=1.3, degree=20):
    """A solver, its pencil, weights and a mode at this degree."""
    solver = Solver(flow)
    near = dispersion(flow, k).modes[0] if flow.has_surface_mode() else spectrum(flow, k, 1, strict=False).modes[0]
    mode = solver.solve(k, near.rate, (near.degree, near.x, near.y), degree, glance=True)
    return solver.pencil(degree), solver.weights(k), mode


@pytest.mark.parametrize("flow", [*FLOWS.values(), *BANDS.values()], ids=[*FLOWS, *BANDS])
def test_eigenvalue_and_vectors(flow):
    pencil, weights, mode = case(flow)
    condensed, x, y = pencil.condensed_for(10**6), mode.x, mode.y.conj()
    assert len(condensed.restricted(x, y)[0]) < 0.6 * pencil.size
    again = condensed.continued(weights.value * pencil.powers(mode.rate), *condensed.restricted(x, y))
    for found, expected in zip(again, (x, y), strict=True):
        np.testing.assert_allclose(found, expected, atol=1e-11 * np.abs(expected).max())
    own, kept = condensed.weights(weights.value), condensed.restricted(x, y)
    b, _ = condensed.b_products(own)
    guess = mode.rate * 1.001
    ahead = condensed.factors(own, guess).solve(b(kept[0]))
    pivot = np.abs(kept[0]).argmax()
    np.testing.assert_allclose(guess + kept[0][pivot] / ahead[pivot], mode.rate, rtol=1e-10)
    off = own * np.where(np.arange(len(own)) == 2, 1.01, 1.0)
    ahead = condensed.factors(off, guess).solve(b(kept[0]))
    assert abs(guess + kept[0][pivot] / ahead[pivot] - mode.rate) > 1e-6 * abs(mode.rate)


def test_many_points_are_those_of_each():
    """Many wavenumbers at once are refined in condensed form, one alone in full."""
    flow = FLOWS["creeping"]
    k = np.geomspace(0.5, 0.8, 9)
    many = dispersion(flow, k)
    for mode in many.modes[1:-1:3]:
        alone = Solver(flow).solve(mode.k, mode.rate * 1.0001, (mode.degree, mode.x, mode.y))
        assert abs(alone.sigma - mode.sigma) <= alone.error + mode.error
        assert abs(alone.slope - mode.slope) <= 1e-9 * abs(mode.slope)
        assert 0.2 < mode.error / alone.error < 5


@pytest.mark.parametrize("flow", BANDS.values(), ids=BANDS)
def test_bands_stay_bands(flow):
    """Half as many unknowns lie in bands no wider, or in what is full anyway; they are formed for many points alone."""
    pencil = Solver(flow).pencil(48)
    assert pencil.condensed_for(1) is None
    condensed = pencil.condensed_for(200)
    assert condensed.entries < 0.75 * pencil.entries
    assert pencil.condensed_for(1) is condensed  # once they are there


@pytest.mark.parametrize("flow", BANDS.values(), ids=BANDS)
def test_all_eigenvalues(monkeypatch, flow):
    """The dense problem of the condensed form, where that has the rate in half of the rows, has the same ones."""
    solver = Solver(flow)
    symbols, layout = solver.symbols(1.3), solver.pencil(24).layout
    newtonian = type(flow).__name__ not in ("Dune", "RollWave")
    assert sparing(layout) == newtonian
    fewer, rows = len(layout.arrangement.reduced.rate_rows), len(layout.rate_rows)
    assert (fewer < 0.6 * rows) == newtonian
    condensed = dense.finite_rates(solver, 24, symbols)
    monkeypatch.setattr(dense, "sparing", lambda layout: False)
    whole = dense.finite_rates(solver, 24, symbols)
    assert len(condensed) == len(whole)
    np.testing.assert_allclose(condensed[:5], whole[:5], rtol=1e-9)


def test_where_it_is_not_formed():
    """Not of bands for one eigenvalue. An equation with another slope, and a condition with the rate times w, is none
    of this kind."""
    assert Solver(Poiseuille()).pencil(48).condensed is None
    layout = Solver(FLOWS["yielding"]).pencil(20).layout
    assert condensable(layout)
    rows = layout.structure.rows
    for number, terms in ((1, (*rows[1].terms, ("bed.w", ("k",), (0,)))), (1, (*rows[1].terms, ("bed.v'", (), (0,)))),
                          (len(rows) - 1, (*rows[-1].terms, ("bed.w@1", ("rate",), (0,))))):
        structure = changed(layout.structure, number, terms)
        assert not condensable(type("Other", (), {"structure": structure}))


def changed(structure, number, terms):
    from dataclasses import replace

    rows = list(structure.rows)
    rows[number] = replace(rows[number], terms=terms)
    return replace(structure, rows=tuple(rows))
