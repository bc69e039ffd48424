"""Bordered band matrices: products and solves from either side, against full matrices."""

import numpy as np
import pytest

from stability.bordered import Bordered, Entries, Factors

INTERIOR, BORDER = 30, 4
SIZE = INTERIOR + BORDER


def random_entries(rng, complex_values):
    """Entries (part, rows, columns, values) of two matrices with a band of 3 + 1 + 2 and a full border."""
    for part in range(2):
        full = rng.standard_normal((SIZE, SIZE)) + (1j * rng.standard_normal((SIZE, SIZE)) if complex_values else 0)
        shift = np.arange(SIZE)[:, None] - np.arange(SIZE)
        banded = (shift <= 3) & (shift >= -2)
        banded[INTERIOR:] = banded[:, INTERIOR:] = True
        rows, columns = np.nonzero(banded)
        yield part, rows, columns, full[rows, columns] + 4 * (rows == columns)


@pytest.fixture(params=[False, True], ids=["real", "complex"])
def matrices(request):
    entries = list(random_entries(np.random.default_rng(7), request.param))
    full = np.zeros((2, SIZE, SIZE), entries[0][3].dtype)
    for part, rows, columns, values in entries:
        full[part, rows, columns] = values
    return Bordered.from_entries(2, INTERIOR, BORDER, entries), Entries(entries, SIZE), full


def test_dense_and_combine(matrices):
    stack, sparse, full = matrices
    weights = np.array([0.3, -2.0])
    np.testing.assert_allclose(stack.combine(weights).dense(), np.tensordot(weights, full, 1), atol=1e-14)
    np.testing.assert_allclose(sparse.combine(weights).dense(), np.tensordot(weights, full, 1), atol=1e-14)


def test_products_from_either_side(matrices):
    stack, sparse, full = matrices
    weights, x = np.array([1.5, 0.5]), np.random.default_rng(8).standard_normal(SIZE) * (1 + 0.5j)
    both = np.array([x, 2j * x])
    np.testing.assert_allclose(stack.left_all(both), np.array([x @ full, 2j * x @ full]), atol=1e-12)
    np.testing.assert_allclose(stack.left(both), [x @ full[0], 2j * x @ full[1]], atol=1e-12)
    matrix = np.tensordot(weights, full, 1)
    np.testing.assert_allclose(sparse.combine(weights) @ x, matrix @ x, atol=1e-12)
    np.testing.assert_allclose(x @ sparse.combine(weights), x @ matrix, atol=1e-12)


def test_solves_from_either_side(matrices):
    stack, _, full = matrices
    weights = np.array([[1.0, 0.25], [-0.5, 2.0]])
    both = np.tensordot(weights, full, 1)
    x = np.random.default_rng(9).standard_normal((2, SIZE)).astype(full.dtype)
    factors = Factors(stack.combine(weights))
    np.testing.assert_allclose(factors.solve(np.einsum("nrc,nc->nr", both, x)), x, atol=1e-11)
    np.testing.assert_allclose(factors.solve_left(np.einsum("nr,nrc->nc", x, both)), x, atol=1e-11)


def test_a_singular_matrix_is_named():
    entries = [(0, np.arange(5), np.arange(5), np.array([1.0, 1.0, 0.0, 1.0, 1.0]))]
    with pytest.raises(np.linalg.LinAlgError):
        Factors(Bordered.from_entries(1, 3, 2, entries).combine(np.ones((1, 1))))
