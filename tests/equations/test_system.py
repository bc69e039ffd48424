"""Forms, and the system of equations that they are split into."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from stability import flows, spectrum
from stability.equations.forms import variable
from stability.equations.layer import Layer
from stability.equations.system import System
from stability.errors import ConditionCount, ParameterError
from stability.flows.poiseuille import EvenPoiseuille, Poiseuille, profile
from stability.modes.accuracy import Accuracy
from stability.modes.dense import finite_rates
from stability.modes.energy import condition_numbers
from stability.modes.solver import Solver


def value(form, **numbers):
    """Evaluate a form with numbers for its symbols."""
    return sum(c * np.prod([numbers[name] for name in names]) for names, c in form.terms.items())


def test_forms_obey_arithmetic():
    rng = np.random.default_rng(3)
    a, b, c = variable("a"), variable("b"), variable("c")
    for _ in range(20):
        x, y, z = rng.standard_normal(3)
        form = 2 * (a - b) * (b + 3) ** 2 / 4 - (1 - c) + np.float64(0.5) * a
        expected = 2 * (x - y) * (y + 3) ** 2 / 4 - (1 - z) + 0.5 * x
        assert value(form, a=x, b=y, c=z) == pytest.approx(expected, rel=1e-13)


def test_arrays_multiply_forms_from_either_side():
    s = np.linspace(0, 1, 4)
    left, right = s * variable("a"), variable("a") * s
    np.testing.assert_array_equal(left.terms[("a",)], s)
    np.testing.assert_array_equal(right.terms[("a",)], s)


@dataclass(frozen=True)
class _Unbalanced(flows.Vortex):
    """Vortices with a condition too few."""

    name: ClassVar[str] = "unbalanced"

    def conditions(self, edges, names):
        return super().conditions(edges, names)[1:]


@dataclass(frozen=True)
class _Quadratic(flows.Vortex):
    """A condition that is not linear in the unknowns."""

    name: ClassVar[str] = "quadratic"

    def conditions(self, edges, names):
        first, *rest = super().conditions(edges, names)
        return (first * names.s0, *rest)


def test_a_miscount_of_conditions_names_the_layer_and_the_numbers():
    with pytest.raises(ConditionCount, match=r"unbalanced: expected 5 conditions \(4 for grains, 1 for s0\), got 4"):
        System(_Unbalanced())


def test_nonlinear_conditions_are_refused():
    with pytest.raises(ValueError, match="linear in the unknowns"):
        System(_Quadratic())


def test_dunes_at_another_reynolds_number_have_the_same_equations():
    assert System(flows.Dune(Re=1.0)) == System(flows.Dune(Re=100.0))
    assert System(flows.Dune(shields=2.0)) != System(flows.Dune(shields=2.1))


def test_the_vortex_equations_are_real_polynomials():
    """In zeta = 1 - s every coefficient is a polynomial of degree at most 3."""
    for equation in System(flows.Vortex()).equations:
        for _, _, series in equation.terms:
            assert np.isrealobj(series)
            assert np.count_nonzero(series[4:]) == 0


@dataclass(frozen=True)
class _Lopsided(flows.Couette):
    """Plane Couette flow is its own image by a turn, not by reflection."""

    name: ClassVar[str] = "lopsided"
    reflection: ClassVar[int] = 1

    def conditions(self, edges, names):
        return super().conditions(edges, names)[2:]


@dataclass(frozen=True)
class _TwoPlates(EvenPoiseuille):
    """Conditions at both edges of a layer that is its own mirror image."""

    name: ClassVar[str] = "two_plates"

    def conditions(self, edges, names):
        return Poiseuille.conditions(self, edges, names)


@dataclass(frozen=True)
class _Divided(flows.TwoLayerCouette):
    """Two layers are no mirror image of one another."""

    name: ClassVar[str] = "divided"
    reflection: ClassVar[int] = -1

    def conditions(self, edges, names):
        first, *rest = super().conditions(edges, names)
        return rest[:5]


@pytest.mark.parametrize(("flow", "complaint"), [
    (_Lopsided(), "lopsided: reflection = 1, but the layer is not its own mirror image"),
    (_TwoPlates(), r"two_plates: expected 2 conditions \(2 for fluid\), got 4"),
    (_Divided(), "divided: reflection = -1 is for a flow of one layer"),
])
def test_what_has_no_reflection_is_refused(flow, complaint):
    with pytest.raises((ParameterError, ConditionCount), match=complaint):
        System(flow)


@dataclass(frozen=True)
class _Whole(Poiseuille):
    """Plane Poiseuille flow with both parities at once."""

    name: ClassVar[str] = "whole"


@pytest.mark.parametrize("degree", [24, 25])
def test_both_parities_together_are_the_whole(degree):
    """The matrices of the whole fall into those of the two classes: the same eigenvalues, none more and none less."""
    solvers = [Solver(flow, Accuracy(max_degree=degree)) for flow in (_Whole(Re=50.0), *Poiseuille(Re=50.0).halves())]
    whole, even, odd = (finite_rates(solver, degree, solver.symbols(1.3)) for solver in solvers)
    parts = np.concatenate((even, odd))
    distance = np.abs(whole[:, None] - parts)
    assert len(whole) == len(parts) == len(set(distance.argmin(axis=1).tolist()))
    well = np.abs(whole) < 100  # the largest ones are ill conditioned
    assert well.sum() > 10
    assert distance.min(axis=1)[well].max() < 1e-10


@pytest.mark.parametrize("name", [name for name, flow in flows.FLOWS.items() if len(flow().halves()) > 1])
def test_symmetry_classes_share_their_equations(name):
    """That is relied on: the equations of one are taken for those of the others."""
    halves = Solver(flows.FLOWS[name]()).halves
    first, *others = (half.assembly.system for half in halves)
    for half, other in zip(halves[1:], others, strict=True):
        assert other.equations is first.equations
        assert other == System(half.flow)


@dataclass(frozen=True)
class _Wider(EvenPoiseuille):
    """A symmetry class that is none: its layer is another one."""

    name: ClassVar[str] = "wider"

    def layers(self, names):
        return (Layer("fluid", lambda s: profile(s, 4 * self.Re)),)


@dataclass(frozen=True)
class _Split(Poiseuille):
    """A flow of one's own whose classes do not have the same layer."""

    name: ClassVar[str] = "split"

    def halves(self):
        return EvenPoiseuille(self.Re), _Wider(self.Re)


def test_what_others_say_are_classes_have_equations_of_their_own():
    for half in Solver(_Split()).halves:
        assert half.assembly.system == System(half.flow)


@pytest.mark.parametrize("half", Poiseuille(Re=300.0).halves(), ids=lambda half: type(half).__name__)
def test_a_parity_class_has_the_mode_its_slope_and_its_bars_of_the_whole(half):
    mode = Solver(half).solve(1.3, spectrum(half, 1.3, 1).modes[0].rate, None, 48)
    whole = Solver(_Whole(Re=300.0)).solve(1.3, mode.rate, None, 64)
    assert abs(whole.sigma - mode.sigma) < 2 * (whole.error + mode.error)
    assert abs(whole.slope - mode.slope) < 1e-10
    assert condition_numbers((mode,))[0] == pytest.approx(condition_numbers((whole,))[0], rel=1e-6)
    z = np.array([-0.9, -0.3, 0.0, 0.3, 0.9])
    ours, theirs = mode.fields(z), whole.fields(z)
    for name, parity in (("u", -1), ("w", 1), ("t", 1), ("n", -1), ("p", -1)):
        values = getattr(ours, name)
        np.testing.assert_allclose(values[::-1], half.reflection * parity * values, atol=1e-9 * np.abs(values).max())
        ratio = getattr(theirs, name)[3] / values[3]
        np.testing.assert_allclose(getattr(theirs, name), ratio * values, atol=1e-8 * np.abs(values).max())
    assert mode.sensitivity()["Re"] == pytest.approx(whole.sensitivity()["Re"], rel=1e-8)
