"""Layers whose series are said to be short take less of the degree, and answer for what that leaves out."""

from dataclasses import replace

import numpy as np
import pytest

from stability import dispersion
from stability.flows import Chute, Dune, Plate, Regularised
from stability.flows.growth import swaying, turning
from stability.modes.dense import Pattern, finite_rates, smallest_count, unknowns
from stability.modes.solver import Assembly, Solver

BED = Dune(law=Regularised())


class Whole(Dune):
    """The same bed without a word on its series."""

    growth = None

    def layers(self, names):
        return tuple(replace(layer, growth=self.growth) for layer in super().layers(names))


class Starved(Whole):
    """A bed that says of one of its layers that it needs very few terms."""

    def layers(self, names):
        layers = super().layers(names)
        return tuple(replace(layer, growth=(12 if layer.name == self.creep_name else 60, 1.0)) for layer in layers)


def solved(flow, k, degree=None):
    near = dispersion(BED, k).modes[0]
    solver = Solver(flow)
    return solver.solve(k, near.rate * 1.001, None, degree or near.degree, glance=degree is not None)


def test_degrees_of_layers():
    structure = Solver(BED).assembly.system.structure
    assert structure.degrees(12) == [12, 12, 12]
    for degree in (24, 64, 320):
        lowest, *others = structure.degrees(degree)
        assert lowest == degree
        assert all(12 < other < degree for other in others)
    assert Solver(Dune()).assembly.system.structure.degrees(48) == [48]
    with_fluid = Solver(Dune(law=Regularised(), fluid="layer")).assembly.system.structure
    assert with_fluid.degrees(64)[-1] == 64


@pytest.mark.parametrize("k", [0.1, 3.0, 10.0])
def test_mode_is_that_of_equal_degrees(k):
    mode, whole = solved(BED, k), solved(Whole(law=Regularised()), k, 96)
    assert len(whole.x) > 1.4 * len(mode.x)
    assert abs(mode.sigma - whole.sigma) <= mode.error + whole.error
    assert mode.error < 1e-12
    assert abs(mode.slope - whole.slope) <= 1e-9 * abs(whole.slope)


@pytest.mark.parametrize("name", ["bed", "bed_2", "bed_3"])
def test_what_a_short_series_leaves_out_is_in_the_error(name):
    """Truncation of each layer counts: with too few terms in one of them the bar says so and the degree rises."""
    flow = Starved(law=Regularised())
    object.__setattr__(flow, "creep_name", name)
    exact = dispersion(BED, 3.0).modes[0]
    for degree in (32, 40):
        mode = solved(flow, 3.0, degree)
        starved = Assembly(flow).system.structure.degrees(degree)[["bed_3", "bed_2", "bed"].index(name)]
        assert starved == 12
        off = abs(mode.sigma - exact.sigma)
        assert off > 10 * exact.error
        assert off <= mode.error < 1e4 * off


def test_slow_grains_have_short_waves():
    """Two roots of the quartic are near a/r in magnitude, the more nearly so the slower the grains."""
    law = Regularised()
    errors = []
    for inertial in (1e-3, 1e-6, 1e-9):
        mu, slope = float(law.mu(inertial)), float(law.slope(inertial))
        r = inertial * slope / mu
        a = mu * (1 - r / 2)
        roots = np.roots([r, -2 * a, 4 - 2 * r, -2 * a, r])
        shortest = np.sort(roots.real)[-2:]
        wave = turning(np.ones(16), mu, inertial, slope)
        assert wave == pytest.approx(a / r, rel=1e-12)
        errors.append(np.abs(shortest / wave - 1).max())
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 0.03


def test_expected_degree_is_near_the_one_that_resolves():
    solver = Solver(BED)
    for k, mode in zip((0.1, 1.0, 3.0, 10.0), dispersion(BED, [0.1, 1.0, 3.0, 10.0]).modes, strict=True):
        assert abs(solver.degrees.index(solver.expected_degree(k)) - solver.degrees.index(mode.degree)) <= 1
    assert Solver(Dune()).expected_degree(10.0) == Solver(Dune()).degrees[0]


@pytest.mark.parametrize("flow", [Plate(law=Regularised()), Chute(law=Regularised())], ids=lambda flow: flow.name)
def test_finite_eigenvalues_are_counted_layer_by_layer(flow):
    """As many as the gap in the spectrum of a generic pencil of that degree says."""
    solver = Solver(flow)
    degrees = solver.assembly.system.structure.degrees(24)
    assert unknowns(solver, 24) == 4 * sum(degrees) < 4 * 3 * 24
    rates = finite_rates(solver, 24, solver.symbols(1.0))
    assert len(rates) == smallest_count(Pattern(("another",), 24, solver.assembly)) < sum(degrees)
    finer = finite_rates(solver, 48, solver.symbols(1.0))
    for rate in rates[:4]:
        assert np.abs(finer - rate).min() < 1e-3 * abs(rate)


def test_waves_with_inertia_keep_upper_layers_from_few_terms():
    """Light grains creep, heavy ones sway where they are fast: by the square root of their inertia."""
    shares = []
    for grains in (1.0, 10.0, 100.0):
        plate = Plate(law=Regularised(), shields=1.6, grains=grains)
        shares.append([more for _, more in Solver(plate).assembly.system.structure.growths])
    assert [one[0] for one in shares] == [1.0, 1.0, 1.0]
    assert shares[0][2] == shares[1][2] == pytest.approx(8**-0.5)
    assert shares[2][2] == 1.0
    assert swaying(np.full(16, 2.0), 9.0, 4.0, np.full(16, 0.25)) == pytest.approx(2 * (9 * 4 / 0.25) ** 0.5)
