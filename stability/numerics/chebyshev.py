"""Chebyshev series on 0 <= s <= 1: basis, products and transforms. No physics here.

A field is the series sum_j a_j phi_j(x), x = 2 s - 1, in integrated polynomials: phi_0 = 1 and
d phi_j / dx = T_{j-1}. In this basis a first-order equation f' - a f = 0 becomes an integral
equation of the second kind: its matrix is banded where a is a polynomial, and well conditioned.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev as C

FEW = 4  # coefficients of a series that an entry of its matrix depends on
_BESIDE = 32  # polynomials kept for a series of up to so many terms, or a multiple
CHOP = 8 * np.finfo(float).eps  # of the largest coefficient of a series: less is taken for rounding


def points(count: int) -> np.ndarray:
    """First-kind Chebyshev points mapped to 0 < s < 1; shape (count,). The ends are never met."""
    return _points(count).copy()


@lru_cache(maxsize=16)
def _points(count: int) -> np.ndarray:
    return (1 + C.chebpts1(count)) / 2


@lru_cache(maxsize=32)
def basis(degree: int) -> tuple[np.ndarray, ...]:
    """Return T-coefficients (T index, j) of phi_j and of d phi_j / ds, each (degree+1, degree+1)."""
    values = np.eye(degree + 1)
    values[1:, 1:] = C.chebint(np.eye(degree))[1:]
    slopes = np.zeros((degree + 1, degree + 1))
    slopes[:-1, 1:] = 2 * np.eye(degree)
    return values, slopes


def at(s: Any, degree: int) -> np.ndarray:
    """Return phi_0 .. phi_degree at the points 0 <= s <= 1; shape (points, degree+1)."""
    return C.chebvander(2 * np.atleast_1d(s) - 1, degree) @ basis(degree)[0]


def transform(samples: np.ndarray) -> np.ndarray:
    """T-coefficients (..., count) of the interpolants through samples (..., count) at `points(count)`.

    By a fast transform of the samples and their mirror image: it rounds far less than a product with a matrix.
    """
    if np.iscomplexobj(samples):  # apart, so that real functions have real series
        return transform(samples.real) + 1j * transform(samples.imag)
    count = samples.shape[-1]
    mirrored = np.concatenate((samples[..., ::-1], samples), axis=-1)
    return (np.fft.rfft(mirrored)[..., :count] * _twist(count)).real


def values(series: Any) -> Any:
    """Values (..., count) at `points(count)` of T-coefficients (..., count)."""
    if np.iscomplexobj(series):
        return values(series.real) + 1j * values(series.imag)
    count = series.shape[-1]
    waves = np.zeros((*series.shape[:-1], count + 1), complex)
    waves[..., :count] = series / _twist(count)
    return np.fft.irfft(waves)[..., count - 1:: -1]


def at_points(s: np.ndarray, series: np.ndarray) -> np.ndarray:
    """A T-series at the points 0 <= s <= 1 (points,); their polynomials are kept, since many series have the same."""
    most = -(-len(series) // _BESIDE) * _BESIDE
    return _polynomials(np.ascontiguousarray(s, float).tobytes(), most)[:, :len(series)] @ series


@lru_cache(maxsize=8)
def _polynomials(s: bytes, count: int) -> np.ndarray:
    return C.chebvander(2 * np.frombuffer(s) - 1, count - 1)


@lru_cache(maxsize=8)
def _twist(count: int) -> np.ndarray:
    """Factors (count,) that turn the waves of a mirrored sequence of 2 count samples into T-coefficients."""
    factor = np.exp(-0.5j * np.pi * np.arange(count) / count) / count
    factor[0] /= 2
    return factor


def entries(series: list[np.ndarray], slopes: list[bool], count: int, degree: int) -> tuple[np.ndarray, ...]:
    """Non-zero entries of the matrices from basis coefficients a_j to T-coefficients of a series times f or df/ds.

    `series` lists the T-coefficients of each factor, `slopes` tells which of them multiply df/ds. Returns arrays
    (entries,): the factor's index, row < count, column <= degree and value. They do not depend on `degree`: a
    smaller system has a part of the same entries.
    """
    found = []
    for factor, (one, slope) in enumerate(zip(series, slopes, strict=True)):
        row, column, index, weight = cells(tuple(np.flatnonzero(one).tolist()), bool(slope), count, degree)
        found.append((np.full(len(row), factor), row, column, (weight * one[index]).sum(axis=0)))
    return tuple(np.concatenate(arrays) for arrays in zip(*found, strict=True))


@lru_cache(maxsize=32)
def cells(support: Sequence[int], slope: bool, count: int, degree: int) -> tuple[np.ndarray, ...]:
    """Where the matrix of a series times f, or df/ds with `slope`, has entries, and how those follow from the series.

    `support` are the indices of its T-coefficients that are not 0. Returns row and column (cells,) and, for each of a
    few coefficients that add to the entry, arrays (few, cells): which coefficient, and its weight. Only the band that a
    series of finite length leaves is visited. phi_j is T_j / 2j - T_{j-2} / 2(j-2) less a constant, and
    d phi_j / ds = 2 T_{j-1}.
    """
    length = support[-1] + 1
    row, column = _band(length + 1, count, degree)
    j = np.maximum(column, 1)
    if slope:
        pairs = [(column - 1, np.where(column > 0, 2.0, 0.0)), (column, np.zeros(len(column)))]
    else:
        pairs = [(column, np.where(column > 1, 0.5 / j, 1.0)),
                 (column - 2, np.where(column > 2, -0.5 / np.maximum(j - 2, 1), 0.0))]
    given = np.zeros(length + 1)  # how much T_m weighs in a product: halved, but for T_0
    given[list(support)] = 0.5
    given[0] *= 2
    places, weights = [], []
    for other, factor in pairs:  # T_i T_m = (T_{i+m} + T_{|i-m|}) / 2
        other = np.maximum(other, 0)
        for place in (np.abs(row - other), row + other):
            places.append(np.minimum(place, length))
            weights.append(given[places[-1]] * factor * np.where(row == 0, 0.5, 1.0))
    index, weight = np.array(places), np.array(weights)
    kept = weight.any(axis=0)
    return row[kept], column[kept], np.where(weight, index, 0)[:, kept], weight[:, kept]


def _band(reach: int, count: int, degree: int) -> tuple[np.ndarray, ...]:
    """Rows and columns (cells,) of the cells with |row - column| <= reach."""
    row = np.arange(count)[:, None]
    row, column = np.broadcast_arrays(row, row + np.arange(-reach, reach + 1))
    inside = (column >= 0) & (column <= degree)
    return row[inside], column[inside]
