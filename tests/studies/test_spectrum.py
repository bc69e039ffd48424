"""All modes at one wavenumber: complete, without spurious ones, each with its error bar."""

from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from samples import reference

from stability import NotResolved, ParameterError, flows, spectrum
from stability.modes.dense import finite_rates
from stability.modes.listing import _sorted
from stability.modes.solver import Solver


@pytest.mark.parametrize(("flow", "k"), [(flows.Vortex(), 2.0), (flows.Vortex(Fr2=50.0), 10.0), (flows.Dune(), 1.0)])
def test_every_mode_is_a_reference_eigenvalue_within_its_bar(flow, k):
    found = spectrum(flow, k, 6)
    for sigma, error in zip(found.sigma, found.error, strict=True):
        assert abs(reference(flow, k, sigma) - sigma) <= error


def test_next_mode_of_dunes():
    """references.dune: -4.61533864843577676... + 0.95419205539523528...i."""
    assert spectrum(flows.Dune(), 1.0, 2).sigma[1] == pytest.approx(-4.615338648435777 + 0.954192055395235j, abs=3e-14)


@pytest.mark.parametrize("k", [1e-6, 1e-3, 1.0, 30.0])
@pytest.mark.parametrize("degree", [16, 40, 96])
def test_deflation_leaves_one_finite_eigenvalue_per_degree_and_surface(k, degree):
    """The streamfunction of degree + 1 coefficients and the surface, less two wall conditions."""
    solver = Solver(flows.Vortex())
    rates = finite_rates(solver, degree, solver.symbols(k))
    assert len(rates) == degree + 1
    assert np.abs(rates).max() < 1e6 * degree**4 / k**2  # viscous decay at the smallest scale


def test_no_finite_eigenvalue_of_the_damped_flow_is_unstable():
    """Longitudinal vortices decay for every mode: a spurious eigenvalue would show as a growing one."""
    for k in (0.01, 0.5, 2.0, 20.0):
        solver = Solver(flows.Vortex(Fr2=5.0))
        for degree in (20, 64, 128):
            assert np.all(finite_rates(solver, degree, solver.symbols(k)).real < 0)


def test_an_internal_mode_of_an_ill_posed_bed_is_found():
    """references.dune at shields 1.05, mu1 0.7, b 1, Re 10, k 10, next to 7327 + 24715i."""
    leading = spectrum(flows.Dune(shields=1.05, mu1=0.7), 10.0, 2)
    assert leading.sigma[0] == pytest.approx(7327.01517062424 + 24715.49107674604j, abs=1e-9)
    assert leading.sigma[1] == pytest.approx(-0.100565381343555 - 0.133037621344573j, abs=1e-14)


def test_what_is_not_resolved_is_refused_or_marked():
    bed = flows.Dune(shields=1.05, mu1=0.7)
    with pytest.raises(NotResolved, match="exceeds tolerance at degree 14"):
        spectrum(bed, 10.0, 4, max_degree=14)
    statuses = {mode.status for mode in spectrum(bed, 10.0, 4, max_degree=14, strict=False).modes}
    assert any("exceeds tolerance" in status for status in statuses)


def test_bad_wavenumbers_are_refused():
    with pytest.raises(ParameterError, match=r"k must be positive and finite \(got -1\)"):
        spectrum(flows.Vortex(), -1.0)


def test_the_halves_of_a_symmetric_flow_have_its_modes():
    """Even and odd modes together are the modes of plane Poiseuille flow."""
    flow = flows.Poiseuille(Re=2000.0)
    whole = spectrum(flow, 1.0, 8)
    parts = [mode for half in flow.halves() for mode in spectrum(half, 1.0, 8).modes]
    for sigma, error in zip(whole.sigma, whole.error, strict=True):
        nearest = min(parts, key=lambda mode: abs(mode.sigma - sigma))
        assert abs(nearest.sigma - sigma) <= error + nearest.error


@pytest.mark.parametrize("flow", [flows.Couette(Re=300.0), flows.Couette(Re=1000.0), flows.Couette(Re=2000.0)], ids=str)
@pytest.mark.parametrize("k", [0.7, 1.0, 1.9])
def test_of_mirror_images_the_one_that_travels_downstream_comes_first(flow, k):
    """They grow alike, and rounding is not to tell their order."""
    modes = spectrum(flow, k, 8).modes
    pairs = [(one, other) for one, other in pairwise(modes)
             if abs(one.c.imag - other.c.imag) < 1e-12 and abs(one.c.real + other.c.real) < 1e-12]
    assert pairs
    assert all(one.phase_speed >= other.phase_speed for one, other in pairs)


def test_modes_that_grow_alike_within_their_errors_are_ordered_by_speed():
    def mode(growth, speed, error=1e-12):
        return SimpleNamespace(growth_rate=growth, phase_speed=speed, error=error, sigma=complex(growth, -speed))

    order = [mode(3.0, 0.0), mode(2.0 - 1e-13, 1.0), mode(2.0, -1.0), mode(1.0, 0.5), mode(1.0 - 1e-5, 0.7, 1e-3)]
    assert list(_sorted(order[::-1])) == list(_sorted(order)) == order
