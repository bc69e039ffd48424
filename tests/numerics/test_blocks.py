"""Full blocks along a diagonal with a border: solves from either side, and where they are taken for a band."""

import numpy as np
import pytest

from stability.numerics.blocks import Blocks, placed
from stability.numerics.bordered import Bordered, Factors, ManyFactors, Places

SIZES, BORDER, PARTS = (5, 9, 7), 4, 2
INTERIOR = sum(SIZES)
SIZE = INTERIOR + BORDER


@pytest.fixture(params=[False, True], ids=["real", "complex"])
def matrices(request):
    """Two matrices with full blocks and a border that meets each block in one column, in full and as entries."""
    rng = np.random.default_rng(3)
    full = rng.standard_normal((PARTS, SIZE, SIZE)) + (1j * rng.standard_normal((PARTS, SIZE, SIZE)) * request.param)
    full = full if request.param else full.real
    inside, first = np.zeros((SIZE, SIZE), bool), 0
    for number, size in enumerate(SIZES):
        inside[first: first + size, first: first + size] = True
        inside[first: first + size, INTERIOR + number] = True
        first += size
    inside[INTERIOR:] = True
    full = (full + 3 * np.eye(SIZE)) * inside
    part, row, column = np.nonzero(full)
    order = rng.permutation(len(part))
    return full, tuple(index[order] for index in (part, row, column)), full[part, row, column][order]


def columns(count, real):
    rng = np.random.default_rng(4)
    found = rng.standard_normal((SIZE, count)) + 1j * rng.standard_normal((SIZE, count))
    return found.real if real else found


def test_solves_from_either_side(matrices):
    full, places, value = matrices
    bordered = Bordered(placed(*places, PARTS, INTERIOR, BORDER), value)
    assert isinstance(bordered.places, Blocks)
    weights = np.array([1.0, -0.5])
    matrix, x = np.tensordot(weights, full, 1), columns(3, np.isrealobj(full))
    factors = Factors(bordered, weights)
    np.testing.assert_allclose(factors.solve(matrix @ x), x, atol=1e-11)
    np.testing.assert_allclose(factors.solve_left(matrix.T @ x), x, atol=1e-11)
    np.testing.assert_allclose(factors.phase(), np.linalg.slogdet(matrix)[0], atol=1e-12)
    with pytest.raises(AssertionError):
        np.testing.assert_allclose(factors.solve(1.01 * matrix @ x), x, atol=1e-11)


def test_solves_at_many_points_are_those_of_each(matrices):
    full, places, value = matrices
    bordered = Bordered(placed(*places, PARTS, INTERIOR, BORDER), value)
    weights, f = np.array([[1.0, 0.5, 2.0], [-0.5, 0.1, 1e9]]), columns(3, np.isrealobj(full))
    many = ManyFactors(bordered, weights)
    assert many.uneven.tolist() == [False, False, True]
    for index in range(2):
        alone = Factors(bordered, weights[:, index])
        np.testing.assert_allclose(many.solve(f)[:, index], alone.solve(f[:, index]), atol=1e-12)
        np.testing.assert_allclose(many.solve_left(f)[:, index], alone.solve_left(f[:, index]), atol=1e-12)
        np.testing.assert_allclose(many.phases()[index], alone.phase(), atol=1e-12)


def test_a_narrow_band_stays_a_band():
    row = np.arange(40)
    entries = [np.concatenate(one) for one in ((row, row[1:], row[:-1]), (row, row[:-1], row[1:]))]
    assert type(placed(np.zeros(len(entries[0]), int), *entries, 1, 40, 0)) is Places


def test_a_singular_block_is_refused(matrices):
    full, places, value = matrices
    bordered = Bordered(placed(*places, PARTS, INTERIOR, BORDER), value * (places[1] != 6))
    with pytest.raises(np.linalg.LinAlgError, match="singular interior"):
        Factors(bordered, np.array([1.0, -0.5]))
