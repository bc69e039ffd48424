"""Chebyshev series on 0 <= s <= 1: basis, products and transforms. No physics here.

A field is the series sum_j a_j phi_j(x), x = 2 s - 1, in integrated polynomials: phi_0 = 1 and
d phi_j / dx = T_{j-1}. In this basis a first-order equation f' - a f = 0 becomes an integral
equation of the second kind: its matrix is banded where a is a polynomial, and well conditioned.
"""

from functools import lru_cache

import numpy as np
from numpy.polynomial import chebyshev as C

_CHOP = 8 * np.finfo(float).eps


def points(count):
    """First-kind Chebyshev points mapped to 0 < s < 1; shape (count,). The ends are never met."""
    return (1 + C.chebpts1(count)) / 2


@lru_cache(maxsize=32)
def basis(degree):
    """Return T-coefficients (T index, j) of phi_j and of d phi_j / ds, each (degree+1, degree+1)."""
    values = np.eye(degree + 1)
    values[1:, 1:] = C.chebint(np.eye(degree))[1:]
    slopes = np.zeros((degree + 1, degree + 1))
    slopes[:-1, 1:] = 2 * np.eye(degree)
    return values, slopes


def at(s, degree):
    """Return phi_0 .. phi_degree at the points 0 <= s <= 1; shape (points, degree+1)."""
    return C.chebvander(2 * np.atleast_1d(s) - 1, degree) @ basis(degree)[0]


def coefficients(samples):
    """T-coefficients (count,) of the interpolant through samples at `points(count)`, chopped.

    Coefficients below a few roundings of the largest are set to zero, so that a polynomial
    keeps its degree and its product matrix its band.
    """
    series = _transform(len(samples)) @ samples
    series[np.abs(series) < _CHOP * np.max(np.abs(series))] = 0
    return series


@lru_cache(maxsize=4)
def _transform(count):
    """Matrix (count, count) from samples at the first-kind points to T-coefficients.

    T_m at the points is a cosine of a multiple of pi / (2 count), exact to rounding for every m, which
    the three-term recurrence is not.
    """
    odd = 2 * np.arange(count)[::-1] + 1
    matrix = np.cos(np.outer(np.arange(count), odd) % (4 * count) * (np.pi / (2 * count))) * (2 / count)
    matrix[0] /= 2
    return matrix


def product(series, rows, columns):
    """Matrix (rows, columns) that multiplies T-coefficients by the function with this T-series.

    From T_i T_m = (T_{i+m} + T_{|i-m|}) / 2.
    """
    half = np.zeros(max(rows + columns, len(series)), dtype=series.dtype)
    half[: len(series)] = series / 2
    half[0] = series[0]
    row, column = np.ogrid[:rows, :columns]
    matrix = half[np.abs(row - column)] + half[row + column]
    matrix[0] /= 2
    return matrix
