"""The assertion on orders: what it accepts, what it refuses, what it says."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import sympy as sp

from asymptotics import expand
from asymptotics.comparison import LimitMismatch, OrderMismatch
from asymptotics.errors import TooFewPoints
from asymptotics.leading import assert_limit
from asymptotics.limits import assert_order, compare
from stability import dispersion, flows

K = np.geomspace(1e-3, 1e-1, 9)


def cosine(k):
    return np.cos(k)


def test_it_accepts_the_right_series():
    comparison = assert_order(cosine, lambda k: 1 - k**2 / 2, K, expected=4)
    assert comparison.agrees
    assert comparison.observed == pytest.approx(4, abs=1e-3)
    assert comparison.slope.shape == (8,)


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_it_refuses_one_percent(factor):
    with pytest.raises(OrderMismatch) as failure:
        assert_order(cosine, lambda k: 1 - factor * k**2 / 2, K, expected=4)
    message = str(failure.value)
    assert float(message.split()[2]) == pytest.approx(2, abs=0.05)
    assert "expected 4.0" in message
    assert len(message.splitlines()) == 2 + len(K)
    assert all(word in message.splitlines()[1] for word in ("k", "numeric", "series", "error", "slope"))


def test_it_refuses_an_order_too_high():
    """A series better than claimed is a wrong claim."""
    with pytest.raises(OrderMismatch):
        assert_order(cosine, lambda k: 1 - k**2 / 2, K, expected=3)


def test_arrays_functions_and_order_of_k():
    backwards = K[::-1]
    assert assert_order(cosine, lambda k: 1 - k**2 / 2, backwards, expected=4).k[0] == K[0]
    shuffled = np.random.default_rng(0).permutation(K)
    comparison = assert_order(np.cos(shuffled), 1 - shuffled**2 / 2, shuffled, expected=4)
    assert comparison.observed == pytest.approx(4, abs=1e-3)


def test_points_below_the_error_are_left_out():
    error = np.full_like(K, 1e-10)
    comparison = compare(cosine, lambda k: 1 - k**2 / 2, K, 4, error=error)
    assert 4 <= len(comparison.k) < len(K)
    with pytest.raises(TooFewPoints, match="take larger k"):
        compare(cosine, lambda k: 1 - k**2 / 2, K, 4, error=1.0)


def test_the_correction_removes_a_drift():
    k = np.geomspace(1e-2, 1, 9)
    with_drift = compare(lambda k: k**2 * np.exp(0.5 * k ** (1 / 3)), 0 * k, k, 2)
    without = compare(lambda k: k**2 * np.exp(0.5 * k ** (1 / 3)), 0 * k, k, 2, correction=1 / 3)
    assert not with_drift.agrees
    assert without.observed == pytest.approx(2)


def test_an_expansion_knows_its_order():
    law = expand("vortex", order=2, slope_deg=45, Fr2="1/10")
    longer = expand("vortex", order=4, slope_deg=45, Fr2="1/10")
    assert assert_order(longer.function(), law, K).expected == 4
    with pytest.raises(TypeError, match="expected"):
        assert_order(cosine, cosine, K)


# -- real and imaginary part ------------------------------------------------------------------------------

FILM = {"Re": 2.0, "slope_deg": 45.0, "We": 0.0}
WIDE = np.geomspace(0.01, 0.3, 20)


@pytest.fixture(scope="module")
def film():
    return dispersion(flows.Film(**FILM), WIDE)


@pytest.mark.parametrize("power", [1, 2])
@pytest.mark.parametrize("factor", [-0.005, 0.005])
def test_a_wrong_coefficient_does_not_hide_behind_the_other_part(film, power, factor):
    """Half a percent of the growth rate: by the modulus alone, dominated by the phase, it went through."""
    law = expand("film", order=2, **FILM)
    assert assert_order(film.sigma, law, WIDE, error=film.error).agrees
    wrong = film.sigma + factor * law.values()[power] * WIDE**power
    found = compare(wrong, law, WIDE, error=film.error)
    assert not found.agrees
    part = found.parts[0 if power == 2 else 1]
    assert part.explanation.coefficient_differs
    assert part.explanation.first.power == power
    relative = part.explanation.first.value / getattr(law.values()[power], part.name)
    assert relative == pytest.approx(factor, rel=0.02)
    assert f"the coefficient of k^{power} differs by" in found.verdict
    assert compare(wrong, law, WIDE, error=film.error, part=found.parts[0 if power == 1 else 1].name).agrees
    alone = compare(wrong, law, WIDE, error=film.error, part=part.name)
    assert (alone.agrees, alone.parts[0].explanation) == (False, part.explanation)


def test_each_part_has_its_own_next_power(film):
    law = expand("film", order=2, **FILM)
    found = assert_order(film.sigma, law, WIDE, error=film.error)
    assert [(part.name, part.expected) for part in found.parts] == [("real", 4), ("imag", 3)]
    assert assert_order(film.sigma, law, WIDE, error=film.error, part="real").expected == 4
    assert assert_order(film.sigma, law, WIDE, error=film.error, part="imag").expected == 3
    assert expand("dune", "boundary-layer").next_powers == {"real": sp.Rational(7, 3), "imag": sp.Rational(7, 3)}
    with pytest.raises(ValueError, match="part must be one of real, imag, both"):
        compare(film.sigma, law, WIDE, part="phase")


@pytest.mark.parametrize("part", ["both", "real"])
def test_a_part_that_vanishes_is_skipped_and_said(part):
    k = np.geomspace(0.05, 0.5, 9)
    relation = dispersion(flows.Vortex(), k)
    found = assert_order(relation.sigma, expand("vortex", order=2, slope_deg=30, Fr2="1/10"), k, error=relation.error,
                         part=part)
    assert ("imaginary part vanishes" in found.verdict) == (part == "both")


def test_an_expected_power_is_that_of_the_whole():
    """exp(i k) without its cubic term: the real part falls at order 4, the imaginary one at 3."""
    assert assert_order(lambda k: np.exp(1j * k), lambda k: 1 + 1j * k - k**2 / 2, K, 3).agrees
    with pytest.raises(OrderMismatch, match=r"real part differs from the expected 3.0000: the coefficient of k\^2"):
        assert_order(lambda k: 1e-4 * np.cos(k) + 1j * np.sin(k), lambda k: 1e-4 * (1 - 0.49 * k**2) + 1j * k,
                     np.geomspace(1e-2, 1, 9), 3)


# -- why --------------------------------------------------------------------------------------------------


def test_k_too_large_is_told_from_a_wrong_coefficient():
    """Film at Re 10: the series diverges at k = 0.1, while all of its coefficients are right."""
    flow, values = flows.Film(Re=10.0, slope_deg=45.0), {"Re": 10, "slope_deg": 45, "We": 0}
    relation, law = dispersion(flow, WIDE), expand("film", order=4, **values)
    found = compare(relation.sigma, law, WIDE, error=relation.error)
    assert not found.agrees
    assert all(part.explanation.k_too_large for part in found.parts)
    assert "k is too large for this expansion" in found.verdict
    for part in found.parts:
        last = part.explanation.last
        assert abs(last.value) < 0.003 * abs(part.explanation.coefficients[last.power])
    broken = replace(law, terms={**law.terms, 3: law.terms[3] * 1.01})
    found = compare(relation.sigma, broken, WIDE, error=relation.error)
    (part,) = (part for part in found.parts if part.explanation.coefficient_differs)
    assert (part.name, part.explanation.first.power) == ("imag", 3)
    assert part.explanation.first.value == pytest.approx(-0.01 * 418 / 9, rel=0.05)
    assert abs(part.explanation.first.value + 0.01 * 418 / 9) < 5 * part.explanation.first.error


def test_a_constant_offset_is_found():
    with pytest.raises(OrderMismatch, match=r"the coefficient of k\^0 differs by 1e-07 \+- "):
        assert_order(lambda k: cosine(k) + 1e-7, lambda k: 1 - k**2 / 2, K, 4)


def test_noise_without_an_error_is_not_explained():
    noise = 1e-6 * np.random.default_rng(4).standard_normal(len(K))
    with pytest.raises(OrderMismatch, match="a few powers of k do not explain the difference"):
        assert_order(cosine(K) + noise, 1 - K**2 / 2, K, 4)


# -- what is compared --------------------------------------------------------------------------------------


@pytest.mark.parametrize("function", [math.cos, lambda k: math.cos(k) if k < 1 else 0.0,
                                      lambda k: complex(math.cos(k))])
def test_functions_of_a_number(function):
    assert assert_order(function, lambda k: 1 - k**2 / 2, K, 4).observed == pytest.approx(4, abs=1e-3)
    assert assert_order(cosine, lambda k: 1 - float(k) ** 2 / 2, K, 4).agrees


def test_points_without_a_number_are_left_out_and_said():
    k = np.append(K, [0.05, np.nan])
    values = np.append(cosine(K), [np.nan, 1.0])
    found = assert_order(values, lambda k: 1 - k**2 / 2, k, 4)
    assert found.left_out == ("2 of 11 points left out: not a number, first at k = 0.05",)
    assert len(found.k) == len(K)
    with pytest.raises(TooFewPoints, match="6 of 9 points left out: not a number"):
        compare(np.where(K < 0.03, np.nan, cosine(K)), lambda k: 1 - k**2 / 2, K, 4)
    with pytest.raises(ValueError, match="k must be positive"):
        compare(cosine, cosine, [0.0, 1.0, 2.0, 3.0], 4)


def test_points_given_twice_count_once():
    found = compare(cosine, lambda k: 1 - k**2 / 2, [*K, *K[:3]], 4)
    assert found.left_out == ("3 of 12 points left out: k given before",)
    assert found.agrees


def test_two_decades_are_used_unless_more_are_asked_for():
    k = np.geomspace(1e-3, 3, 20)
    found = compare(cosine, lambda k: 1 - k**2 / 2, k, 4)
    assert found.agrees
    assert found.k[-1] < 0.11
    assert found.left_out == (f"{20 - len(found.k)} of 20 points left out: k above 0.1",)
    assert compare(cosine, lambda k: 1 - k**2 / 2, k, 4, largest=10).k[-1] == k[-1]


def test_the_public_names():
    import asymptotics

    assert asymptotics.assert_order is assert_order
    assert asymptotics.assert_limit is assert_limit
    assert asymptotics.__all__ == sorted(asymptotics.__all__)


def visible(failure):
    """The file in which pytest would show the failure."""
    return Path(failure.traceback.filter(failure)[-1].path)


def test_frames_of_ours_are_hidden():
    with pytest.raises(OrderMismatch) as failure:
        assert_order(cosine, lambda k: 1 - 0.4 * k**2, K, 4)
    assert visible(failure) == Path(__file__)
    with pytest.raises(TooFewPoints) as failure:
        assert_order(cosine, cosine, K, 4)
    assert visible(failure) == Path(__file__)
    with pytest.raises(LimitMismatch) as failure:
        assert_limit(cosine, 0.99, K)
    assert visible(failure) == Path(__file__)


# -- limits ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("function", "limit"), [
    (cosine, 1), (lambda k: np.sin(k) / k, 1.0), (lambda k: 2j + k ** (1 / 3), 2j), (lambda k: 3 + k + 1j * k**2, 3),
    (lambda k: k + 1j * k, 0), (lambda k: 0 * k, 0), (lambda k: -0.4 + math.sqrt(k), -0.4),
])
def test_limits(function, limit):
    found = assert_limit(function, limit, K)
    for one, name in zip(found, ("real", "imag"), strict=True):
        expected = getattr(complex(limit), name)
        assert one.value == pytest.approx(expected, abs=1e-4)
        assert abs(one.value - expected) <= 5 * one.error + 1e-15
    for wrong in (limit * 1.01, limit * 0.99) if limit else (0.01, -0.01):
        with pytest.raises(LimitMismatch, match="expected .*, off by"):
            assert_limit(function, wrong, K)


def test_the_limits_of_an_expansion_are_the_first_coefficients_of_each_part(film):
    law = expand("film", order=2, **FILM)
    found = assert_limit(film.sigma, law, WIDE, error=film.error)
    assert (found.real.power, found.imag.power) == (2, 1)
    assert found.real.value == pytest.approx(8 / 15 * 0.75 * 1, rel=1e-3)
    assert found.imag.value == pytest.approx(-2, rel=1e-3)
    assert assert_limit(film.growth_rate / WIDE**2, 8 / 15 * 0.75, WIDE).real.power == 0
    with pytest.raises(LimitMismatch, match=r"^real part: .* off by 0.5 %; imaginary part: .* -2.0.*off by 0.5 %"):
        assert_limit(film.sigma * 1.005, law, WIDE, error=film.error)


@pytest.mark.parametrize("scalar", [False, True])
def test_a_wrong_growth_rate_does_not_hide_behind_the_speed(scalar):
    """Of a film at 45 degrees the real part is a hundredth of the imaginary one at the smallest k."""
    law = expand("film", order=3, Re=10, slope_deg=45, We=0)

    def sigma(k, factor=1.0):
        found = dispersion(flows.Film(Re=10, slope_deg=45), k).sigma
        return factor * found.real + 1j * found.imag

    def wrong(k):
        return complex(sigma(k, 1.005)[0]) if scalar else sigma(k, 1.005)

    k = np.geomspace(0.01, 0.3, 12)
    assert_limit(sigma, law, k)
    assert_limit(wrong, law, k, part="imag")
    for part in "real", "both":
        with pytest.raises(LimitMismatch, match=r"^real part: the coefficient of k\^2 is 4.689.*off by 0.49") as found:
            assert_limit(wrong, law, k, part=part)
        assert "imaginary" not in str(found.value)
        with pytest.raises(OrderMismatch, match=r"real part .*coefficient of k\^2 differs by 0.02"):
            assert_order(wrong, law, k, part=part)


def test_a_right_law_is_told_from_a_wrong_one_by_its_real_part_alone():
    law = expand("film", order=3, Re=10, slope_deg=45, We=0)
    k = np.geomspace(0.01, 0.3, 12)
    sigma = dispersion(flows.Film(Re=10, slope_deg=45), k).sigma
    for part, order in ("real", 4.0), ("imag", 5.0), ("both", 4.0):
        with pytest.raises(OrderMismatch, match="k is too large for this expansion") as failure:
            assert_order(sigma, law, k, part=part)
        assert failure.value.comparison.expected == order


def test_k_too_large_for_a_limit():
    for function, limit in (lambda k: np.cos(9 * k), 1), (lambda k: 1 / (1 + k**2), 1):
        with pytest.raises(LimitMismatch, match="k is too large to tell the limit"):
            assert_limit(function, limit, np.linspace(1, 3, 9))
    sigma = dispersion(flows.Film(Re=10, slope_deg=45), np.geomspace(1, 30, 12)).sigma
    with pytest.raises(LimitMismatch, match="too large .*real.*too large .*imag"):
        assert_limit(sigma, expand("film", order=3, Re=10, slope_deg=45, We=0), np.geomspace(1, 30, 12))
    with pytest.raises(TooFewPoints, match="4 are needed"):
        assert_limit(cosine, 1, [0.1, 0.2, 0.3])


def test_a_limit_of_another_part_is_refused():
    with pytest.raises(ValueError, match="part must be one of real, imag, both"):
        assert_limit(cosine, 1, K, part="modulus")
