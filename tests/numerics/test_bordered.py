"""Bordered band matrices and stacks of sparse ones: products and solves from either side, against full matrices."""

import math

import numpy as np
import pytest

from stability.numerics import bordered as bordered_module
from stability.numerics import stack as stack_module
from stability.numerics.bordered import Bordered, Factors, ManyFactors, Places
from stability.numerics.stack import Lines, Stack

INTERIOR, BORDER, PARTS = 30, 4, 2
SIZE = INTERIOR + BORDER


@pytest.fixture(params=[0, 1, 2], ids=["real", "complex", "real or imaginary"])
def matrices(request):
    """Two matrices with a band of 3 + 1 + 2 and a full border, in full and as entries in random order."""
    rng = np.random.default_rng(7)
    full = rng.standard_normal((PARTS, SIZE, SIZE)) + (1j * rng.standard_normal((PARTS, SIZE, SIZE)) * request.param)
    full = full if request.param else full.real
    if request.param == 2:
        full = np.where((rng.random(full.shape) < 0.5) | np.eye(SIZE, dtype=bool), full.real, 1j * full.imag)
    shift = np.arange(SIZE)[:, None] - np.arange(SIZE)
    banded = (shift <= 3) & (shift >= -2)
    banded[INTERIOR:] = banded[:, INTERIOR:] = True
    full = (full + 4 * np.eye(SIZE)) * banded
    order = rng.permutation(PARTS * banded.sum())
    part, row, column = (index[order] for index in np.nonzero(full))
    return full, (part, row, column, full[part, row, column])


def stacked(part, row, column, value, parts, shape):
    return Stack(Lines(part, row, column, parts, shape), value)


def in_a_band(part, row, column, value, parts, interior, border):
    return Bordered(Places(part, row, column, parts, interior, border), value)


def columns(count, seed):
    rng = np.random.default_rng(seed)
    return rng.standard_normal((SIZE, count)) + 1j * rng.standard_normal((SIZE, count))


@pytest.mark.parametrize("points", [3, 9])
def test_products_from_either_side(matrices, points, monkeypatch):
    """At nine points by real matrices, where no entry has both parts."""
    monkeypatch.setattr(stack_module, "_ENOUGH", (9, 0))
    full, entries = matrices
    stack = stacked(*entries, PARTS, (SIZE, SIZE))
    weights, x, y = columns(points, 8)[:PARTS], columns(points, 9), np.asfortranarray(columns(points, 10))
    products, spread = stack.times(x), stack.spread(weights)
    np.testing.assert_allclose(stack.total(spread, products), np.einsum("pn,prc,cn->rn", weights, full, x), atol=1e-12)
    np.testing.assert_allclose(stack.total_left(spread, y), np.einsum("pn,rn,prc->cn", weights, y, full), atol=1e-12)
    np.testing.assert_allclose(stack.brackets(y, products), np.einsum("rn,prc,cn->pn", y, full, x), atol=1e-12)
    squares = np.einsum("rn,prc,cn->pn", abs(y) ** 2, abs(full) ** 2, abs(x) ** 2)
    np.testing.assert_allclose(stack.squares(y, x), squares, rtol=1e-12)


def test_rows_without_entries():
    stack = stacked(*(np.array(values) for values in ([1], [2], [0], [3.0])), 2, (4, 2))
    x = np.array([[2.0], [5.0]])
    np.testing.assert_array_equal(stack.total(stack.spread(np.ones((2, 1))), stack.times(x)), [[0], [0], [6], [0]])
    np.testing.assert_array_equal(stack.brackets(np.ones((4, 1)), stack.times(x)), [[0], [6]])


def test_solves_from_either_side(matrices):
    full, entries = matrices
    bordered = in_a_band(*entries, PARTS, INTERIOR, BORDER)
    assert (bordered.places.lower, bordered.places.upper) == (3, 2)
    weights = np.array([1.0, -0.25])
    matrix = np.tensordot(weights, full, 1)
    x = columns(3, 11) if np.iscomplexobj(full) else columns(3, 11).real
    factors = Factors(bordered, weights)
    np.testing.assert_allclose(factors.solve(matrix @ x), x, atol=1e-11)
    np.testing.assert_allclose(factors.solve_left(matrix.T @ x), x, atol=1e-11)


@pytest.mark.parametrize("chunk", [1, 10**6], ids=["one by one", "together"])
def test_solves_at_many_points_are_those_of_each(matrices, chunk, monkeypatch):
    monkeypatch.setattr(bordered_module, "_CHUNK", chunk)
    full, entries = matrices
    bordered = in_a_band(*entries, PARTS, INTERIOR, BORDER)
    weights, f = np.array([[1.0, 0.5, 2.0], [-0.25, 0.1, 1e9]]), columns(3, 12)
    f = f if np.iscomplexobj(full) else f.real
    many = ManyFactors(bordered, weights)
    assert many.uneven.tolist() == [False, False, True]
    for index in range(2):
        one = Factors(bordered, weights[:, index])
        np.testing.assert_allclose(many.solve(f)[:, index], one.solve(f[:, index]), rtol=1e-9)
        np.testing.assert_allclose(many.solve_left(f)[:, index], one.solve_left(f[:, index]), rtol=1e-9)


@pytest.mark.parametrize("row", [0, 4], ids=["interior", "border"])
def test_a_singular_point_spoils_no_other(row):
    value = np.ones(6)
    value[row], row_of = 0.0, np.append(np.arange(5), row)
    bordered = in_a_band(np.array([0, 0, 0, 0, 0, 1]), row_of, row_of, value, 2, 3, 2)
    with np.errstate(all="ignore"):
        found = ManyFactors(bordered, np.array([[1.0, 1.0], [1.0, 0.0]])).solve(np.ones((5, 2)))
    np.testing.assert_array_equal(np.isfinite(found).all(axis=0), [True, False])


def test_a_singular_matrix_is_named():
    bordered = in_a_band(np.zeros(5, int), np.arange(5), np.arange(5), np.array([1.0, 1.0, 0.0, 1.0, 1.0]), 1, 3, 2)
    with pytest.raises(np.linalg.LinAlgError):
        Factors(bordered, np.ones(1))


def test_small_unknowns_of_uneven_matrices_keep_their_digits(matrices):
    """Rows and columns of very different size change nothing: each unknown is as accurate as without."""
    full, entries = matrices
    rng = np.random.default_rng(3)
    rows, columns = 10.0 ** rng.integers(-12, 13, (2, SIZE))
    part, row, column, value = entries
    uneven = in_a_band(part, row, column, value * rows[row] * columns[column], PARTS, INTERIOR, BORDER)
    weights, x = np.array([1.0, 0.5]), rng.standard_normal((SIZE, 2))
    matrix = full[0] + 0.5 * full[1]
    factors = Factors(uneven, weights)
    found = factors.solve(rows[:, None] * (matrix @ x)) * columns[:, None]
    np.testing.assert_allclose(found, x, rtol=1e-10)
    found = factors.solve_left(columns[:, None] * (matrix.T @ x)) * rows[:, None]
    np.testing.assert_allclose(found, x, rtol=1e-10)


def test_sums_of_many_lines_are_rounded_like_short_ones():
    """Of 50000 products of one part: added one after the other, they lose five times as much to rounding."""
    count = 50_000
    rng, line, one = np.random.default_rng(4), np.arange(count), np.ones((1, 1))
    errors = []
    for value in rng.uniform(0.5, 1.0, (10, count)):
        stack = stacked(np.zeros(count, int), line, np.zeros(count, int), value, 1, (count, 1))
        found = stack.brackets(np.ones((count, 1)), stack.times(one))[0, 0]
        exact = math.fsum(value)
        errors.append([abs(found - exact), abs(np.cumsum(value)[-1] - exact)])
    ours, in_turn = np.sqrt(np.mean(np.square(errors), axis=0))
    assert ours < 0.3 * in_turn
