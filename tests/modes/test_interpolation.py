"""What lies between the nodes of a walk: guesses of rates and vectors, and the degrees at which they are refined."""

from types import SimpleNamespace

import numpy as np
import pytest

from stability import dispersion, flows
from stability.modes import memory
from stability.modes.interpolation import interpolated, intervals
from stability.modes.solver import Solver
from stability.modes.surface import surface_branch


def node(k, degree=8):
    """Of a mode whose rate is exp(2i log k) and whose vectors have the components t, t^2, t^3 with t = log k."""
    t = np.log(k)
    vector = np.array([1.0, t, t**2, t**3], complex)
    return SimpleNamespace(k=k, rate=np.exp(2j * t), rate_slope=2j * np.exp(2j * t) / k, degree=degree, x=vector,
                           y=3j * vector)


def test_rates_by_values_and_slopes_at_four_nodes():
    """The error falls by 2^8 where nodes lie twice as close; vectors are exact up to cubics, but for their scale."""
    errors = []
    for step in (0.2, 0.1):
        nodes = [node(np.exp(step * number)) for number in range(5)]
        t = np.linspace(step, 2 * step, 7)
        rates, x, y = interpolated(None, nodes, 1, t, 8)
        errors.append(np.abs(rates - np.exp(2j * t)).max())
        np.testing.assert_allclose(rates[[0, -1]], [nodes[1].rate, nodes[2].rate], rtol=1e-13)
        assert x.shape == y.shape == (7, 4)
    assert 7.5 < np.log2(errors[0] / errors[1]) < 8.5
    two = interpolated(None, nodes[:2], 0, np.array([0.05]), 8)[0]
    assert 1e-8 < abs(two[0] - np.exp(0.1j)) < 1e-5


def test_intervals():
    nodes = [node(k) for k in (1.0, 2.0, 4.0)]
    assert [index for _, index in intervals([nodes], [1.0, 1.5, 3.0, 4.0])] == [0, 0, 1, 1]


@pytest.mark.parametrize("flow", [flows.Dune(), flows.Vortex(), flows.Poiseuille(Re=1e4)], ids=lambda flow: flow.name)
def test_a_mode_is_the_same_alone_and_in_company(flow):
    k = np.geomspace(0.3, 3.0, 31)
    memory.forget()
    many = dispersion(flow, k).modes
    for mode in many[4::9]:
        memory.forget()
        alone = dispersion(flow, mode.k).modes[0]
        assert abs(alone.sigma - mode.sigma) <= alone.error + mode.error
        assert abs(alone.group_speed - mode.group_speed) <= alone.group_error + mode.group_error
        assert 0.1 < mode.error / alone.error < 10
    memory.forget()


def test_what_needs_more_coefficients_is_refined_again_together(monkeypatch):
    """Degrees foreseen too low cost a second batch, not one answer after the other."""
    k = np.geomspace(2.0, 8.0, 40)
    right = dispersion(flows.Dune(), k)
    memory.forget()
    branch = surface_branch(Solver(flows.Dune()))
    alone, together = [], []
    between, many = branch._between, branch.solver.solve_many
    monkeypatch.setattr(branch.solver, "needed", lambda *_: 14.0)
    monkeypatch.setattr(branch, "_between", lambda *question: alone.append(question) or between(*question))
    monkeypatch.setattr(branch.solver, "solve_many", lambda *question: together.append(question[3]) or many(*question))
    found, lost = branch.at(k)
    assert not lost
    assert set(together) > {14}
    assert len(alone) < 5
    for mode in right.modes:
        assert abs(found[mode.k].sigma - mode.sigma) <= found[mode.k].error + mode.error
        assert branch.solver.fits(found[mode.k])
    memory.forget()


@pytest.mark.parametrize("flow", [flows.Dune(), flows.Vortex(), flows.Film()], ids=lambda flow: flow.name)
def test_degrees_that_are_needed_are_foreseen(flow):
    """From rough modes, which have few coefficients: mostly a little too many."""
    solver = Solver(flow)
    branch = surface_branch(solver)
    branch.reach(4.0)
    for rough in [mode for mode in branch.segments[0] if mode.k > 0.1]:
        foreseen = rough.degree + 0.9 * (solver.needed(rough, 2e-15) - rough.degree)
        fits = solver.refined(rough).degree
        assert 0.75 * fits < foreseen < 1.3 * fits


def test_a_gap_in_which_another_mode_is_met_is_done_one_by_one(monkeypatch):
    """The overlap with the node before is asked for at the first wavenumber of each gap."""
    k = np.geomspace(0.5, 2.0, 20)
    right = dispersion(flows.Dune(), k).sigma
    memory.forget()
    branch = surface_branch(Solver(flows.Dune()))
    alone, between, overlap = [], branch._between, branch.solver.overlap
    monkeypatch.setattr(branch.solver, "overlap",
                        lambda old, mode: 0.2 if mode.k == k[0] and k[0] not in alone else overlap(old, mode))
    monkeypatch.setattr(branch, "_between", lambda *question: alone.append(question[2]) or between(*question))
    found, _ = branch.at(k)
    assert k[0] in alone
    assert 2 < len(alone) < 15
    assert [found[one].sigma for one in k] == pytest.approx(right, rel=1e-12)
    memory.forget()
