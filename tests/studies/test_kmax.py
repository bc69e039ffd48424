"""The fastest growing wavenumber: against the references, both branches, and none where nothing grows."""

import re

import mpmath as mp
import numpy as np
import pytest
import references

from stability import NotResolved, dispersion, flows, k_max
from stability.modes import crests
from stability.modes.solver import Solver
from stability.modes.surface import surface_branch
from stability.studies.kmax import Optimum


def test_default_dunes():
    optimum = k_max(flows.Dune())
    assert optimum.k_max == pytest.approx(0.8492020357, abs=1e-10)
    assert optimum.growth_rate == pytest.approx(0.2390204964, abs=1e-10)


@pytest.mark.parametrize("flow", [flows.Dune(), flows.Dune(Re=300.0, shields=1.3), flows.Dune(depth=3.0)])
def test_the_error_bar_of_k_holds_against_the_reference(flow):
    """The reference's growth slope, by a fourth-order difference in 30 digits, vanishes within the bar."""
    optimum = k_max(flow)
    k, h = mp.mpf(optimum.k_max), mp.mpf(2) ** -18

    def growth(wavenumber):
        return references.dune(flow.shields, flow.mu1, flow.b, flow.Re, flow.depth, wavenumber,
                               dispersion(flow, float(wavenumber)).sigma[0]).real

    mp.mp.dps = 40
    minus2, minus, middle, plus, plus2 = (growth(k + i * h) for i in (-2, -1, 0, 1, 2))
    slope = (minus2 - 8 * minus + 8 * plus - plus2) / (12 * h)
    curvature = (plus - 2 * middle + minus) / h**2
    assert abs(slope / curvature) <= optimum.error
    assert optimum.error < 1e-11


def test_two_local_maxima():
    """At shields 3 and small Re a viscous branch at k ~ sqrt(Re) competes with one at k of order one."""
    optimum = k_max(flows.Dune(shields=3.0, Re=0.01))
    assert [round(m.k, 4) for m in optimum.maxima] == [1.5531, 0.0139]
    assert optimum.maxima[0].growth_rate > optimum.maxima[1].growth_rate > 0


def test_growth_at_finite_k_is_found_where_long_waves_decay():
    """Under a lid at depth 10 and Re = 0.01 long waves decay (A < 0), waves as short as the bed is deep grow."""
    flow = flows.Dune(shields=3.0, depth=10.0, Re=0.01)
    assert np.all(dispersion(flow, [1e-3, 1e-2, 0.1]).growth_rate < 0)
    assert k_max(flow).k_max == pytest.approx(1.5531, abs=2e-4)


@pytest.mark.parametrize(("Re", "kappa"), [(1e-4, 0.2375), (1e-6, 0.2370)])
def test_small_reynolds_numbers_scale_with_the_root(Re, kappa):
    assert k_max(flows.Dune(Re=Re)).k_max == pytest.approx(kappa * np.sqrt(Re), rel=1e-3)


@pytest.mark.parametrize("flow", [flows.Vortex(), flows.Vortex(Fr2=50.0), flows.Dune(shields=1.5, depth=10.0, Re=0.1)])
def test_flows_that_decay_have_none(flow):
    which = "no waves grow" if flow.decays else "the surface mode does not grow"  # other modes of the bed may
    with pytest.raises(NotResolved, match=f"stable: {which} for k up to"):
        k_max(flow)
    found = k_max(flow, strict=False)
    assert found.maxima == ()
    assert "0 of 1 resolved, 1 stable" in repr(found)


def test_a_search_that_ends_too_early_says_so():
    with pytest.raises(NotResolved, match="still rises at k = 0.3"):
        k_max(flows.Dune(), search=(1e-2, 0.3))


def test_a_refusal_names_the_flow_once():
    flow = flows.Dune(shields=1.5, mu1=0.5, Re=1e-3, depth=3.0)
    lost = Optimum(flow, (), f"{flow}: growth follows no power of k")
    with pytest.raises(NotResolved) as refusal:
        _ = lost.k_max
    assert str(refusal.value) == lost.status
    with pytest.raises(NotResolved, match="^" + re.escape(f"{flow}: stable: no waves grow")):
        _ = Optimum(flow, (), "stable: no waves grow for k up to 1000").k_max


@pytest.mark.parametrize("flow", [flows.Dune(), flows.Dune(Re=1e4, shields=1.2), flows.Vortex(), flows.Vortex(Fr2=3.0)],
                         ids=str)
def test_growth_as_k_vanishes_is_that_of_the_law(monkeypatch, flow):
    """Where growth is of the order of the law nothing is solved for; the mode there grows alike, by the same power."""
    branch = surface_branch(Solver(flow))
    growth, power = crests._as_k_vanishes(branch, 1e-3)
    monkeypatch.setattr(crests, "shipped", lambda kind: False)
    of_mode, power_of_mode = crests._as_k_vanishes(branch, 1e-3)
    assert growth(1e-5) == pytest.approx(of_mode(1e-5), rel=1e-4)
    assert power == pytest.approx(power_of_mode, abs=1e-5)


@pytest.mark.parametrize(("flow", "solves"), [(flows.Dune(), 0), (flows.Film(), 1), (flows.Dune(depth=0.01), 1)])
def test_growth_of_higher_order_than_the_law_is_solved_for(monkeypatch, flow, solves):
    """The law of a film is a wave alone, that of dunes below a near lid all but a wave."""
    branch, taken = surface_branch(Solver(flow)), []
    monkeypatch.setattr(Solver, "solve", lambda *given, solve=Solver.solve: taken.append(1) or solve(*given))
    crests._as_k_vanishes(branch, 1e-3)
    assert len(taken) == solves
