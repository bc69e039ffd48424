"""One mode: its value against independent multi-precision references, its error bar, its slope in k."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest
from samples import dunes, reference, vortices

from stability import NotResolved, dispersion, flows
from stability.equations.layer import Layer
from stability.flows import vortex
from stability.modes import tracking
from stability.modes.solver import Solver
from stability.numerics.refine import refine

# Half a unit in the last digit of the multi-precision values (references.py, growth rates at slope 30 deg, Fr2 0.1).
VORTICES = {0.1: -0.0068518958810, 0.5: -0.1350310816678, 1: -0.3195259582778, 2: -0.4529302727400,
            2.5: -0.4559406971116, 3: -0.4428094506596, 4: -0.4017032637214, 10: -0.2566982675998}


def test_growth_rates_of_vortices():
    relation = dispersion(flows.Vortex(slope_deg=30.0, Fr2=0.1), list(VORTICES))
    np.testing.assert_allclose(relation.growth_rate, list(VORTICES.values()), rtol=0, atol=5e-14)
    assert np.all(relation.sigma.imag == 0)


@dataclass(frozen=True)
class _StickierVortex(flows.Vortex):
    """Vortices with the effective viscosity 1 % too large."""

    name: ClassVar[str] = "stickier"

    def layers(self, names):
        def wrong(s):
            base = vortex.profile(s, np.tan(np.radians(self.slope_deg)), self.Fr2)
            return type(base)(dz=base.dz, rho=base.rho, eta=1.01 * base.eta, beta=base.beta)

        return (Layer("grains", wrong),)


def test_one_percent_of_viscosity_is_seen():
    relation = dispersion(_StickierVortex(slope_deg=30.0, Fr2=0.1), list(VORTICES))
    assert np.all(np.abs(relation.growth_rate / list(VORTICES.values()) - 1) > 1e-6)


def test_growth_rate_and_phase_speed_of_dunes():
    """references.dune at shields 2, mu1 0.4, b 1, Re 10, unbounded fluid, k 1."""
    relation = dispersion(flows.Dune(), 1.0)
    assert relation.sigma[0] == pytest.approx(0.234339971633931 - 1.009151053991395j, abs=1e-14)
    assert relation.phase_speed[0] == pytest.approx(1.009151053991395, abs=1e-14)


@pytest.mark.parametrize("sample", [vortices, dunes])
def test_two_hundred_random_points_and_their_error_bars(sample):
    """Relative error below 1e-11, and error bars that bound it within a factor 1000 in 99.5 % of the points."""
    wrong, held = [], 0
    for flow, k in sample(200, seed=1983):
        mode = dispersion(flow, k).modes[0]
        error = float(abs(reference(flow, k, mode.sigma) - mode.sigma))
        if error > 1e-11 * abs(mode.sigma):
            wrong.append((flow, k, error))
        held += mode.error / 1000 <= error <= mode.error
    assert not wrong
    assert held >= 199


@pytest.mark.parametrize("flow", [flows.Vortex(), flows.Vortex(Fr2=20.0), flows.Dune(), flows.Dune(depth=5.0)])
def test_long_waves_lose_no_digits(flow):
    relation = dispersion(flow, 1e-6)
    exact = reference(flow, 1e-6, relation.sigma[0])
    assert abs(exact - relation.sigma[0]) < 1e-13 * abs(exact)


@pytest.mark.parametrize(("flow", "k"), [(flows.Vortex(), 2.0), (flows.Dune(shields=3.0), 1.5)])
def test_truncation_error_falls_geometrically_and_its_estimate_bounds_it(flow, k):
    exact = complex(dispersion(flow, k).sigma[0])
    solver = Solver(flow)
    degrees = np.array([8, 10, 12, 14, 16])
    errors, estimates = [], []
    for degree in degrees:
        pencil = solver.pencil(int(degree))
        eigen = refine(pencil, solver.weights(k), exact / solver.width(k))
        errors.append(solver.width(k) * abs(eigen.rate - exact / solver.width(k)))
        estimates.append(solver.width(k) * eigen.truncation)
    rate = np.polyfit(degrees, np.log10(errors), 1)[0]
    assert rate < -0.5  # at least one digit for two degrees
    assert np.all(np.array(errors) <= estimates)
    assert np.all(np.array(estimates) < 1000 * np.array(errors))


@pytest.mark.parametrize("flow", [flows.Vortex(Fr2=3.0), flows.Dune(), flows.Dune(depth=4.0)])
def test_slope_in_k_is_the_derivative(flow):
    k, h = 0.9, 1e-3
    ahead = dispersion(flow, k + h * np.array([-2, -1, 0, 1, 2]))
    difference = ahead.sigma @ np.array([1, -8, 0, 8, -1]) / (12 * h)
    assert ahead.slope[2] == pytest.approx(difference, rel=1e-9)


def test_right_and_left_vectors_solve_the_pencil_and_are_biorthogonal():
    solver = Solver(flows.Dune())
    modes = [solver.solve(1.0, rate, None, 20) for rate in (0.234 - 1.009j, -4.615 + 0.954j)]
    pencil = solver.pencil(20)
    a, b = pencil.pair(pencil.weights(solver.symbols(1.0)))
    for mode in modes:
        scale = np.linalg.norm(a) * np.linalg.norm(mode.x)
        assert np.linalg.norm(a @ mode.x - mode.rate * (b @ mode.x)) < 1e-13 * scale
        assert np.linalg.norm(mode.y.conj() @ a - mode.rate * (mode.y.conj() @ b)) \
            < 1e-13 * np.linalg.norm(a) * np.linalg.norm(mode.y)
    assert modes[0].y.conj() @ b @ modes[0].x == pytest.approx(1, abs=1e-12)
    assert abs(modes[0].y.conj() @ b @ modes[1].x) < 1e-12 * np.linalg.norm(modes[0].y) * np.linalg.norm(modes[1].x)


def test_too_small_a_degree_is_refused_by_name():
    with pytest.raises(NotResolved, match=r"k=5: error .* exceeds tolerance at degree 8; raise max_degree"):
        dispersion(flows.Dune(shields=3.0), 5.0, max_degree=8)
    relation = dispersion(flows.Dune(shields=3.0), 5.0, max_degree=8, strict=False)
    assert "exceeds tolerance" in relation.status[0]
    exact = reference(relation.flow, 5.0, dispersion(relation.flow, 5.0).sigma[0])
    assert abs(exact - relation.sigma[0]) <= relation.error[0]


def test_a_looser_tolerance_takes_a_smaller_system():
    tight, loose = (dispersion(flows.Vortex(), 5.0, tolerance=t).modes[0] for t in (1e-10, 1e-4))
    assert loose.degree < tight.degree
    assert abs(loose.sigma - tight.sigma) <= loose.error < 1e-4 * abs(tight.sigma)


@pytest.mark.parametrize("depth", [np.inf, 5.0])
def test_the_fluid_as_a_layer_agrees_with_its_closed_form(depth):
    k = [0.01, 0.3, 1.0, 5.0]
    closed = dispersion(flows.Dune(depth=depth), k)
    layer = dispersion(flows.Dune(depth=depth, fluid="layer"), k)
    np.testing.assert_allclose(layer.sigma, closed.sigma, rtol=2e-14)


@pytest.mark.parametrize(("flow", "low", "high"), [(flows.Vortex(), 0.5, 4.0), (flows.Dune(shields=3.0), 0.1, 5.0)])
def test_points_that_share_a_factorisation_are_as_good_as_any(flow, low, high):
    """Many wavenumbers between two steps of the walk: settled next to one another, and right within their bars."""
    relation = dispersion(flow, np.geomspace(low, high, 150))
    for mode in relation.modes[::15]:
        assert abs(reference(flow, mode.k, mode.sigma) - mode.sigma) <= mode.error


@pytest.mark.parametrize(("flow", "k"), [(flows.Vortex(), np.geomspace(0.5, 4.0, 150)),
                                         (flows.Dune(), np.geomspace(0.05, 5.0, 200)),
                                         (flows.Poiseuille(), np.linspace(0.8, 1.1, 100))])
def test_points_that_share_a_factorisation_settle(flow, k, monkeypatch):
    """No point of a smooth sweep has to be walked to on its own, after the walks up and down from its start."""
    starts = []
    initialise = tracking.Walk.__init__

    def counted(self, *arguments):
        starts.append(arguments)
        initialise(self, *arguments)

    monkeypatch.setattr(tracking.Walk, "__init__", counted)
    dispersion(flow, k)
    assert len(starts) <= 2
