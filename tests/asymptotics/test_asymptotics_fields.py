"""The function algebra: products, integrals and values agree with sympy on random rational functions."""

import random

import pytest
import sympy as sp

from asymptotics.fields import Field, FieldSpace, NotElementary, NotRegular

x = sp.Symbol("x", positive=True)
a = sp.Symbol("a", positive=True)
K = sp.QQ.frac_field(a, sp.Symbol("log_0"), sp.Symbol("log_1"))
POINT = K.from_sympy(1 / a)
LOGS = {(0, POINT): K.from_sympy(sp.Symbol("log_0")), (-1, POINT): K.from_sympy(sp.Symbol("log_1"))}
SPACE = FieldSpace(K, (0, -1, 1), 1, LOGS)


def to_sympy(field):
    total = sp.Integer(0)
    for (pole, power, log), c in field.terms.items():
        term = K.to_sympy(c) * (x - (pole or 0)) ** power
        total += term * (sp.log(x - log) if log is not None else 1)  # up to a constant
    return total


def random_field(generator, poles=(0, -1, 1)):
    terms = {}
    for _ in range(4):
        pole = generator.choice([None, *poles])
        power = generator.randint(0, 3) if pole is None else -generator.randint(1, 3)
        terms[pole, power, None] = K.from_sympy(sp.Rational(generator.randint(1, 9), generator.randint(1, 5)) * a)
    return Field(SPACE, terms)


@pytest.mark.parametrize("seed", range(12))
def test_products_are_products(seed):
    generator = random.Random(seed)
    first, second = random_field(generator), random_field(generator)
    assert sp.cancel(to_sympy(first * second) - to_sympy(first) * to_sympy(second)) == 0


@pytest.mark.parametrize("seed", range(12))
def test_the_derivative_of_an_integral(seed):
    field = random_field(random.Random(seed))
    assert sp.simplify(sp.diff(to_sympy(field.integral()), x) - to_sympy(field)) == 0


@pytest.mark.parametrize("log", [0, -1])
def test_integrals_with_a_logarithm(log):
    for power in (0, 1, 3):
        field = Field(SPACE, {(None, power, log): K.one})
        assert sp.simplify(sp.diff(to_sympy(field.integral()), x) - to_sympy(field)) == 0
    field = Field(SPACE, {(0, -2, -1): K.one})
    assert sp.simplify(sp.diff(to_sympy(field.integral()), x) - to_sympy(field)) == 0


def test_dilogarithms_are_refused():
    with pytest.raises(NotElementary, match="closed form"):
        Field(SPACE, {(1, -1, -1): K.one}).integral()
    with pytest.raises(NotElementary, match="product"):
        Field(SPACE, {(None, 0, 0): K.one}) * Field(SPACE, {(None, 0, -1): K.one})


@pytest.mark.parametrize("seed", range(6))
def test_reading_and_values(seed):
    field = random_field(random.Random(seed), poles=(0, -1))
    again = SPACE.from_sympy(to_sympy(field), x)
    assert again.terms == field.terms
    assert sp.cancel(K.to_sympy(field.at(POINT)) - to_sympy(field).subs(x, 1 / a)) == 0
    with_log = Field(SPACE, {(None, 1, -1): K.one})
    assert with_log.at(K.one) == 0
    assert K.to_sympy(with_log.at(POINT)) == sp.Symbol("log_1") / a


def test_poles_must_cancel():
    with pytest.raises(NotRegular, match=r"x = 1"):
        Field(SPACE, {(1, -1, None): K.one}).at(K.one)
    with pytest.raises(NotElementary, match="pole"):
        SPACE.from_sympy(1 / (x - 2), x)
