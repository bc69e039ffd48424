"""Forms, and the system of equations that they are split into."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from stability import flows
from stability.equations.forms import variable
from stability.equations.system import System
from stability.errors import ConditionCount


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
