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


def entries(series, count, degree, slopes=False):
    """Non-zero entries of the matrix from basis coefficients a_j to T-coefficients of series * f (or df/ds).

    Returns rows, columns, values (entries,) of the matrix (count, degree+1). Only the band that a series of
    finite length leaves is visited: the cost is proportional to count times that length.
    """
    series = series[: np.flatnonzero(series)[-1] + 1]
    length = len(series)
    offset = np.arange(-length - 1, length + 2)
    row, column = np.broadcast_arrays(np.arange(count)[:, None], np.arange(count)[:, None] + offset)
    inside = (column >= 0) & (column <= degree)
    row, column = row[inside], column[inside]
    if slopes:
        value = np.where(column > 0, 2 * _product(series, row, column - 1), 0)
    else:
        j = np.maximum(column, 1)
        value = np.where(column > 1, 0.5 / j, 1.0) * _product(series, row, column)
        value -= np.where(column > 2, 0.5 / np.maximum(j - 2, 1), 0.0) * _product(series, row, column - 2)
    found = value != 0
    return row[found], column[found], value[found]


def _product(series, row, column):
    """Entries of the matrix that multiplies T-coefficients by a series: T_i T_m = (T_{i+m} + T_{|i-m|}) / 2."""
    half = np.zeros(len(series) + 1, series.dtype)
    half[:-1] = series / 2
    half[0] = series[0]
    column = np.maximum(column, 0)
    difference, total = (np.minimum(index, len(series)) for index in (np.abs(row - column), row + column))
    return (half[difference] + half[total]) * np.where(row == 0, 0.5, 1.0)
