"""Basis, products and transforms of Chebyshev series, against numpy.polynomial."""

import numpy as np
import pytest
from numpy.polynomial import chebyshev as C

from stability.numerics import chebyshev, smooth

RNG = np.random.default_rng(20)


@pytest.mark.parametrize("degree", [1, 2, 7, 24])
def test_slopes_are_derivatives_of_the_basis(degree):
    values, slopes = chebyshev.basis(degree)
    for j in range(degree + 1):
        expected = 2 * C.chebder(values[:, j]) if degree else np.zeros(1)
        np.testing.assert_allclose(slopes[: len(expected), j], expected, atol=1e-14)


def test_the_basis_starts_with_one_and_spans_all_polynomials():
    values, _ = chebyshev.basis(9)
    assert np.linalg.matrix_rank(values) == 10
    np.testing.assert_array_equal(values[:, 0], np.eye(10)[0])


def test_edges_and_inner_points():
    coefficients = RNG.standard_normal(8)
    series = chebyshev.basis(7)[0] @ coefficients
    s = np.array([0.0, 0.3, 1.0])
    np.testing.assert_allclose(chebyshev.at(s, 7) @ coefficients, C.chebval(2 * s - 1, series), atol=1e-14)


@pytest.mark.parametrize(("count", "degree", "length"), [(12, 4, 9), (6, 9, 3), (20, 8, 8), (5, 5, 1)])
@pytest.mark.parametrize("slopes", [False, True])
def test_entries_multiply_a_field_or_its_slope_by_a_series(count, degree, length, slopes):
    factor, field = RNG.standard_normal(length), RNG.standard_normal(degree + 1)
    expected = np.zeros(count + degree + length)
    product = C.chebmul(factor, chebyshev.basis(degree)[int(slopes)] @ field)
    expected[: len(product)] = product
    _, rows, columns, values = chebyshev.entries([factor], [slopes], count, degree)
    result = np.zeros(count)
    np.add.at(result, rows, values * field[columns])
    np.testing.assert_allclose(result, expected[:count], atol=1e-13)


def test_coefficients_of_a_polynomial_stop_at_its_degree():
    (series,) = smooth.fit(lambda s: (3 - 2 * s + 5 * s**4)[None]).series
    assert len(series) == 5
    np.testing.assert_allclose(C.chebval(0.2, series), 3 - 2 * 0.6 + 5 * 0.6**4, rtol=1e-14)


def test_coefficients_of_an_analytic_function_fall_geometrically():
    """1/(a - x) has T-coefficients 2 rho^-m / sqrt(a^2 - 1), rho = a + sqrt(a^2 - 1)."""
    (series,) = smooth.fit(lambda s: (1 / (1.5 - (2 * s - 1)))[None]).series
    rho = 1.5 + np.sqrt(1.25)
    m = np.arange(1, 30)
    np.testing.assert_allclose(series[1:30], 2 / np.sqrt(1.25) * rho**-m.astype(float), rtol=1e-3)


def test_a_series_at_points_whose_polynomials_are_kept():
    s = np.linspace(0, 1, 23)
    for length in (1, 5, 32, 33, 70):
        series = np.random.default_rng(length).standard_normal(length) / np.arange(1, length + 1) ** 2
        expected = np.polynomial.chebyshev.chebval(2 * s - 1, series)
        np.testing.assert_allclose(chebyshev.at_points(s, series), expected, rtol=0, atol=1e-14)
        with pytest.raises(AssertionError):
            np.testing.assert_allclose(chebyshev.at_points(s, 1.01 * series), expected, rtol=0, atol=1e-14)
