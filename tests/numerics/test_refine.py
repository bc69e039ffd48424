"""Inverse iteration: what is told of matrices whose factors lose digits."""

from types import SimpleNamespace

import numpy as np
import pytest

from stability import ModeLost, dispersion, flows
from stability.modes import dense
from stability.modes.dense import finite_rates
from stability.modes.solver import Solver
from stability.numerics import refine
from stability.numerics.arithmetic import Arithmetic

UNEVEN = flows.Dune(shields=9.14387521184334, mu1=992.7514530779238, b=2.846689817185222, Re=236117451046.43802,
                    depth=3.5815408193692813e-06, fluid="layer"), 8.714937674024775e-06


def test_what_two_ways_of_solving_uneven_matrices_differ_by_joins_the_error(monkeypatch):
    flow, k = UNEVEN
    (mode,) = dispersion(flow, k, mode="most-unstable", strict=False).modes
    solver, corrected = Solver(flow), refine._corrected

    def error(part):
        monkeypatch.setattr(refine, "_corrected", lambda *question: shifted(corrected(*question), part))
        return solver.solve(k, mode.rate, (mode.degree, mode.x, mode.y), mode.degree).error

    def shifted(found, part):
        return found._replace(rate=found.rate * (1 + part))

    assert error(0.0) < 1e-7 * abs(mode.sigma)
    assert error(1e-5) >= 1e-5 * abs(mode.sigma) * (1 - 1e-3)


def test_finite_rates_come_by_decreasing_growth():
    solver = Solver(flows.Poiseuille())
    rates = finite_rates(solver, 40, solver.symbols(1.0))
    assert len(rates) > 10
    assert np.all(np.diff(rates.real) <= 0)


@pytest.mark.parametrize("start", [1.05, 1.0 + 1e-3])
def test_a_settled_quotient_is_right_to_rounding_wherever_it_starts(start):
    mode = dispersion(flows.Dune(), 1.0).modes[0]
    found = Solver(flows.Dune()).solve(1.0, start * mode.rate, None, mode.degree)
    assert abs(found.sigma - mode.sigma) <= found.error + mode.error
    assert abs(found.slope - mode.slope) <= 4 * refine.VECTOR * abs(mode.slope)


@pytest.mark.parametrize("extreme", [
    flows.PlaneShear(inertia=1e12), flows.PlaneShear(inertial=1e-9), flows.Couette(Re=1e18),
    flows.Film(Re=1e-16, We=1e19), flows.TwoLayerCouette(viscosity_ratio=1e12), flows.RollWave(Fr2=1e-15)], ids=str)
def test_how_many_eigenvalues_are_finite_does_not_depend_on_sizes(extreme):
    """It is remembered for flows of the same structure: counted of an extreme one it must be right for all."""
    def count(flow, pencil):
        assembly = Solver(flow).assembly
        assembly.generic = getattr(assembly, pencil)
        dense.smallest_count.cache_clear()
        return dense.smallest_count(dense.Pattern(assembly.system.pattern, 10, assembly))

    usual = count(type(extreme)(), "generic")
    assert count(type(extreme)(), "pencil") == count(extreme, "generic") == usual
    assert count(extreme, "pencil") != usual
    dense.smallest_count.cache_clear()


@pytest.mark.parametrize(("errors", "settled"), [((0.5, 0.5), True), ((2.0, 0.5), False), ((0.5, 2.0), False)])
def test_both_vectors_must_be_right(errors, settled):
    assert bool(refine._settled(*(error * refine.VECTOR for error in errors))) is settled


@pytest.mark.parametrize("rate", [1.0, 1.0 + 2.0j, 0.0])
@pytest.mark.parametrize(("singular", "found"), [(2, True), (40, True), (1e5, False)])
def test_a_matrix_that_is_singular_for_some_roundings_is_factorised_beside_them(rate, singular, found):
    """As many roundings around an eigenvalue may give a pivot of 0 exactly."""
    tried = []

    def factors(weights, at):
        tried.append(at)
        if abs(at - rate) <= singular * np.finfo(float).eps * abs(rate):
            raise np.linalg.LinAlgError
        return at

    arithmetic = Arithmetic(SimpleNamespace(factors=factors))
    if found:
        assert abs(arithmetic.factors(None, rate) - rate) < 1e-12
        assert tried[0] == rate
    elif rate:
        with pytest.raises(ModeLost, match="singular near"):
            arithmetic.factors(None, rate)
